//! What shines in a TOML scene: punctual lights, surroundings, sun and sky.

use std::f64::consts::PI;
use std::path::Path;

use super::camera::vector;
use super::reader::Table;
use crate::formats::{Broken, EnvironmentSource, LoadError, NotFinite, uri};
use crate::light::{Environment, Preetham, Punctual, PunctualKind, Sun};
use crate::light::{Sky, sun_direction};
use crate::math::Vec3;
use crate::scene::Notice;

/// The most that a factor may be, so that products stay finite.
const MOST: f32 = 1e18;

/// A light without extent.
pub fn punctual(table: &Table) -> Result<Punctual, LoadError> {
    let word = table.required_text("type")?;
    let position = table.numbers::<3>("position")?.map(vector);
    let direction = unit(table, "direction")?;
    let needs = |key| table.fault(format!("a {word} light needs a {key}"));
    let (kind, position, direction) = match word {
        "point" => {
            let position = position.ok_or_else(|| needs("position"))?;
            (PunctualKind::Point, position, direction.unwrap_or(Vec3::NEG_Y))
        }
        "spot" => {
            let inner = table.number_in("inner", 0.0..=90.0)?.unwrap_or(0.0);
            let outer = table.number_in("outer", 0.0..=90.0)?.unwrap_or(45.0);
            if inner >= outer {
                let message = format!("is {inner}, which is not below outer, {outer} degrees");
                return Err(table.fault_at("inner", message));
            }
            let kind = PunctualKind::Spot { inner: inner.to_radians(), outer: outer.to_radians() };
            let position = position.ok_or_else(|| needs("position"))?;
            (kind, position, direction.ok_or_else(|| needs("direction"))?)
        }
        "directional" => {
            let direction = direction.ok_or_else(|| needs("direction"))?;
            (PunctualKind::Directional, position.unwrap_or_default(), direction)
        }
        other => {
            let message = format!("{other:?} is none of point, spot and directional");
            return Err(table.fault_at("type", message));
        }
    };
    let intensity = color(table, "color")?.unwrap_or(Vec3::ONE) * strength(table, kind)?;
    let range = table.positive("range")?;
    table.finish()?;
    Ok(Punctual { kind, position, direction, intensity, range })
}

/// `intensity`, or what it is by `lumen`, the flux of all that the light sends out. A spot's counts
/// as even within its outer cone, as KHR_lights_punctual has it, so that a softer edge is darker.
fn strength(table: &Table, kind: PunctualKind) -> Result<f32, LoadError> {
    let intensity = table.number_in("intensity", 0.0..=MOST)?;
    let Some(lumen) = table.number_in("lumen", 0.0..=MOST)? else {
        return Ok(intensity.unwrap_or(1.0));
    };
    if intensity.is_some() {
        return Err(table.fault_at("lumen", "goes without intensity: give one of the two"));
    }
    let solid_angle = match kind {
        PunctualKind::Point => 4.0 * PI,
        PunctualKind::Spot { outer, .. } => {
            // 2 pi (1 - cos), without the difference of what is nearly equal.
            let sine = libm::sin(0.5 * f64::from(outer));
            4.0 * PI * sine * sine
        }
        PunctualKind::Directional => {
            let message =
                "is for point and spot lights: a directional one has an intensity, in lux";
            return Err(table.fault_at("lumen", message));
        }
    };
    let candela = (f64::from(lumen) / solid_angle) as f32;
    if candela <= MOST {
        Ok(candela)
    } else {
        Err(table.fault_at("lumen", "is too much for so narrow a cone"))
    }
}

/// What is all around, as it is declared.
pub enum Surroundings {
    /// A colour or a file, which may be missing; what multiplies it, degrees that it turns, and
    /// what to do about pixels that are no numbers.
    Source(Result<EnvironmentSource, Broken>, f32, f32, NotFinite),
    /// A clear day, and what multiplies it.
    Sky(Sky, f32),
}

impl Surroundings {
    /// `[environment]`, of the scene in `folder`.
    pub fn read(table: &Table, folder: &Path) -> Result<Self, LoadError> {
        let source = match (table.text("file")?, color(table, "color")?) {
            (Some(name), None) => match uri::file(folder, name) {
                Ok(path) => Ok(EnvironmentSource::File(path)),
                Err(reason) => {
                    let (name, place) = (name.to_owned(), table.place());
                    Err(Broken { name, place, reason, texture: false })
                }
            },
            (None, Some(color)) => Ok(EnvironmentSource::Constant(color)),
            _ => return Err(table.fault("needs either a file or a color")),
        };
        let scale = table.number_in("scale", 0.0..=MOST)?.unwrap_or(1.0);
        let rotate = table.number_in("rotate", -f32::MAX..=f32::MAX)?.unwrap_or(0.0);
        let repair = table.switch("repair")?.unwrap_or(false);
        let not_finite = if repair { NotFinite::Repair } else { NotFinite::Refuse };
        table.finish()?;
        Ok(Self::Source(source, scale, rotate, not_finite))
    }

    /// `[sky]`.
    pub fn read_sky(table: &Table) -> Result<Self, LoadError> {
        let default = Sky::default();
        let turbidity = table.number_in("turbidity", Preetham::TURBIDITY)?;
        let ground_albedo = table.number_in("ground-albedo", 0.0..=1.0)?;
        let diameter = table.number_in("sun-diameter", 0.0..=180.0)?.unwrap_or(Sun::DIAMETER);
        let sky = Sky {
            turbidity: turbidity.unwrap_or(default.turbidity),
            sun: towards_sun(table)?,
            ground_albedo: ground_albedo.unwrap_or(default.ground_albedo),
            sun_diameter: (diameter > 0.0).then_some(diameter),
        };
        if sky.sun.y < 0.0 {
            return Err(table.fault_at("sun-direction", "leads below the horizon"));
        }
        let scale = table.number_in("scale", 0.0..=MOST)?.unwrap_or(1.0);
        table.finish()?;
        Ok(Self::Sky(sky, scale))
    }

    /// Whether there is a sun already.
    pub fn has_sun(&self) -> bool {
        matches!(self, Self::Sky(Sky { sun_diameter: Some(_), .. }, _))
    }

    /// The file that is missing.
    pub fn broken(&self) -> Option<&Broken> {
        match self {
            Self::Source(source, ..) => source.as_ref().err(),
            Self::Sky(..) => None,
        }
    }

    /// The environment, and what is odd about its file; black where the file is missing.
    pub fn load(&self) -> Result<(Environment, Vec<Notice>), LoadError> {
        match self {
            Self::Source(Ok(source), scale, rotate, not_finite) => {
                source.load(*scale, *rotate, *not_finite)
            }
            Self::Source(Err(_), ..) => Ok((Environment::constant(Vec3::ZERO), Vec::new())),
            Self::Sky(sky, scale) => Ok((sky.environment(*scale), Vec::new())),
        }
    }
}

/// A sun alone.
pub fn sun(table: &Table) -> Result<Sun, LoadError> {
    let direction = towards_sun(table)?;
    let diameter = table.number_in("diameter", 1e-3..=180.0)?.unwrap_or(Sun::DIAMETER);
    let irradiance = color(table, "color")?.unwrap_or(Vec3::ONE)
        * table.number_in("irradiance", 0.0..=MOST)?.unwrap_or(1.0);
    table.finish()?;
    Ok(Sun::new(direction, diameter, irradiance))
}

/// By a direction, or by an elevation and an azimuth.
fn towards_sun(table: &Table) -> Result<Vec3, LoadError> {
    let direction = unit(table, "sun-direction")?;
    let elevation = table.number_in("sun-elevation", 0.0..=90.0)?;
    let azimuth = table.number_in("sun-azimuth", -360.0..=360.0)?;
    match direction {
        Some(_) if elevation.is_some() || azimuth.is_some() => {
            Err(table.fault_at("sun-direction", "is given by elevation and azimuth too"))
        }
        Some(direction) => Ok(direction),
        None => Ok(sun_direction(elevation.unwrap_or(45.0), azimuth.unwrap_or(135.0))),
    }
}

fn unit<'d>(table: &Table<'d>, key: &'d str) -> Result<Option<Vec3>, LoadError> {
    let Some(direction) = table.numbers::<3>(key)? else { return Ok(None) };
    match crate::math::DVec3::from_array(direction).try_normalize() {
        Some(direction) => Ok(Some(direction.as_vec3())),
        None => Err(table.fault_at(key, "is zero: it leads nowhere")),
    }
}

fn color<'d>(table: &Table<'d>, key: &'d str) -> Result<Option<Vec3>, LoadError> {
    let Some(color) = table.numbers::<3>(key)?.map(vector) else { return Ok(None) };
    if color.min_element() < 0.0 || color.max_element() > MOST {
        return Err(table.fault_at(key, "a colour's numbers are 0 or more"));
    }
    Ok(Some(color))
}
