//! The camera of a picture.

use crate::camera::moving::MovingCamera;
use crate::camera::{Camera, Projection, ThinLens};
use crate::cli::error::CliError;
use crate::cli::settings::RenderArgs;
use crate::cli::settings::parse::CameraModel;
use crate::formats::{self, LoadError};
use crate::math::{DVec3, Vec3};
use crate::scene::defaults::{AUTOMATIC_YFOV, automatic_camera, bounds};
use crate::scene::{Notice, Scene};

/// Width of a picture whose size no one has said.
const DEFAULT_WIDTH: u32 = 1280;

/// Aspect of a picture whose camera has none.
const DEFAULT_ASPECT: f32 = 16.0 / 9.0;

/// Chooses the camera; and the aspect that it asks for. What was decided for the user is added to
/// the notices.
///
/// # Errors
/// If there is no such camera, or the view has no direction.
pub fn choose(
    scene: &Scene,
    args: &RenderArgs,
    notices: &mut Vec<Notice>,
) -> Result<(MovingCamera, f32), CliError> {
    let bounds = bounds(scene);
    let centre = if bounds.is_empty() { Vec3::ZERO } else { bounds.centre() };
    let (MovingCamera { mut camera, motion }, aspect) = choose_place(scene, args, centre, notices)?;
    if let Some(yfov) = args.fov.map(f32::to_radians) {
        if matches!(camera.projection, Projection::Orthographic { .. }) {
            let message = "--fov makes the orthographic camera a perspective one".to_owned();
            notices.push(Notice { place: args.scene_file.display().to_string(), message });
        }
        camera = camera.with_yfov(yfov);
    }
    if args.camera_model == Some(CameraModel::Panorama) {
        let camera = camera.with_panorama();
        let aspect = camera.aspect().unwrap_or(DEFAULT_ASPECT);
        return Ok((MovingCamera { camera, motion }, aspect));
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
    Ok((MovingCamera { camera, motion }, aspect.unwrap_or(DEFAULT_ASPECT)))
}

/// The size of the whole frame, pixels: as it was asked for, or for a camera of such an aspect.
pub fn resolution(args: &RenderArgs, aspect: f32) -> (u32, u32) {
    args.resolution.unwrap_or_else(|| {
        let height = (DEFAULT_WIDTH as f32 / aspect).round().clamp(1.0, 16_384.0);
        (DEFAULT_WIDTH, height as u32)
    })
}

/// One's own camera, or that of the scene, or else one that sees all of it; and its aspect, if it
/// has one.
fn choose_place(
    scene: &Scene,
    args: &RenderArgs,
    centre: Vec3,
    notices: &mut Vec<Notice>,
) -> Result<(MovingCamera, Option<f32>), CliError> {
    let file = args.scene_file.display().to_string();
    if let Some(eye) = args.look_from {
        let target = args.look_at.unwrap_or(centre);
        check_view(eye, target, args)?;
        let yfov = args.fov.unwrap_or(AUTOMATIC_YFOV).to_radians();
        let camera = Camera::look_at(eye, target, args.up.unwrap_or(Vec3::Y), yfov);
        return Ok((camera.into(), None));
    }
    let named = match &args.camera {
        Some(wanted) => Some(find_camera(scene, args, wanted)?),
        None => (!scene.cameras.is_empty()).then_some(0),
    };
    if let Some(number) = named {
        let named = &scene.cameras[number];
        if args.camera.is_none() && scene.cameras.len() > 1 {
            let count = scene.cameras.len();
            let message = format!("{count} cameras: looking through the first (--camera)");
            notices.push(Notice { place: file, message });
        }
        if args.up.is_some() {
            let message = "--up has no effect: the scene's camera says what is up".to_owned();
            notices.push(Notice { place: args.scene_file.display().to_string(), message });
        }
        let motion = scene.motion.as_ref().and_then(|motion| motion.camera(number)).cloned();
        let aspect = named.aspect.or(named.camera.aspect());
        return Ok((MovingCamera { camera: named.camera, motion }, aspect));
    }
    let up = args.up.map_or(Some(Vec3::Y), |up| up.as_dvec3().try_normalize().map(DVec3::as_vec3));
    let Some(up) = up else {
        return Err(CliError::Usage("--up is zero: give another direction".to_owned()));
    };
    let asked = args.resolution.map(|(width, height)| width as f32 / height as f32);
    let (camera, notice) = automatic_camera(scene, up, asked.unwrap_or(DEFAULT_ASPECT), &file);
    notices.push(notice);
    Ok((camera.into(), None))
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

/// Finds a camera by its name, or else by its number.
///
/// # Errors
/// If there is no such camera.
fn find_camera(scene: &Scene, args: &RenderArgs, wanted: &str) -> Result<usize, LoadError> {
    let names = || scene.cameras.iter().map(|camera| camera.name.as_str());
    formats::find_by_name_or_number(names(), wanted)
        .ok_or_else(|| LoadError::no_such(&args.scene_file, "camera", wanted, names()))
}
