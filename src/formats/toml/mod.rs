//! TOML scenes: glTF, OBJ and PLY files, and other TOML scenes, placed together, with a camera,
//! light and settings.
//!
//! - `[[place]]`: `file`; `translate`, `rotate` (degrees about X, then Y, then Z; or a quaternion),
//!   `scale`, or a `matrix` by columns; `copies`, a file or a list of points or of tables with the
//!   same keys; `scene`, `variant`, `animation`, `time` (at which it then stands still under
//!   `--shutter`); `material."name"`.
//! - `[material."name"]`: changes of materials of that name in all files; `"*"`: of all materials.
//! - `[[camera]]`: `look-from`, `look-at`, `up`, `fov`, `aperture`, `focus`, `name`.
//! - `[environment]`: `file` or `color`; `scale`, `rotate`, `repair`.
//! - `[sky]`: `turbidity`, `sun-elevation` and `sun-azimuth` or `sun-direction`, `sun-diameter` (0:
//!   none), `ground-albedo`, `scale`.
//! - `[sun]`: where it stands as in `[sky]`; `color`, `irradiance`, `diameter`.
//! - `[[light]]`: `type`, `position`, `direction`, `color`, `intensity` or `lumen` (of point and
//!   spot lights), `range`, `inner`, `outer`.
//! - `[medium]`: what fills all space but solids: `absorption` and `scattering` per metre, of all
//!   light or by colour; `anisotropy`.
//! - `[render]`: the flags of `dapple render` by their names; read by the command line.
//!
//! Angles are in degrees, lengths in metres, directions need not be of unit length. Paths are
//! relative to the file and stay in its folder. A key that none of these is, is an error.
//!
//! A file is loaded once, however often it is placed, by this scene or by scenes within it. A
//! placed scene brings its meshes, lights and cameras, not its surroundings and settings.

mod camera;
mod copies;
mod library;
mod light;
mod material;
mod medium;
mod place;
mod placement;
mod reader;
mod root;
mod settings;
mod transform;

use std::path::Path;

use self::camera::CameraDeclaration;
use self::library::Library;
use self::light::Surroundings;
use self::material::Overrides;
use self::place::Stage;
use self::placement::Placement;
use self::reader::Table;
pub use self::reader::unknown_key;
use self::root::with_root;
pub use self::settings::{Setting, SettingValue, settings, settings_of_text};
use super::model::load_model;
use super::{LoadError, LoadOptions, read_file};
use crate::light::{Environment, Punctual, Sun};
use crate::math::Vec3;
use crate::medium::Medium;
use crate::scene::defaults::bounds;
use crate::scene::{NamedCamera, Notice, Scene};

/// Whether a file is a TOML scene, by its ending.
pub fn is_toml(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}

/// Loads a file and those that it places.
///
/// # Errors
/// As [`parse`], or if it cannot be read.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    parse(path, &read_file(path)?, options)
}

/// Reads a file's contents; `path` is for messages and for the folder of the files beside it.
///
/// # Errors
/// [`LoadError`] with the line; all files that are missing at once.
pub fn parse(path: &Path, bytes: &[u8], options: &LoadOptions) -> Result<Scene, LoadError> {
    let mut library = Library::default();
    library.open(path).map_err(|message| LoadError::invalid(path, "", message))?;
    parse_within(path, bytes, options, &mut library)
}

/// Reads a scene that the library has open.
fn parse_within(
    path: &Path,
    bytes: &[u8],
    options: &LoadOptions,
    library: &mut Library,
) -> Result<Scene, LoadError> {
    options.refuse_choices(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    with_root(path, bytes, |root| {
        Declarations::read(root, folder)?.compose(path, folder, options, library)
    })
}

/// Reads the text of a file alone, without those that it names: what a fuzzer calls.
///
/// # Errors
/// As [`parse`].
pub fn check(bytes: &[u8]) -> Result<(), LoadError> {
    let (path, folder) = (Path::new("fuzz.toml"), Path::new("/nowhere"));
    with_root(path, bytes, |root| Declarations::read(root, folder).map(drop))?;
    settings::read(path, folder, bytes, &|key, _| key == "env").map(drop)
}

/// All that the text says.
struct Declarations<'d> {
    placements: Vec<Placement<'d>>,
    /// Of materials in all files.
    overrides: Overrides,
    cameras: Vec<CameraDeclaration<'d>>,
    lights: Vec<Punctual>,
    surroundings: Option<Surroundings>,
    sun: Option<Sun>,
    medium: Option<Medium>,
}

impl<'d> Declarations<'d> {
    /// Reads all; that a file is not there is found, but no file is read.
    fn read(root: &Table<'d>, folder: &Path) -> Result<Self, LoadError> {
        root.table("render")?; // the command line's
        let each = |table: &Table<'d>| light::punctual(table);
        let (surroundings, sun) = surroundings(root, folder)?;
        let all = Self {
            placements: root
                .tables("place")?
                .into_iter()
                .map(Placement::read)
                .collect::<Result<_, _>>()?,
            overrides: match root.table("material")? {
                Some(tables) => Overrides::read(&tables)?,
                None => Overrides::default(),
            },
            cameras: root
                .tables("camera")?
                .into_iter()
                .map(CameraDeclaration::read)
                .collect::<Result<_, _>>()?,
            lights: root.tables("light")?.iter().map(each).collect::<Result<_, _>>()?,
            surroundings,
            sun,
            medium: match root.table("medium")? {
                Some(table) => Some(medium::medium(&table)?),
                None => None,
            },
        };
        root.finish()?;
        Ok(all)
    }

    /// Loads what is placed and puts it together.
    fn compose(
        self,
        path: &Path,
        folder: &Path,
        options: &LoadOptions,
        library: &mut Library,
    ) -> Result<Scene, LoadError> {
        let mut stage = Stage::new(folder, options, library);
        stage.broken.extend(self.surroundings.iter().filter_map(Surroundings::broken).cloned());
        for placement in &self.placements {
            let Some(part) = stage.find(placement) else { continue };
            let loaded = load_placed(placement, &part.0, options, stage.library);
            stage.keep(part, loaded)?;
        }
        if !stage.broken.is_empty() {
            let (file, broken) = (path.display().to_string(), stage.broken);
            return Err(LoadError::References { file, broken });
        }
        let names = stage.material_names();
        if let Some((name, line)) = self.overrides.find_unmatched(&names) {
            let message = crate::formats::choice::absent("material", name, &names);
            return Err(LoadError::line(path, line, message));
        }
        for placement in &self.placements {
            stage.place(placement, &self.overrides)?;
        }
        let mut scene = stage.scene;
        let own = self.own_cameras(&scene)?;
        if let Some(motion) = &mut scene.motion {
            motion.shift_cameras(own.len());
        }
        scene.cameras.splice(0..0, own);
        scene.lights.extend(self.lights);
        scene.medium = self.medium;
        if let Some(surroundings) = &self.surroundings {
            let (environment, mut notices) = surroundings.load()?;
            scene.notices.append(&mut notices);
            scene.environment = Some(environment);
        }
        if let Some(sun) = self.sun {
            let behind = scene.environment.take();
            let behind = behind.unwrap_or_else(|| Environment::constant(Vec3::ZERO));
            scene.environment = Some(behind.with_sun(sun));
        }
        if !library.is_within() {
            note_left_out(&mut scene, path, library);
        }
        Ok(scene)
    }

    /// The cameras that the file tells itself.
    fn own_cameras(&self, scene: &Scene) -> Result<Vec<NamedCamera>, LoadError> {
        if self.cameras.is_empty() {
            return Ok(Vec::new());
        }
        let bounds = bounds(scene);
        let centre = if bounds.is_empty() { Vec3::ZERO } else { bounds.centre() };
        self.cameras.iter().map(|camera| camera.place(centre)).collect()
    }
}

/// Notes what is left out of placed scenes where the scene at `path` has nothing in its place.
fn note_left_out(scene: &mut Scene, path: &Path, library: &Library) {
    let (surroundings, media) = (&library.without_surroundings, &library.without_medium);
    let mut note = |message| {
        scene.notices.push(Notice { place: path.display().to_string(), message });
    };
    for placed in surroundings.iter().filter(|_| scene.environment.is_none()) {
        note(format!("the surroundings of {} are left out", placed.display()));
    }
    for placed in media.iter().filter(|_| scene.medium.is_none()) {
        note(format!("the medium of {} is left out", placed.display()));
    }
}

/// Loads a file that is placed.
fn load_placed(
    placement: &Placement,
    path: &Path,
    options: &LoadOptions,
    library: &mut Library,
) -> Result<Scene, LoadError> {
    let options = placement.options(options);
    if !is_toml(path) {
        return load_model(path, &options);
    }
    library.open(path).map_err(|message| placement.table.fault_at("file", message))?;
    let scene = parse_within(path, &read_file(path)?, &options, library);
    library.close();
    scene
}

/// The environment or the sky, and a sun before it.
fn surroundings(
    root: &Table,
    folder: &Path,
) -> Result<(Option<Surroundings>, Option<Sun>), LoadError> {
    let behind = match (root.table("environment")?, root.table("sky")?) {
        (Some(_), Some(sky)) => return Err(sky.fault("there is an [environment] already")),
        (Some(table), None) => Some(Surroundings::read(&table, folder)?),
        (None, Some(table)) => Some(Surroundings::read_sky(&table)?),
        (None, None) => None,
    };
    let Some(table) = root.table("sun")? else { return Ok((behind, None)) };
    if behind.as_ref().is_some_and(Surroundings::has_sun) {
        return Err(table.fault("the [sky] has a sun: give it sun-diameter = 0"));
    }
    let sun = light::sun(&table)?;
    Ok((behind, Some(sun)))
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_copies;
