//! What lights the scene: what it has itself, a neutral sky with that, or a lamp at the camera.
//!
//! Under `--light auto` a look ahead decides, see [`crate::render::look_ahead`]. What is decided
//! becomes a part of the scene, so that its digest tells parts, checkpoints and pictures apart by
//! it; and the setting `light`, so that a picture's header tells it and `--from` repeats it.

use std::f32::consts::PI;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::dark::percent;
use super::scene::build_world;
use super::{scene, view};
use crate::accel::{self, Accel, BuildError};
use crate::camera::moving::MovingCamera;
use crate::camera::{Camera, Projection};
use crate::cli::error::CliError;
use crate::cli::input;
use crate::cli::settings::RenderArgs;
use crate::cli::settings::parse::LightArg;
use crate::cli::status::Phase;
use crate::cli::watch::Watch;
use crate::light::{Environment, Punctual, PunctualKind};
use crate::math::Vec3;
use crate::render::{Sight, look_ahead};
use crate::scene::defaults::{neutral_sky, shines};
use crate::scene::{Notice, Scene};
use crate::texture::{Texture, TextureStore};
use crate::world::World;

/// A lamp must light so much more than what it takes the place of.
const GAIN: f32 = 1.5;
/// The radiance of white paper that faces the lamp, at half of the distances.
const PAPER: f32 = 0.8;

/// Settles what the flags say of the light: under `--strict` nothing is decided for the user, and
/// an environment that is asked for takes the place of the neutral sky. What is to be said.
pub fn settle(args: &mut RenderArgs) -> Option<Notice> {
    if args.strict && args.light == LightArg::Auto {
        args.light = LightArg::File;
    }
    let others = [("--env", args.env.is_some()), ("--sky", args.sky.is_some())];
    let (flag, _) = others.into_iter().find(|(_, is_given)| *is_given)?;
    if args.light != LightArg::Sky {
        return None;
    }
    args.light = LightArg::File;
    Some(notice(args, format!("--light sky has no effect beside {flag}")))
}

/// What lights a scene, as it was asked for or decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lighting {
    /// Never [`LightArg::Auto`].
    pub light: LightArg,
    /// The intensity of a lamp at the camera: candela, or lux if all rays are parallel.
    lamp: f32,
    /// Where the neutral sky is brightest.
    up: Vec3,
}

impl Lighting {
    /// What the flags ask for, without a look ahead: under `auto`, a sky where nothing shines.
    pub fn as_asked(args: &RenderArgs, scene: &Scene) -> Self {
        let light = match args.light {
            LightArg::Auto if shines(scene) => LightArg::File,
            LightArg::Auto => LightArg::Sky,
            asked => asked,
        };
        // An own camera may be turned in any way; what is up in the scene it does not say.
        let up = args.up.filter(|_| args.look_from.is_none());
        let up = up.and_then(Vec3::try_normalize).unwrap_or(Vec3::Y);
        Self { light, lamp: 0.0, up }
    }

    /// Puts it into a scene that is seen from a camera.
    pub fn apply(&self, scene: &mut Scene, camera: &Camera) {
        match self.light {
            LightArg::Sky => scene.environment = Some(neutral_sky(self.up)),
            LightArg::Camera => scene.lights.push(self.lamp_at(camera)),
            LightArg::File | LightArg::Auto => {}
        }
    }

    fn lamp_at(&self, camera: &Camera) -> Punctual {
        let kind = match camera.projection {
            Projection::Orthographic { .. } => PunctualKind::Directional,
            Projection::Perspective { .. } | Projection::Panorama => PunctualKind::Point,
        };
        Punctual {
            kind,
            position: camera.to_world.translation.into(),
            direction: camera.to_world.transform_vector3(Vec3::NEG_Z),
            intensity: Vec3::splat(self.lamp),
            range: None,
        }
    }

    /// The same with a lamp, which is as bright as what is seen is far away.
    fn with_lamp(self, camera: &Camera, sight: &Sight) -> Self {
        let distance = match camera.projection {
            Projection::Orthographic { .. } => 1.0,
            Projection::Perspective { .. } | Projection::Panorama => sight.distance,
        };
        let lamp = (PAPER * PI * distance * distance).clamp(f32::MIN_POSITIVE, f32::MAX);
        Self { light: LightArg::Camera, lamp, ..self }
    }
}

/// What was decided.
pub struct Decided {
    pub lighting: Lighting,
    /// How to say so.
    pub notice: Option<Notice>,
    /// What is seen by it, if someone has looked.
    pub sight: Option<Sight>,
}

impl Decided {
    /// What the flags ask for, without a look ahead.
    pub fn as_asked(args: &RenderArgs, scene: &Scene) -> Self {
        let lighting = Lighting::as_asked(args, scene);
        let is_auto = args.light == LightArg::Auto && lighting.light == LightArg::Sky;
        let message = is_auto.then(|| NO_LIGHT.to_owned());
        Self { lighting, notice: message.map(|message| notice(args, message)), sight: None }
    }
}

/// A structure, and the time that it took to build.
pub type Structure = (Box<dyn Accel>, Duration);

/// Builds the structure that is asked for, on the threads of the current pool.
///
/// # Errors
/// As [`accel::build`].
pub fn build(args: &RenderArgs, world: &World, watch: &Watch) -> Result<Structure, BuildError> {
    watch.enter(Phase::Build);
    let start = Instant::now();
    let triangles = world.triangles.clone();
    let accel = accel::build_metered(&args.accel, triangles, args.isa, watch.meter())?;
    Ok((accel, start.elapsed()))
}

/// Makes a scene ready, which is as its file and flags have it, and looks at it; it is lit as was
/// decided `before`, or as is decided now.
///
/// # Errors
/// If it has too many triangles, or the structure cannot be built.
pub fn look(
    args: &RenderArgs,
    scene: Scene,
    camera: &MovingCamera,
    (before, watch): (Option<Decided>, &Watch),
) -> Result<(World, Decided, Structure), CliError> {
    let resolution = view::resolution(args, 1.0); // it has been worked out
    let lighting = before.as_ref().map(|before| before.lighting);
    let mut viewed = Viewed::new(args, scene, camera, (resolution, lighting))?;
    input::run_on_threads(args.threads, move || {
        let structure = build(args, &viewed.world, watch)?;
        let accel = &*structure.0;
        let decided = match before {
            Some(before) => Decided { sight: Some(viewed.look(accel)), ..before },
            None => viewed.decide(accel),
        };
        Ok((viewed.world, decided, structure))
    })?
}

/// What lights a scene in motion: decided at 0 seconds, so that no frame differs from the next.
/// None where the scene at its `time` decides itself: it is still, posed at 0 seconds, or cannot
/// be posed then. With its textures, for whoever loads the scene again.
///
/// # Errors
/// If there is not enough memory, or the structure cannot be built.
pub fn decide_at_zero(
    args: &RenderArgs,
    textures: &Arc<TextureStore>,
    watch: &Watch,
) -> Result<Option<(Decided, Vec<Texture>)>, CliError> {
    let needs_look = matches!(args.light, LightArg::Auto | LightArg::Camera);
    if !needs_look || args.time.is_none_or(|time| time == 0.0) {
        return Ok(None);
    }
    let args = &RenderArgs { time: Some(0.0), ..args.clone() };
    let Ok((scene, _)) = scene::load(args, textures, watch) else { return Ok(None) };
    let Ok((camera, aspect)) = view::choose(&scene, args, &mut Vec::new()) else {
        return Ok(None);
    };
    scene::require_memory(args, &scene, textures, 0)?;
    let images = scene.textures.clone();
    let resolution = view::resolution(args, aspect);
    let mut viewed = Viewed::new(args, scene, &camera, (resolution, None))?;
    input::run_on_threads(args.threads, move || {
        let (accel, _) = build(args, &viewed.world, watch)?;
        Ok(Some((viewed.decide(&*accel), images)))
    })?
}

/// A scene that is looked at.
struct Viewed<'a> {
    args: &'a RenderArgs,
    world: World,
    camera: &'a MovingCamera,
    /// Of the whole frame, pixels.
    resolution: (u32, u32),
    /// Whether anything shines in the scene, or in what the flags put around it.
    shines: bool,
    /// The lights without extent that the scene has itself.
    lamps: usize,
    /// What lights it now.
    now: Lighting,
    /// The environment whose place a neutral sky has now.
    own: Option<Environment>,
}

impl<'a> Viewed<'a> {
    /// Makes a scene ready, lit as is known, or else as is most likely: who guesses right need not
    /// change the lights of a scene that may be large.
    fn new(
        args: &'a RenderArgs,
        mut scene: Scene,
        camera: &'a MovingCamera,
        (resolution, known): ((u32, u32), Option<Lighting>),
    ) -> Result<Self, CliError> {
        let (shines, lamps) = (shines(&scene), scene.lights.len());
        let asked = Lighting::as_asked(args, &scene);
        let now = known.unwrap_or(match asked.light {
            // How bright a lamp must be, is not known yet.
            LightArg::Camera => Lighting { light: LightArg::File, ..asked },
            _ => asked,
        });
        now.apply(&mut scene, &camera.camera);
        let world = build_world(scene, args)?;
        Ok(Self { args, world, camera, resolution, shines, lamps, now, own: None })
    }

    /// Looks ahead at the world as it is lit now; `accel` is of its triangles.
    fn look(&self, accel: &dyn Accel) -> Sight {
        let (width, height) = self.resolution;
        look_ahead(&self.world, self.camera, accel, width as f32 / height as f32)
    }

    /// Puts other light into the world.
    fn light(&mut self, lighting: Lighting) {
        let Self { camera, lamps, now, own, .. } = self;
        self.world.relight(self.args.lights, |scene| {
            scene.lights.truncate(*lamps);
            if now.light == LightArg::Sky {
                scene.environment = own.take();
            }
            if lighting.light == LightArg::Sky {
                *own = scene.environment.take();
            }
            lighting.apply(scene, &camera.camera);
        });
        self.now = lighting;
    }

    /// The same, and looks.
    fn look_under(&mut self, lighting: Lighting, accel: &dyn Accel) -> Sight {
        self.light(lighting);
        self.look(accel)
    }

    /// Decides what is to light the world, and lights it so.
    fn decide(&mut self, accel: &dyn Accel) -> Decided {
        let first = self.look(accel);
        let (lighting, sight, message) = match self.args.light {
            LightArg::Auto if self.shines => self.decide_for_lit(first, accel),
            LightArg::Auto => self.decide_for_dark(first, accel),
            LightArg::File | LightArg::Sky => (self.now, first, None),
            LightArg::Camera => {
                let lamp = self.now.with_lamp(&self.camera.camera, &first);
                (lamp, self.look_under(lamp, accel), None)
            }
        };
        if self.now != lighting {
            self.light(lighting);
        }
        let notice = message.map(|message| notice(self.args, message));
        Decided { lighting, notice, sight: Some(sight) }
    }

    /// For a scene in which nothing shines: a sky, or a lamp where that does not reach.
    fn decide_for_dark(&mut self, under_sky: Sight, accel: &dyn Accel) -> Decision {
        let sky = self.now;
        if under_sky.is_lit() || under_sky.seen == 0.0 {
            return (sky, under_sky, Some(NO_LIGHT.to_owned()));
        }
        let lamp = sky.with_lamp(&self.camera.camera, &under_sky);
        let under_lamp = self.look_under(lamp, accel);
        if under_lamp.reached > GAIN * under_sky.reached {
            return (lamp, under_lamp, Some(describe_lamp("no light", &under_sky)));
        }
        (sky, under_sky, Some(NO_LIGHT.to_owned()))
    }

    /// For a scene in which something shines: that, if it lights what is seen.
    fn decide_for_lit(&mut self, own: Sight, accel: &dyn Accel) -> Decision {
        let file = self.now;
        // An environment that was asked for is not replaced, nor helped.
        let is_told = self.args.env.is_some() || self.args.sky.is_some();
        if is_told || own.is_lit() || own.seen == 0.0 {
            return (file, own, None);
        }
        let sky = Lighting { light: LightArg::Sky, ..file };
        let environment = self.world.scene.environment.as_ref();
        let has_sky = environment.is_some_and(|it| it.mean().max_element() > 0.0);
        let under_sky = if has_sky { own } else { self.look_under(sky, accel) };
        if !has_sky && under_sky.is_lit() {
            return (sky, under_sky, Some(describe_sky(&own)));
        }
        let lamp = file.with_lamp(&self.camera.camera, &own);
        let under_lamp = self.look_under(lamp, accel);
        if under_lamp.reached > GAIN * own.reached.max(under_sky.reached) {
            let own = format!("its light reaches {} of what is seen", percent(own.reached));
            return (lamp, under_lamp, Some(describe_lamp(&own, &under_sky)));
        }
        if under_sky.reached > own.reached {
            return (sky, under_sky, Some(describe_sky(&own)));
        }
        (file, own, None)
    }
}

/// What lights a scene, what is seen by that, and how to say so.
type Decision = (Lighting, Sight, Option<String>);

/// What is said of a scene in which nothing shines.
const NO_LIGHT: &str = "no light: under a neutral sky, brightest above (--light sky, --env)";

fn notice(args: &RenderArgs, message: String) -> Notice {
    Notice { place: args.scene_file.display().to_string(), message }
}

fn describe_sky(own: &Sight) -> String {
    let share = percent(own.reached);
    format!(
        "its light reaches {share} of what is seen: under a neutral sky, too, as with --light sky \
         (--light file: without)"
    )
}

/// `own` says how much light there is without.
fn describe_lamp(own: &str, under_sky: &Sight) -> String {
    let sky = percent(under_sky.reached);
    format!(
        "{own}, and that of a sky reaches {sky} of what is seen: with a lamp at the camera, as \
         with --light camera (--light file: without)"
    )
}
