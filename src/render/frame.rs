//! A whole picture in one call.

use std::sync::atomic::AtomicBool;

use super::film::Film;
use super::progress::Progress;
use super::rendered::Rendered;
use super::settings::Settings;
use super::ticks::with_ticks;
use crate::accel::Accel;
use crate::camera::moving::MovingCamera;
use crate::world::World;

/// How a render talks to its caller while it runs.
pub struct Control<'a> {
    /// Once true, tiles under way finish their block of samples, and the picture is made of what
    /// there is.
    pub cancel: &'a AtomicBool,
    /// Called from a thread of its own, some ten times a second and once at the end.
    pub progress: &'a (dyn Fn(Progress) + Sync),
}

impl Default for Control<'static> {
    /// Reports nothing and never cancels.
    fn default() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self { cancel: &NEVER, progress: &|_| {} }
    }
}

/// Renders a picture, on the threads of the current rayon pool.
///
/// The result is a function of the world, the camera and the settings: neither `accel` nor the
/// number of threads changes a bit of it, except for the layer `cost`. All pixels take 16 samples,
/// then all of them 16 more, then 32, 64 and so on, so that a cancelled picture is complete, only
/// noisier; of a large picture they first take a single one.
///
/// # Examples
/// ```
/// use dapple::{AccelSpec, BsdfForm, Control, Isa, Scene, Settings, World};
///
/// // An empty scene under the neutral sky: alpha is 1, and all that the camera sees is the sky.
/// let mut scene = Scene::default();
/// scene.add_defaults(1.0);
/// let camera = scene.cameras[0].camera;
/// let world = World::new(scene, BsdfForm::default())?;
/// let accel = dapple::build(&AccelSpec::default(), world.triangles.clone(), Isa::Auto)?;
/// let settings = Settings { spp: 1, ..Settings::new(4, 4) };
/// let rendered = dapple::render(&world, &camera, &*accel, &settings, &Control::default());
/// assert_eq!(rendered.picture.channel("A"), Some(&[1.0; 16][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render(
    world: &World,
    camera: impl Into<MovingCamera>,
    accel: &dyn Accel,
    settings: &Settings,
    control: &Control<'_>,
) -> Rendered {
    let (film, camera) = (Film::new(settings.clone()), camera.into());
    with_ticks(&|| (control.progress)(film.progress()), || {
        film.accumulate(world, &camera, accel, settings.spp, control.cancel);
    });
    film.finish()
}
