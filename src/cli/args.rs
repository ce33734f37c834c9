//! The flags of `dapple render`.

use std::path::{Path, PathBuf};

use clap::{ArgAction, Args};

use super::values::{
    CameraModel, MissingTextureArg, ProgressStyle, RouletteDepth, diameter, elevation,
    field_of_view, finite, not_negative, parsed, positive, resolution, sample_id, share, threads,
    turbidity, vector, window,
};
use crate::accel::AccelSpec;
use crate::film::tonemap::Tonemap;
use crate::film::{PixelFilter, Window};
use crate::formats::EnvironmentSource;
use crate::light::Sun;
use crate::light::{Sky, sun_direction};
use crate::material::BsdfForm;
use crate::math::Vec3;
use crate::render::Aov;
use crate::sampling::SamplePattern;
use crate::simd::Isa;
use crate::world::LightChoice;

/// Render a scene.
///
/// A picture is a function of the scene and of the flags under "Image" and "Light" alone: the same
/// bytes for any structure, any number of threads and any instruction set. Only the layer `cost`
/// differs.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  dapple render scenes/cornell.gltf -o cornell.exr --png cornell.png
  dapple render bunny.obj -o bunny.exr --env studio.hdr --look-from 0.1,0.2,0.4 --look-at 0,0.1,0
  dapple render kitchen.glb -o kitchen.exr --spp 512 --resolution 1920x1080 --accel bvh2

  dapple render scene.toml -o scene.exr
  dapple render --from scene.exr -o again.exr --spp 1024

A .toml scene places other files, with a camera, light and, under [render], these very flags by
their names; what is given here goes before.")]
pub struct RenderArgs {
    /// The scene: .gltf, .glb, .obj, .ply or .toml
    #[arg(value_name = "SCENE", required_unless_present = "from")]
    pub scene_file: Option<PathBuf>,

    /// Where the picture goes: an EXR with all layers
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub output: Option<PathBuf>,
    /// A second output to look at
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub png: Option<PathBuf>,
    /// How the PNG shows light: agx or srgb
    #[arg(long, value_name = "CURVE", default_value = "agx", help_heading = "Output")]
    #[arg(value_parser = parsed::<Tonemap>)]
    pub tonemap: Tonemap,
    /// Brightens the PNG, in stops; the EXR is left alone
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_negative_numbers = true)]
    #[arg(help_heading = "Output", value_parser = finite)]
    pub exposure: f32,
    /// Layers of the EXR [default: albedo,normal,position,depth,variance,samples,cost]
    #[arg(long, value_name = "LAYER,…", value_delimiter = ',', help_heading = "Output")]
    #[arg(value_parser = parsed::<Aov>, hide_short_help = true)]
    pub aov: Option<Vec<Aov>>,
    /// Makes the background transparent (alpha is 1 everywhere otherwise)
    #[arg(long, help_heading = "Output")]
    pub transparent: bool,

    /// Pixels [default: 1280 wide, with the camera's aspect]
    #[arg(long, value_name = "WxH", help_heading = "Image", value_parser = resolution)]
    pub resolution: Option<(u32, u32)>,
    /// Samples a pixel
    #[arg(long, value_name = "N", default_value_t = 64, help_heading = "Image")]
    #[arg(value_parser = clap::value_parser!(u64).range(1..=1 << 32), allow_negative_numbers = true)]
    pub spp: u64,
    /// Another number, another noise
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Image")]
    pub seed: u64,
    /// How samples are placed: sobol (least noise) or independent (for statistics of the noise)
    #[arg(long, value_name = "PATTERN", default_value_t, help_heading = "Image")]
    #[arg(value_parser = parsed::<SamplePattern>, hide_short_help = true)]
    pub sampler: SamplePattern,
    /// The part of the frame to render, in pixels, y downwards, the second corner not included
    #[arg(long, value_name = "x0,y0,x1,y1", help_heading = "Image", value_parser = window)]
    #[arg(hide_short_help = true)]
    pub crop: Option<Window>,
    /// The shape of a pixel: box, gaussian or blackman-harris
    #[arg(long, value_name = "SHAPE", default_value = "blackman-harris", help_heading = "Image")]
    #[arg(value_parser = parsed::<PixelFilter>, hide_short_help = true)]
    pub filter: PixelFilter,

    /// The most segments of a path: 1 sees emitters only, 2 adds direct light
    #[arg(long, value_name = "N", default_value_t = 20, help_heading = "Light")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub max_depth: u32,
    /// The segment from which on dim paths may end by chance, or off
    #[arg(long, value_name = "N|off", default_value = "5", help_heading = "Light")]
    #[arg(value_parser = parsed::<RouletteDepth>, hide_short_help = true)]
    pub rr_depth: RouletteDepth,
    /// glTF's scattering, to the letter (appendix-b) or with its energy kept (conserving)
    #[arg(long, value_name = "FORM", default_value = "conserving", help_heading = "Light")]
    #[arg(value_parser = parsed::<BsdfForm>, hide_short_help = true)]
    pub bsdf: BsdfForm,
    /// How a light is chosen among many: power (wherever it is) or tree (by what it may send)
    ///
    /// A tree makes less noise where lights are many and each reaches only what is near: of a
    /// thousand small lamps a third to a half less. It takes more time a sample, a tenth with a few
    /// lights and nearly as much again with hundreds: of no use below some 20 lights, or where all
    /// of them are far away. Each triangle that emits counts as a light.
    #[arg(long, value_name = "HOW", default_value_t, help_heading = "Light")]
    #[arg(value_parser = parsed::<LightChoice>, hide_short_help = true)]
    pub lights: LightChoice,
    /// Light from all around: an image of latitude and longitude (.hdr, .exr, …), or a colour
    #[arg(long, value_name = "FILE|R,G,B", help_heading = "Light", value_parser = parsed::<EnvironmentSource>)]
    #[arg(allow_hyphen_values = true, conflicts_with = "sky")]
    pub env: Option<EnvironmentSource>,
    /// Sun and sky of a clear day instead, by the air's turbidity: 2 mountains, 3 fine, 10 haze
    #[arg(long, value_name = "2..10", help_heading = "Light", value_parser = turbidity)]
    pub sky: Option<f32>,
    /// How high its sun stands, in degrees [default: 45]
    #[arg(long, value_name = "DEGREES", help_heading = "Light", value_parser = elevation)]
    #[arg(hide_short_help = true)]
    pub sun_elevation: Option<f32>,
    /// Where it stands on a compass whose north is -Z, in degrees [default: 135]
    #[arg(long, value_name = "DEGREES", help_heading = "Light", value_parser = finite)]
    #[arg(hide_short_help = true, allow_negative_numbers = true)]
    pub sun_azimuth: Option<f32>,
    /// Both at once: the direction that leads to it
    #[arg(long, value_name = "X,Y,Z", help_heading = "Light", value_parser = vector)]
    #[arg(conflicts_with_all = ["sun_elevation", "sun_azimuth"])]
    #[arg(hide_short_help = true, allow_hyphen_values = true)]
    pub sun_direction: Option<Vec3>,
    /// How large it is, in degrees; 0: there is sky alone [default: 0.533]
    #[arg(long, value_name = "DEGREES", help_heading = "Light", value_parser = diameter)]
    #[arg(hide_short_help = true)]
    pub sun_diameter: Option<f32>,
    /// The share of light that the ground below that sky sends back [default: 0.2]
    #[arg(long, value_name = "SHARE", help_heading = "Light", value_parser = share)]
    #[arg(hide_short_help = true)]
    pub ground_albedo: Option<f32>,
    /// Multiplies the light from all around
    #[arg(long, value_name = "X", default_value_t = 1.0, help_heading = "Light")]
    #[arg(value_parser = not_negative, hide_short_help = true)]
    #[arg(allow_negative_numbers = true)]
    pub env_scale: f32,
    /// Turns the image all around about +Y, in degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true)]
    #[arg(help_heading = "Light", value_parser = finite, hide_short_help = true)]
    pub env_rotate: f32,

    /// A camera of the scene, by name or number from 0
    #[arg(long, value_name = "NAME|N", help_heading = "Camera")]
    #[arg(conflicts_with = "look_from")]
    pub camera: Option<String>,
    /// A camera of one's own: where it stands
    #[arg(long, value_name = "X,Y,Z", help_heading = "Camera", value_parser = vector)]
    #[arg(allow_hyphen_values = true)]
    pub look_from: Option<Vec3>,
    /// Where it looks [default: the middle of the scene]
    #[arg(long, value_name = "X,Y,Z", help_heading = "Camera", value_parser = vector)]
    #[arg(allow_hyphen_values = true)]
    pub look_at: Option<Vec3>,
    /// What is up for it [default: 0,1,0]
    #[arg(long, value_name = "X,Y,Z", help_heading = "Camera", value_parser = vector)]
    #[arg(allow_hyphen_values = true, hide_short_help = true)]
    pub up: Option<Vec3>,
    /// The angle from the picture's lower edge to its upper one, in degrees
    #[arg(long, value_name = "DEGREES", help_heading = "Camera", value_parser = field_of_view)]
    pub fov: Option<f32>,
    /// Another kind of camera in the same place: panorama
    #[arg(long, value_name = "KIND", help_heading = "Camera", hide_short_help = true)]
    #[arg(conflicts_with_all = ["fov", "aperture"])]
    pub camera_model: Option<CameraModel>,
    /// Radius of the lens in metres [default: a pinhole]
    #[arg(long, value_name = "METRES", help_heading = "Camera", value_parser = positive)]
    #[arg(hide_short_help = true)]
    pub aperture: Option<f32>,
    /// Distance of what is sharp [default: that of --look-at, or the middle of the scene]
    #[arg(long, value_name = "METRES", help_heading = "Camera", value_parser = positive)]
    #[arg(hide_short_help = true, allow_negative_numbers = true)]
    pub focus: Option<f32>,

    /// How long the shutter is open, in seconds from --time on: what is animated blurs
    ///
    /// Nodes, skins, morphs and the scene's cameras move. The scene is read, posed and built anew
    /// for each of --moments moments, which share the samples; what moves far in a short time needs
    /// many of them.
    #[arg(long, value_name = "SECONDS", help_heading = "Camera", value_parser = positive)]
    #[arg(hide_short_help = true, allow_negative_numbers = true)]
    pub shutter: Option<f32>,
    /// At how many moments of that time, at most --spp [default: 32]
    #[arg(long, value_name = "N", help_heading = "Camera", hide_short_help = true)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub moments: Option<u32>,

    /// Repeats the run that made a picture, but for what is said here
    #[arg(long, value_name = "FILE.exr", help_heading = "Input")]
    pub from: Option<PathBuf>,
    /// Which of a glTF file's scenes, by name or number from 0
    #[arg(long, value_name = "NAME|N", help_heading = "Input", hide_short_help = true)]
    pub scene: Option<String>,
    /// A variant of a glTF file's materials, by name or number from 0
    #[arg(long, value_name = "NAME|N", help_heading = "Input", hide_short_help = true)]
    pub variant: Option<String>,
    /// Which of a glTF file's animations --time poses, by name or number from 0 [default: the first]
    #[arg(long, value_name = "NAME|N", help_heading = "Input", hide_short_help = true)]
    pub animation: Option<String>,
    /// The time at which animations are posed, in seconds [default: they are at rest]
    #[arg(long, value_name = "SECONDS", help_heading = "Input", value_parser = finite)]
    #[arg(hide_short_help = true, allow_negative_numbers = true)]
    pub time: Option<f32>,
    /// Refuses a scene that asks for anything that is not honoured
    #[arg(long, help_heading = "Input")]
    pub strict: bool,
    /// Goes on without textures that cannot be read
    #[arg(long, value_name = "COLOUR", help_heading = "Input")]
    pub missing_texture: Option<MissingTextureArg>,

    /// Threads; 0: one a core
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Speed")]
    #[arg(value_parser = threads)]
    pub threads: usize,
    /// The ray-shooting structure; `dapple accels` lists them
    #[arg(
        long,
        value_name = "ID[:option=value,…]",
        default_value = "auto",
        help_heading = "Speed"
    )]
    #[arg(value_parser = parsed::<AccelSpec>)]
    pub accel: AccelSpec,
    /// The instruction set
    #[arg(long, value_name = "SET", default_value_t, help_heading = "Speed")]
    #[arg(value_parser = parsed::<Isa>, hide_short_help = true)]
    pub isa: Isa,

    /// Loads and builds, estimates memory and time, and stops
    #[arg(long, help_heading = "Messages", conflicts_with = "debug_sample")]
    pub dry_run: bool,
    /// Prints all settings as the table [render] of a .toml scene, and stops
    #[arg(long, help_heading = "Messages", conflicts_with_all = ["debug_sample", "dry_run"])]
    #[arg(hide_short_help = true)]
    pub print_config: bool,
    /// Follows one sample alone and tells of its path on standard output
    #[arg(long, value_name = "x,y,s", help_heading = "Messages", value_parser = sample_id)]
    #[arg(hide_short_help = true)]
    pub debug_sample: Option<(u32, u32, u64)>,
    /// How to tell how far it is
    #[arg(long, value_name = "HOW", default_value = "auto", help_heading = "Messages")]
    #[arg(hide_short_help = true)]
    pub progress: ProgressStyle,
    /// Says nothing but errors
    #[arg(short, long, help_heading = "Messages", conflicts_with = "verbose")]
    pub quiet: bool,
    /// Says what the scene holds, and how long reading and building take
    #[arg(short, long, action = ArgAction::Count, help_heading = "Messages")]
    pub verbose: u8,
    /// Prints a summary as one JSON object on standard output
    #[arg(long, help_heading = "Messages")]
    pub json: bool,
}

impl RenderArgs {
    /// The scene's file; empty where none is given, which is only while `--from` is not read yet.
    pub fn scene_file(&self) -> &Path {
        self.scene_file.as_deref().unwrap_or(Path::new(""))
    }

    /// Flags that need another one, which is not there; that one too.
    pub fn lacking(&self) -> Option<(&'static str, &'static str)> {
        let around = self.env.is_some() || self.sky.is_some();
        let eye = self.look_from.is_some();
        let all = [
            ("--look-at", self.look_at.is_some(), "--look-from", eye),
            ("--up", self.up.is_some(), "--look-from", eye),
            ("--focus", self.focus.is_some(), "--aperture", self.aperture.is_some()),
            ("--env-scale", self.env_scale != 1.0, "--env or --sky", around),
            ("--env-rotate", self.env_rotate != 0.0, "--env", self.env.is_some()),
            ("--sun-elevation", self.sun_elevation.is_some(), "--sky", self.sky.is_some()),
            ("--sun-azimuth", self.sun_azimuth.is_some(), "--sky", self.sky.is_some()),
            ("--sun-direction", self.sun_direction.is_some(), "--sky", self.sky.is_some()),
            ("--sun-diameter", self.sun_diameter.is_some(), "--sky", self.sky.is_some()),
            ("--animation", self.animation.is_some(), "--time", self.time.is_some()),
            ("--shutter", self.shutter.is_some(), "--time", self.time.is_some()),
            ("--moments", self.moments.is_some(), "--shutter", self.shutter.is_some()),
            ("--ground-albedo", self.ground_albedo.is_some(), "--sky", self.sky.is_some()),
        ];
        let found = all.into_iter().find(|&(_, given, _, has)| given && !has);
        found.map(|(flag, _, needed, _)| (flag, needed))
    }

    /// The clear day that is asked for.
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
