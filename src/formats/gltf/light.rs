//! Lights of KHR_lights_punctual.

use glam::{DAffine3, DVec3};

use super::json::{Fault, Object};
use super::notices::Notices;
use crate::light::{Punctual, PunctualKind};
use crate::math::Vec3;
use crate::scene::placement;

/// A light without its place.
#[derive(Clone, Debug, PartialEq)]
pub struct LightDeclaration {
    /// Which way it shines.
    pub kind: PunctualKind,
    /// Linear colour times intensity: candela, or lux for a directional light.
    pub intensity: Vec3,
    /// Metres beyond which it does not shine; none: no end.
    pub range: Option<f32>,
}

impl LightDeclaration {
    /// The light at a node; its strength is not scaled with it. None if it has a direction and the
    /// node's transform has none, as with a scale of 0; a point light needs but the position.
    pub fn place(&self, to_world: &DAffine3) -> Option<Punctual> {
        let Self { kind, intensity, range } = *self;
        let (position, direction) = (Vec3::ZERO, Vec3::NEG_Z);
        let light = Punctual { kind, position, direction, intensity, range };
        placement::light_at_node(&light, to_world)
    }
}

/// The most that anything shines by: what reaches a pixel from it is within the range of f32, if
/// it is not nearer than some tenths of a millimetre.
const STRONGEST: f32 = 1e30;

/// A colour times a strength in f32, of the [`STRONGEST`] at most; `say` hears of one that is more.
pub fn strength(wanted: DVec3, say: impl FnOnce(String)) -> Vec3 {
    let most = wanted.max_element();
    if most <= f64::from(STRONGEST) {
        return wanted.as_vec3();
    }
    say(format!("shines by {most:.2e}, more than can be reckoned with: {STRONGEST:e} is used"));
    (wanted * (f64::from(STRONGEST) / most)).as_vec3()
}

/// Reads all lights.
pub fn read(root: &Object, notices: &mut Notices) -> Result<Vec<LightDeclaration>, Fault> {
    let Some(extension) = root.extension("KHR_lights_punctual")? else { return Ok(Vec::new()) };
    extension.objects("lights")?.iter().map(|object| light(object, notices)).collect()
}

fn light(object: &Object, notices: &mut Notices) -> Result<LightDeclaration, Fault> {
    let kind = match object.text("type")?.ok_or_else(|| object.absent("type"))? {
        "point" => PunctualKind::Point,
        "directional" => PunctualKind::Directional,
        "spot" => spot(object, notices)?,
        other => {
            let message = format!("{other:?} is none of point, spot and directional");
            return Err(object.fault_at("type", message));
        }
    };
    let color = object.numbers::<3>("color")?.unwrap_or([1.0; 3]);
    let color = Vec3::from_array(color.map(|x| x as f32));
    let intensity = object.number("intensity")?.unwrap_or(1.0);
    if intensity < 0.0 {
        notices.add(object.place(), "takes light away, which is not supported: it is off");
    } else if color.min_element() < 0.0 {
        let message = "its colour is negative in part, which is not supported: taken as 0 there";
        notices.add(object.at("color"), message);
    }
    let range = object.number("range")?;
    if range.is_some_and(|range| range <= 0.0) {
        return Err(object.fault_at("range", "must be above 0"));
    }
    let intensity = color.max(Vec3::ZERO).as_dvec3() * f64::from(intensity.max(0.0));
    let name = object.name()?;
    let intensity = strength(intensity, |message| {
        notices.add(object.place(), format!("{name:?} {message}"));
    });
    Ok(LightDeclaration { kind, intensity, range })
}

/// Angles that are out of order leave a sharp edge: files of other programs have such, by rounding
/// or by meaning it.
fn spot(object: &Object, notices: &mut Notices) -> Result<PunctualKind, Fault> {
    let spot = object.object("spot")?.ok_or_else(|| object.absent("spot"))?;
    let inner = spot.number("innerConeAngle")?.unwrap_or(0.0);
    let outer = spot.number("outerConeAngle")?.unwrap_or(std::f32::consts::FRAC_PI_4);
    let widest = std::f32::consts::FRAC_PI_2;
    if inner < 0.0 || outer < 0.0 || outer > widest + 1e-6 || inner > outer {
        let message =
            format!("cone angles {inner} and {outer} are not in order between 0 and pi/2");
        notices.add(spot.place(), format!("{message}: they are taken to the nearest that are"));
    }
    let outer = outer.clamp(0.0, widest);
    Ok(PunctualKind::Spot { inner: inner.clamp(0.0, outer), outer })
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;

    fn light_of(text: &str) -> Result<LightDeclaration, Fault> {
        let text =
            format!("{{\"extensions\": {{\"KHR_lights_punctual\": {{\"lights\": [{text}]}}}}}}");
        let value = json::parse(text.as_bytes()).expect("valid JSON");
        let root = Object::new(&value, String::new()).expect("an object");
        read(&root, &mut Notices::default()).map(|mut all| all.remove(0))
    }

    /// A light and what is said of it.
    fn noted(text: &str) -> (LightDeclaration, String) {
        let text =
            format!("{{\"extensions\": {{\"KHR_lights_punctual\": {{\"lights\": [{text}]}}}}}}");
        let value = json::parse(text.as_bytes()).expect("valid JSON");
        let root = Object::new(&value, String::new()).expect("an object");
        let mut notices = Notices::default();
        let light = read(&root, &mut notices).expect("valid").remove(0);
        (light, notices.finish(std::path::Path::new("a")).remove(0).message)
    }

    #[test]
    fn colours_scale_the_intensity() {
        let light = light_of(r#"{"type": "point", "color": [1, 0.5, 0], "intensity": 10}"#);
        let intensity = Vec3::new(10.0, 5.0, 0.0);
        let expected = LightDeclaration { kind: PunctualKind::Point, intensity, range: None };
        assert_eq!(light, Ok(expected));
    }

    #[test]
    fn lights_shine_along_minus_z_of_their_node() {
        let light = light_of(r#"{"type": "directional"}"#).expect("valid");
        let turned = DAffine3::from_rotation_y(std::f64::consts::FRAC_PI_2);
        let placed = light.place(&turned).expect("has directions");
        assert!(placed.direction.distance(-Vec3::X) < 1e-6);
    }

    /// Nothing shines less than not at all; what is said is what is done.
    #[test]
    fn negative_light_is_taken_as_none_and_said() {
        let said = |text: &str| {
            let (light, message) = noted(text);
            (light.intensity, message)
        };
        let (intensity, message) = said(r#"{"type": "point", "color": [2, 1, -1]}"#);
        assert_eq!(intensity, Vec3::new(2.0, 1.0, 0.0));
        assert!(message.ends_with("taken as 0 there") && !message.contains("off"), "{message}");
        let (intensity, message) = said(r#"{"type": "point", "intensity": -1}"#);
        assert_eq!(intensity, Vec3::ZERO);
        assert!(message.ends_with("it is off"), "{message}");
    }

    /// It shines, in its colour, as bright as anything can, and that is said.
    #[test]
    fn what_is_too_strong_shines_by_less_and_is_named() {
        for (text, expected, value) in [
            (r#"{"type": "point", "name": "sun", "intensity": 1e38}"#, [1.0, 1.0, 1.0], "1.00e38"),
            (
                r#"{"type": "directional", "color": [1e20, 5e19, 0], "intensity": 1e20}"#,
                [1.0, 0.5, 0.0],
                "1.00e40",
            ),
        ] {
            let (light, said) = noted(text);
            let off = light.intensity / STRONGEST - Vec3::from_array(expected);
            assert!(off.abs().max_element() < 1e-6, "{text}: {}", light.intensity);
            assert!(said.contains(&format!("shines by {value},")), "{said}");
            assert!(said.contains(": 1e30 is used"), "{said}");
        }
        assert!(noted(r#"{"type": "point", "name": "sun", "intensity": 1e38}"#).1.contains("sun"));
    }

    #[test]
    fn a_point_light_needs_no_direction() {
        let flat = DAffine3::from_scale_rotation_translation(
            glam::DVec3::ZERO,
            glam::DQuat::IDENTITY,
            glam::DVec3::new(1.0, 2.0, 3.0),
        );
        let light = light_of(r#"{"type": "point"}"#).expect("valid");
        assert_eq!(
            light.place(&flat).expect("it stands somewhere").position,
            Vec3::new(1., 2., 3.)
        );
        for kind in [r#"{"type": "directional"}"#, r#"{"type": "spot", "spot": {}}"#] {
            assert_eq!(light_of(kind).expect("valid").place(&flat), None);
        }
    }

    #[test]
    fn cones_must_be_in_order() {
        let light = light_of(r#"{"type": "spot", "spot": {}}"#).expect("valid");
        let outer = std::f32::consts::FRAC_PI_4;
        assert_eq!(light.kind, PunctualKind::Spot { inner: 0.0, outer });
        // In order as written, alike once rounded.
        let rounded = r#"{"type": "spot", "spot": {"innerConeAngle": 0.08968102931976317,
            "outerConeAngle": 0.08968102931976318}}"#;
        let edge = light_of(rounded).expect("valid").kind;
        assert!(matches!(edge, PunctualKind::Spot { inner, outer } if inner == outer));
        let beyond = light_of(r#"{"type": "spot", "spot": {"innerConeAngle": 1}}"#);
        let sharp = PunctualKind::Spot { inner: outer, outer };
        assert_eq!(beyond.map(|light| light.kind), Ok(sharp));
        assert!(light_of(r#"{"type": "spot"}"#).is_err());
        assert!(light_of(r#"{"type": "area"}"#).is_err());
    }
}
