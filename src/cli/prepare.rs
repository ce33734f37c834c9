//! From flags to a world, a camera and settings.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::CliError;
use super::args::RenderArgs;
use super::values::{CameraModel, MissingTextureArg};
use crate::camera::{Camera, Projection, ThinLens};
use crate::film::Window;
use crate::formats::{self, LoadError, LoadOptions, MissingTexture};
use crate::integrator::Transport;
use crate::math::{DVec3, Vec3};
use crate::render::{Aov, Settings};
use crate::scene::defaults::{
    AUTOMATIC_YFOV, automatic_camera, automatic_sky, bounds, neutral_sky, nothing_to_see,
};
use crate::scene::{NamedCamera, Notice, Scene};
use crate::world::World;

/// All that a render needs, but for the structure.
pub struct Job {
    /// What is to be seen.
    pub world: World,
    /// From where.
    pub camera: Camera,
    /// How.
    pub settings: Settings,
    /// Whether what is all around was chosen for the user.
    pub automatic_sky: bool,
    /// What the scene asks for and is not honoured, and what was decided for the user.
    pub notices: Vec<Notice>,
    /// Time to read and prepare the scene.
    pub elapsed: Duration,
}

/// Width of a picture whose size no one has said.
const DEFAULT_WIDTH: u32 = 1280;
/// Aspect of a picture whose camera has none.
const DEFAULT_ASPECT: f32 = 16.0 / 9.0;

/// Loads the scene and works out what the flags leave open.
///
/// # Errors
/// What is wrong with the scene or with the flags together.
pub fn prepare(args: &RenderArgs) -> Result<Job, CliError> {
    let start = Instant::now();
    if let Some((flag, needed)) = args.lacking() {
        return Err(CliError::Usage(format!("{flag} is of no use without {needed}")));
    }
    let (mut scene, mut notices) = scene_and_surroundings(args)?;
    let file = args.scene_file().display().to_string();
    let sky = automatic_sky(&scene, &file);
    let automatic_sky = sky.is_some();
    if let Some((sky, notice)) = sky {
        scene.environment = Some(sky);
        notices.push(notice);
    }
    notices.extend(nothing_to_see(&scene, &file));
    let (camera, aspect) = camera(&scene, args, &mut notices)?;
    let settings = settings(args, aspect)?;
    let world = world(scene, args)?;
    Ok(Job { world, camera, settings, automatic_sky, notices, elapsed: start.elapsed() })
}

/// The same scene posed at another time, `args.time`: what the `first` moment left to be worked out
/// is as it was found there, but for a camera of the scene, which moves.
///
/// # Errors
/// What is wrong with the scene at that time.
pub fn moment(args: &RenderArgs, first: &Job) -> Result<Job, CliError> {
    let start = Instant::now();
    let (mut scene, notices) = scene_and_surroundings(args)?;
    if first.automatic_sky {
        scene.environment = Some(neutral_sky());
    }
    let mut camera = first.camera;
    if args.look_from.is_none() && !first.world.scene.cameras.is_empty() {
        if scene.cameras.len() != first.world.scene.cameras.len() {
            let (file, time) = (args.scene_file().display(), args.time.unwrap_or_default());
            let message = format!("{file}: at {time} s the node of a camera has no directions");
            return Err(CliError::Input(message));
        }
        let now = match &args.camera {
            Some(wanted) => chosen(&scene, args, wanted)?,
            None => &scene.cameras[0],
        };
        camera.to_world = now.camera.to_world;
    }
    let told = |notice: &Notice| !first.notices.contains(notice);
    let notices = notices.into_iter().filter(told).collect();
    let (settings, automatic_sky) = (first.settings.clone(), first.automatic_sky);
    let world = world(scene, args)?;
    Ok(Job { world, camera, settings, automatic_sky, notices, elapsed: start.elapsed() })
}

/// The scene with the surroundings that flags give it, and what there is to say of both.
fn scene_and_surroundings(args: &RenderArgs) -> Result<(Scene, Vec<Notice>), CliError> {
    let options = LoadOptions {
        strict: args.strict,
        missing_texture: match args.missing_texture {
            Some(MissingTextureArg::Magenta) => MissingTexture::Magenta,
            None => MissingTexture::Error,
        },
        scene: args.scene.clone(),
        variant: args.variant.clone(),
        animation: args.animation.clone(),
        time: args.time,
    };
    let mut scene = formats::load(args.scene_file(), &options)?;
    let mut notices = std::mem::take(&mut scene.notices);
    if let Some(source) = &args.env {
        let (environment, remarks) = source.load(args.env_scale, args.env_rotate)?;
        scene.environment = Some(environment);
        notices.extend(remarks);
    } else if let Some(sky) = args.clear_sky() {
        if sky.sun.is_nan() || sky.sun.y < 0.0 {
            let message = "--sun-direction must lead to where the sky is, above the horizon";
            return Err(CliError::Usage(message.to_owned()));
        }
        scene.environment = Some(sky.environment(args.env_scale));
    }
    if args.strict && !notices.is_empty() {
        return Err(LoadError::Strict { notices }.into());
    }
    Ok((scene, notices))
}

fn world(scene: Scene, args: &RenderArgs) -> Result<World, CliError> {
    World::with_lights(Arc::new(scene), args.bsdf, args.lights).map_err(|error| {
        let file = args.scene_file().display();
        CliError::Input(format!("{file}: {error}"))
    })
}

/// The camera, and the aspect that it asks for.
fn camera(
    scene: &Scene,
    args: &RenderArgs,
    notices: &mut Vec<Notice>,
) -> Result<(Camera, f32), CliError> {
    let file = args.scene_file().display().to_string();
    let bounds = bounds(scene);
    let centre = if bounds.is_empty() { Vec3::ZERO } else { bounds.centre() };
    let asked = args.resolution.map(|(width, height)| width as f32 / height as f32);
    let fov = args.fov.map(f32::to_radians);
    let (mut camera, aspect) = if let Some(eye) = args.look_from {
        let target = args.look_at.unwrap_or(centre);
        let up = args.up.unwrap_or(Vec3::Y);
        check_view(eye, target, args)?;
        (Camera::look_at(eye, target, up, fov.unwrap_or(AUTOMATIC_YFOV.to_radians())), None)
    } else if let Some(wanted) = &args.camera {
        let named = chosen(scene, args, wanted)?;
        (named.camera, named.aspect.or(named.camera.aspect()))
    } else if let Some(named) = scene.cameras.first() {
        if scene.cameras.len() > 1 {
            let count = scene.cameras.len();
            let message = format!("{count} cameras: looking through the first (--camera)");
            notices.push(Notice { place: file, message });
        }
        (named.camera, named.aspect.or(named.camera.aspect()))
    } else {
        let (camera, notice) = automatic_camera(scene, asked.unwrap_or(DEFAULT_ASPECT), &file);
        notices.push(notice);
        (camera, None)
    };
    if let Some(yfov) = fov {
        if matches!(camera.projection, Projection::Orthographic { .. }) {
            let message = "--fov makes the orthographic camera a perspective one".to_owned();
            notices.push(Notice { place: args.scene_file().display().to_string(), message });
        }
        camera = camera.with_yfov(yfov);
    }
    if args.camera_model == Some(CameraModel::Panorama) {
        let camera = camera.with_panorama();
        return Ok((camera, camera.aspect().unwrap_or(DEFAULT_ASPECT)));
    }
    if let Some(aperture_radius) = args.aperture {
        let from = Vec3::from(camera.to_world.translation);
        let target = args.look_at.unwrap_or(centre);
        let ahead = camera.to_world.transform_vector3(Vec3::NEG_Z).dot(target - from);
        let focus_distance = args.focus.unwrap_or(ahead);
        if focus_distance <= 0.0 {
            return Err(CliError::Usage("nothing to focus on ahead: give --focus".to_owned()));
        }
        camera = camera.with_lens(ThinLens { aperture_radius, focus_distance });
    }
    Ok((camera, aspect.unwrap_or(DEFAULT_ASPECT)))
}

/// Refuses a view that has no direction, or no upright one.
fn check_view(eye: Vec3, target: Vec3, args: &RenderArgs) -> Result<(), CliError> {
    // In f64: squares of what an f32 holds fit.
    let ahead = (target.as_dvec3() - eye.as_dvec3()).normalize_or_zero();
    if ahead == DVec3::ZERO {
        let message = match args.look_at {
            Some(_) => "--look-at is where --look-from is: there is no direction to look in",
            None => "--look-from is the middle of the scene, which it looks at: give --look-at",
        };
        return Err(CliError::Usage(message.to_owned()));
    }
    let Some(up) = args.up else { return Ok(()) };
    if up.as_dvec3().normalize_or_zero().cross(ahead).length() < 1e-6 {
        let message = "--up is along the line of sight, or zero: give another direction";
        return Err(CliError::Usage(message.to_owned()));
    }
    Ok(())
}

/// A camera by its name, or else by its number.
fn chosen<'s>(
    scene: &'s Scene,
    args: &RenderArgs,
    wanted: &str,
) -> Result<&'s NamedCamera, LoadError> {
    let names = || scene.cameras.iter().map(|camera| camera.name.as_str());
    let number = formats::chosen(names(), wanted)
        .ok_or_else(|| LoadError::no_such(args.scene_file(), "camera", wanted, names()))?;
    Ok(&scene.cameras[number])
}

fn settings(args: &RenderArgs, aspect: f32) -> Result<Settings, CliError> {
    let resolution = args.resolution.unwrap_or_else(|| {
        let height = (DEFAULT_WIDTH as f32 / aspect).round().clamp(1.0, 16_384.0);
        (DEFAULT_WIDTH, height as u32)
    });
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
        seed: args.seed,
        pattern: args.sampler,
        filter: args.filter,
        transport: Transport {
            max_depth: args.max_depth,
            roulette_depth: args.rr_depth.0,
            transparent: args.transparent,
        },
        aovs: args.aov.clone().unwrap_or_else(|| Aov::ALL.to_vec()),
    })
}

#[cfg(test)]
mod tests {
    use super::super::render;
    use super::*;

    fn prepared(scene: &str, words: &[&str]) -> Result<Job, CliError> {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let words: Vec<String> = words.iter().map(|&word| word.to_owned()).collect();
        prepare(&render::parse(&folder.join(scene), &words)?)
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
        let notices = |words| prepared("orthographic.gltf", words).expect("a good scene").notices;
        assert_eq!(notices(&[]), []);
        assert!(notices(&["--fov", "30"])[0].message.starts_with("--fov makes"));
    }
}
