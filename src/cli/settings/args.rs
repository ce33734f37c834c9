//! The values of all settings, typed.

use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use super::frames::Frames;
use super::parse::{
    CameraModel, LightArg, MissingTextureArg, MtlTransparencyArg, ProgressStyle, RouletteDepth,
    TextureLod,
};
use super::parse_long::{Every, Resume, Share};
use super::parse_watch::{Show, TevAddress};
use crate::accel::AccelSpec;
use crate::film::tonemap::Tonemap;
use crate::film::{PixelFilter, Window};
use crate::formats::EnvironmentSource;
use crate::light::{Sky, Sun, sun_direction};
use crate::material::BsdfForm;
use crate::math::Vec3;
use crate::render::Aov;
use crate::sampling::SamplePattern;
use crate::simd::Isa;
use crate::world::LightSamplerKind;

/// Frames a second, if no one says.
const FPS: f32 = 24.0;

/// What `dapple render` is asked for: a field for each entry of the table of settings, where its
/// meaning is documented.
#[derive(Clone, Debug, Default)]
pub struct RenderArgs {
    pub scene_file: PathBuf,

    pub output: Option<PathBuf>,
    pub png: Option<PathBuf>,
    pub tonemap: Tonemap,
    pub exposure: f32,
    pub aov: Vec<Aov>,
    pub preview: Option<PathBuf>,
    pub show: Option<Show>,
    pub tev: Option<TevAddress>,
    pub denoise: bool,

    pub resolution: Option<(u32, u32)>,
    pub spp: u64,
    pub seed: u64,
    pub sampler: SamplePattern,
    pub crop: Option<Window>,
    pub filter: PixelFilter,
    pub transparent: bool,
    pub texture_lod: TextureLod,

    pub max_depth: u32,
    pub rr_depth: RouletteDepth,
    pub bsdf: BsdfForm,
    pub lights: LightSamplerKind,
    pub light: LightArg,
    pub env: Option<EnvironmentSource>,
    pub sky: Option<f32>,
    pub sun_elevation: Option<f32>,
    pub sun_azimuth: Option<f32>,
    pub sun_direction: Option<Vec3>,
    pub sun_diameter: Option<f32>,
    pub ground_albedo: Option<f32>,
    pub env_scale: f32,
    pub env_rotate: f32,
    pub env_repair: bool,

    pub camera: Option<String>,
    pub look_from: Option<Vec3>,
    pub look_at: Option<Vec3>,
    pub up: Option<Vec3>,
    pub fov: Option<f32>,
    pub camera_model: Option<CameraModel>,
    pub aperture: Option<f32>,
    pub focus: Option<f32>,
    pub shutter: Option<f32>,

    pub samples: Option<Range<u64>>,
    pub part: Option<Share>,
    pub partial: Option<PathBuf>,
    /// An empty path: beside the output.
    pub checkpoint: Option<PathBuf>,
    pub resume: Option<Resume>,
    pub every: Option<Every>,
    pub stop_after: Option<Duration>,
    pub time_limit: Option<Duration>,
    pub noise: Option<f32>,
    pub min_spp: Option<u64>,
    pub max_spp: Option<u64>,
    pub fail_incomplete: bool,
    pub reproducible: bool,

    pub from: Option<PathBuf>,
    pub scene: Option<String>,
    pub variant: Option<String>,
    pub animation: Option<String>,
    pub time: Option<f32>,
    pub frames: Option<Frames>,
    /// Frames a second.
    pub fps: Option<f32>,
    pub strict: bool,
    pub missing_texture: Option<MissingTextureArg>,
    pub mtl_transparency: Option<MtlTransparencyArg>,

    pub threads: usize,
    pub accel: AccelSpec,
    pub isa: Isa,
    /// Bytes.
    pub memory: Option<u64>,
    /// Bytes that textures may take.
    pub texture_memory: Option<u64>,

    pub dry_run: bool,
    pub print_config: bool,
    pub debug_sample: Option<(u32, u32, u64)>,
    pub progress: ProgressStyle,
    pub log: Option<PathBuf>,
    pub metrics: Option<PathBuf>,
    pub quiet: bool,
    pub verbose: u8,
    pub json: bool,
}

impl RenderArgs {
    /// When a frame is, in seconds.
    pub fn time_of(&self, frame: u32) -> f32 {
        (f64::from(frame) / f64::from(self.fps.unwrap_or(FPS))) as f32
    }

    /// The clear sky that is asked for.
    pub fn clear_sky(&self) -> Option<Sky> {
        let turbidity = self.sky?;
        let default = Sky::default();
        let by_angles =
            || sun_direction(self.sun_elevation.unwrap_or(45.0), self.sun_azimuth.unwrap_or(135.0));
        let diameter = self.sun_diameter.unwrap_or(Sun::DIAMETER);
        Some(Sky {
            turbidity,
            sun: self.sun_direction.map_or_else(by_angles, Vec3::normalize),
            ground_albedo: self.ground_albedo.unwrap_or(default.ground_albedo),
            sun_diameter: (diameter > 0.0).then_some(diameter),
        })
    }
}
