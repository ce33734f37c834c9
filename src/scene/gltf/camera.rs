//! Cameras (glTF 2.0, 3.10).

use super::json::{Fault, Object};
use super::notices::Notices;

/// A camera without its place.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDeclaration {
    /// What the file calls it.
    pub name: String,
    /// Width over height that the file asks for.
    pub aspect: Option<f32>,
    /// What it sees.
    pub lens: Lens,
}

/// How a camera sees. Near and far planes are not looked at: there is no depth buffer to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Angle between top and bottom, radians.
    Perspective {
        /// The angle.
        yfov: f32,
    },
    /// Half the width and half the height of what is seen, metres.
    Orthographic {
        /// Half the width.
        xmag: f32,
        /// Half the height.
        ymag: f32,
    },
}

/// Reads all cameras.
pub fn read(root: &Object, notices: &mut Notices) -> Result<Vec<CameraDeclaration>, Fault> {
    root.objects("cameras")?.iter().map(|object| camera(object, notices)).collect()
}

fn camera(object: &Object, notices: &mut Notices) -> Result<CameraDeclaration, Fault> {
    let kind = object.text("type")?.ok_or_else(|| object.absent("type"))?;
    let perspective = object.object("perspective")?;
    let orthographic = object.object("orthographic")?;
    if perspective.is_some() && orthographic.is_some() {
        notices.add(object.place(), "has two projections; the one that its type names is used");
    }
    let (lens, aspect) = match (kind, perspective, orthographic) {
        ("perspective", Some(lens), _) => (self::perspective(&lens)?, aspect(&lens)?),
        ("orthographic", _, Some(lens)) => {
            let lens = self::orthographic(&lens, notices)?;
            let Lens::Orthographic { xmag, ymag } = lens else { unreachable!("as made above") };
            (lens, Some(xmag / ymag))
        }
        ("perspective" | "orthographic", _, _) => return Err(object.absent(kind)),
        _ => {
            let message = format!("{kind:?} is neither perspective nor orthographic");
            return Err(object.fault_at("type", message));
        }
    };
    Ok(CameraDeclaration { name: object.name()?, aspect, lens })
}

fn perspective(lens: &Object) -> Result<Lens, Fault> {
    let yfov = lens.required_number("yfov")?;
    lens.required_number("znear")?;
    if !(yfov > 0.0 && yfov < std::f32::consts::PI) {
        return Err(lens.fault_at("yfov", format!("{yfov} is not between 0 and pi")));
    }
    Ok(Lens::Perspective { yfov })
}

fn aspect(lens: &Object) -> Result<Option<f32>, Fault> {
    match lens.number("aspectRatio")? {
        Some(aspect) if aspect <= 0.0 => Err(lens.fault_at("aspectRatio", "must be above 0")),
        aspect => Ok(aspect),
    }
}

fn orthographic(lens: &Object, notices: &mut Notices) -> Result<Lens, Fault> {
    lens.required_number("znear")?;
    lens.required_number("zfar")?;
    let mut size = |key| {
        let size = lens.required_number(key)?;
        if size == 0.0 {
            return Err(lens.fault_at(key, "must not be 0"));
        }
        if size < 0.0 {
            notices.add(lens.at(key), "is negative; its magnitude is used");
        }
        Ok(size.abs())
    };
    Ok(Lens::Orthographic { xmag: size("xmag")?, ymag: size("ymag")? })
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;

    fn camera_of(text: &str) -> Result<CameraDeclaration, Fault> {
        let value =
            json::parse(format!("{{\"cameras\": [{text}]}}").as_bytes()).expect("valid JSON");
        let root = Object::new(&value, String::new()).expect("an object");
        read(&root, &mut Notices::default()).map(|mut all| all.remove(0))
    }

    #[test]
    fn both_projections() {
        let camera = camera_of(
            r#"{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 1}, "name": "a"}"#,
        );
        let lens = Lens::Perspective { yfov: 0.5 };
        let name = "a".to_owned();
        assert_eq!(camera, Ok(CameraDeclaration { name, aspect: None, lens }));

        let camera = camera_of(
            r#"{"type": "orthographic",
                "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 1}}"#,
        );
        assert_eq!(camera.expect("valid").aspect, Some(1.5));
    }

    #[test]
    fn cameras_that_see_nothing_are_refused() {
        for text in [
            r#"{"type": "perspective", "perspective": {"yfov": 3.2, "znear": 1}}"#,
            r#"{"type": "perspective", "perspective": {"yfov": 0, "znear": 1}}"#,
            r#"{"type": "orthographic",
                "orthographic": {"xmag": 0, "ymag": 2, "znear": 0, "zfar": 1}}"#,
            r#"{"type": "perspective"}"#,
            r#"{"type": "fisheye", "perspective": {"yfov": 1, "znear": 1}}"#,
        ] {
            assert!(camera_of(text).is_err(), "{text}");
        }
    }
}
