//! From settings to all that a render needs.
//!
//! | file | what it does |
//! |---|---|
//! | `scene` | loads the scene as it is posed, with its environment light |
//! | `view` | chooses the camera |
//! | `light` | decides what lights the scene |
//! | `dark` | says why a picture will be black or empty |

mod dark;
mod light;
#[cfg(test)]
mod light_tests;
mod scene;
mod view;

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::accel::BuildError;
use crate::camera::moving::MovingCamera;
use crate::cli::error::CliError;
use crate::cli::input;
use crate::cli::settings::RenderArgs;
use crate::cli::settings::parse::LightArg;
use crate::cli::watch::Watch;
use crate::film::Window;
use crate::integrator::Transport;
use crate::render::{Aov, NoiseTarget, Settings, Sight, film_bytes};
use crate::scene::Notice;
use crate::scene::defaults::describe_empty_scene;
use crate::texture::TextureStore;
use crate::world::World;
pub use dark::percent;
use light::{Decided, Structure};

/// The fewest and the most samples a pixel under a target for the noise, if no one says.
const MIN_SPP: u64 = 64;
const MAX_SPP: u64 = 16_384;

/// All that a render needs. Structure, instruction set and threads are among its settings.
pub struct Job {
    /// The values of all settings; the resolution has been worked out.
    pub args: RenderArgs,
    /// How the picture is rendered.
    pub settings: Settings,
    /// What keeps the images of textures.
    pub textures: Arc<TextureStore>,
    /// The scene.
    pub staged: Staged,
    /// What a look ahead has found, if there was one.
    pub sight: Option<Sight>,
    /// The structure, if it was built to look ahead.
    structure: Mutex<Option<Structure>>,
}

/// The scene, ready to be rendered.
pub struct Staged {
    /// What is to be seen.
    pub world: World,
    /// From where.
    pub camera: MovingCamera,
    /// What the scene asks for and is not honoured, and what was decided for the user.
    pub notices: Vec<Notice>,
    /// Time to read and prepare the scene.
    pub elapsed: Duration,
}

impl Job {
    /// Loads the scene and works out what the settings leave open. Nobody looks at it, unless they
    /// ask for a lamp at the camera: a scene in which nothing shines is under a neutral sky.
    ///
    /// # Errors
    /// What is wrong with the scene, or with the settings for this scene.
    pub fn prepare(args: RenderArgs) -> Result<Self, CliError> {
        let needs_look = args.light == LightArg::Camera;
        Self::load(args, needs_look, &Watch::silent())
    }

    /// The same after a look ahead, which decides what lights the scene if no one says; while
    /// someone watches.
    ///
    /// # Errors
    /// As [`Job::prepare`], and if the structure cannot be built.
    pub fn prepare_looking(args: RenderArgs, watch: &Watch) -> Result<Self, CliError> {
        Self::load(args, true, watch)
    }

    fn load(mut args: RenderArgs, looks: bool, watch: &Watch) -> Result<Self, CliError> {
        let start = Instant::now();
        args.spp = count_samples(&args);
        let settled = light::settle(&mut args);
        let textures = Arc::new(scene::texture_store(&args, watch));
        let at_zero = if looks { light::decide_at_zero(&args, &textures, watch)? } else { None };
        // The images of the first are those of the second: they are decoded once.
        let (at_zero, _images) = at_zero.unzip();
        let (mut scene, mut notices) = scene::load(&args, &textures, watch)?;
        let file = args.scene_file.display().to_string();
        let place_of_light = notices.len();
        notices.extend(settled);
        notices.extend(describe_empty_scene(&scene, &file));
        let (camera, aspect) = view::choose(&scene, &args, &mut notices)?;
        let settings = choose_settings(&args, aspect)?;
        args.resolution = Some(settings.resolution);
        scene::require_memory(&args, &scene, &textures, film_bytes(&settings))?;

        let (world, decided, structure) = if looks {
            let (world, decided, structure) = light::look(&args, scene, &camera, (at_zero, watch))?;
            (world, decided, Some(structure))
        } else {
            let decided = Decided::as_asked(&args, &scene);
            decided.lighting.apply(&mut scene, &camera.camera);
            (scene::build_world(scene, &args)?, decided, None)
        };
        args.light = decided.lighting.light;
        notices.splice(place_of_light..place_of_light, decided.notice);
        if let Some(sight) = &decided.sight {
            notices.extend(dark::explain(&args, &world.scene, sight));
        }
        let built = structure.as_ref().map_or(Duration::ZERO, |(_, built)| *built);
        let elapsed = start.elapsed().saturating_sub(built);
        let staged = Staged { world, camera, notices, elapsed };
        let (sight, structure) = (decided.sight, Mutex::new(structure));
        Ok(Self { args, settings, textures, staged, sight, structure })
    }

    /// The structure that was asked for, which may be there since the look ahead; whoever asks for
    /// it takes it away. On the threads of the current pool.
    ///
    /// # Errors
    /// If it has limits that the scene exceeds, or the machine lacks the instruction set.
    pub fn take_structure(&self, watch: &Watch) -> Result<Structure, BuildError> {
        let there = self.structure.lock().unwrap_or_else(PoisonError::into_inner).take();
        there.map_or_else(|| light::build(&self.args, &self.staged.world, watch), Ok)
    }

    /// Runs `work` on as many threads as were asked for.
    ///
    /// # Errors
    /// If they cannot be started.
    pub fn on_threads<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Result<R, CliError> {
        input::run_on_threads(self.args.threads, work)
    }
}

/// The samples a pixel of the whole picture: as many as are named, or up to which noise may go.
fn count_samples(args: &RenderArgs) -> u64 {
    let named = args.samples.as_ref().map_or(0, |samples| samples.end);
    match args.noise {
        Some(_) => args.max_spp.unwrap_or(MAX_SPP),
        None => args.spp.max(named),
    }
}

/// Chooses the library's settings, for a camera of such an aspect.
fn choose_settings(args: &RenderArgs, aspect: f32) -> Result<Settings, CliError> {
    let resolution = view::resolution(args, aspect);
    let frame = Window::of_size(resolution.0 as usize, resolution.1 as usize);
    let crop = args.crop.unwrap_or(frame);
    if crop.x0 < 0 || crop.y0 < 0 || crop.x1 > frame.x1 || crop.y1 > frame.y1 {
        let (width, height) = resolution;
        return Err(CliError::Usage(format!("--crop {crop} is not inside of {width}x{height}")));
    }
    Ok(Settings {
        resolution,
        crop,
        spp: args.spp,
        noise: args
            .noise
            .map(|error| NoiseTarget { error, min_spp: args.min_spp.unwrap_or(MIN_SPP) }),
        seed: args.seed,
        pattern: args.sampler,
        filter: args.filter,
        transport: Transport {
            max_depth: args.max_depth,
            roulette_depth: args.rr_depth.0,
            transparent: args.transparent,
        },
        aovs: layers_to_render(args),
    })
}

/// The layers that are wanted, and those that a denoiser reads.
fn layers_to_render(args: &RenderArgs) -> Vec<Aov> {
    let mut layers = args.aov.clone();
    let read = [Aov::Albedo, Aov::Normal].into_iter().filter(|_| args.denoise);
    layers.extend(read.filter(|layer| !args.aov.contains(layer)));
    layers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::settings::resolve_words;

    fn prepared(scene: &str, words: &[&str]) -> Result<Job, CliError> {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let words: Vec<String> = words.iter().map(|&word| word.to_owned()).collect();
        Job::prepare(resolve_words(&folder.join(scene), &words)?.args)
    }

    #[test]
    fn a_view_without_a_direction_is_a_slip() {
        for (words, start) in [
            (&["--look-from", "1,2,3", "--look-at", "1,2,3"][..], "--look-at is where"),
            (&["--look-from", "1,2,3", "--look-at", "1,2,9", "--up", "0,0,-5"], "--up is along"),
            (&["--look-from", "1,2,3", "--up", "0,0,0"], "--up is along"),
        ] {
            let Err(error) = prepared("furnace.gltf", words) else { panic!("{words:?}") };
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().starts_with(start), "{error}");
        }
        let above = ["--look-from", "0,9,0", "--look-at", "0,0,0"];
        assert!(prepared("furnace.gltf", &above).is_ok(), "straight down, whatever is up");
    }

    #[test]
    fn what_an_orthographic_camera_loses_is_said() {
        let prepared = |words| prepared("orthographic.gltf", words).expect("a good scene");
        assert_eq!(prepared(&[]).staged.notices, []);
        assert!(prepared(&["--fov", "30"]).staged.notices[0].message.starts_with("--fov makes"));
    }

    #[test]
    fn without_flags_the_settings_are_those_of_the_library() {
        let job = prepared("furnace.gltf", &[]).expect("a good scene");
        let (width, height) = job.settings.resolution;
        assert_eq!(format!("{:?}", job.settings), format!("{:?}", Settings::new(width, height)));
    }

    #[test]
    fn the_resolution_is_worked_out_from_the_camera() {
        let job = prepared("furnace.gltf", &["--camera-model", "panorama"]).expect("a good scene");
        assert_eq!(
            (job.args.resolution, job.settings.resolution),
            (Some((1280, 640)), (1280, 640))
        );
    }
}
