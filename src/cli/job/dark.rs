//! Why a picture will be black or empty, in words.

use crate::cli::settings::RenderArgs;
use crate::cli::settings::parse::LightArg;
use crate::math::{DVec3, Vec3};
use crate::render::Sight;
use crate::scene::defaults::{automatic_camera, describe_empty_scene};
use crate::scene::{Notice, Scene};

/// A frame that shows less of the scene is as good as empty.
const LEAST_SEEN: f32 = 0.002;
/// A picture of which less is lit is as good as black.
const LEAST_LIT: f32 = 0.02;
/// Who sees so many surfaces from behind is inside of something.
const INSIDE: f32 = 0.9;

/// What to say of a picture that will be black or empty; none of any other.
pub fn explain(args: &RenderArgs, scene: &Scene, sight: &Sight) -> Option<Notice> {
    let file = args.scene_file.display().to_string();
    if describe_empty_scene(scene, &file).is_some() {
        return None; // that has been said
    }
    let message = if sight.seen < LEAST_SEEN {
        describe_void(args, scene, sight)
    } else if sight.lit < LEAST_LIT {
        format!("the picture is black, or nearly so: {}", describe_dark(args, sight))
    } else {
        return None;
    };
    Some(Notice { place: file, message })
}

/// Nothing is in sight.
fn describe_void(args: &RenderArgs, scene: &Scene, sight: &Sight) -> String {
    let seen = percent(sight.seen);
    let shown = match sight.seen {
        0.0 => "no surface is in sight".to_owned(),
        _ => format!("no more than {seen} of the frame shows a surface"),
    };
    if sight.in_view >= LEAST_SEEN.max(2.0 * sight.seen) {
        return format!("{shown}: what lies in view is invisible, as its alpha cuts it away");
    }
    let is_own_camera = args.look_from.is_some() || !scene.cameras.is_empty();
    if !is_own_camera {
        return format!("{shown}: what is there is invisible, or too thin");
    }
    let up = args.up.and_then(|up| up.as_dvec3().try_normalize()).map(DVec3::as_vec3);
    let aspect = args.resolution.map_or(1.0, |(width, height)| width as f32 / height as f32);
    let (camera, _) = automatic_camera(scene, up.unwrap_or(Vec3::Y), aspect, "");
    let eye = camera.to_world.translation;
    let upright = up.map_or(String::new(), |up| format!(" --up {},{},{}", up.x, up.y, up.z));
    format!(
        "{shown}: the camera looks past the scene, or it is too small (all of it is seen with \
         --look-from {},{},{}{upright})",
        eye.x, eye.y, eye.z
    )
}

/// What is in sight is not lit.
fn describe_dark(args: &RenderArgs, sight: &Sight) -> String {
    if sight.black > 1.0 - LEAST_LIT {
        return "what is seen reflects no light at all".to_owned();
    }
    let lit = percent(sight.lit);
    let is_inside = sight.behind > INSIDE;
    let place = if is_inside { "the camera is inside of something closed, and " } else { "" };
    let flags = match args.light {
        LightArg::Camera => "",
        LightArg::Sky => " (--light camera)",
        LightArg::File | LightArg::Auto => " (--light sky, --light camera)",
    };
    format!("{place}light reaches {lit} of what is seen{flags}")
}

/// A share in percent, such that little is not nothing.
pub fn percent(share: f32) -> String {
    match 100.0 * f64::from(share) {
        0.0 => "0 %".to_owned(),
        x if x < 0.1 => "less than 0.1 %".to_owned(),
        x if x < 10.0 => format!("{x:.1} %"),
        x => format!("{x:.0} %"),
    }
}
