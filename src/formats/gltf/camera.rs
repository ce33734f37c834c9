//! Cameras (glTF 2.0, 3.10).

use glam::DAffine3;

use super::json::{Fault, Object};
use super::notices::Notices;
use super::planes::Planes;
use crate::camera::{Camera, Projection};
use crate::scene::{ClipPlanes, NamedCamera, placement};

/// A camera without its place.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDeclaration {
    /// What the file calls it.
    pub name: String,
    /// Width over height that the file asks for.
    pub aspect: Option<f32>,
    /// What it sees.
    pub projection: Projection,
    /// Where its sight is to begin and end. Nothing is cut there, as there is no depth buffer to
    /// fit; see [`Planes::note`].
    pub planes: Planes,
}

impl CameraDeclaration {
    /// The camera at a node called `node`; none if the node's transform has no directions.
    pub fn place(&self, to_world: &DAffine3, node: &str) -> Option<NamedCamera> {
        let to_world = placement::narrow(&placement::rigid(to_world)?);
        let name = if self.name.is_empty() { node } else { &self.name };
        let Planes { near, far, .. } = self.planes;
        Some(NamedCamera {
            name: name.to_owned(),
            aspect: self.aspect,
            camera: Camera { projection: self.projection, to_world, lens: None },
            planes: Some(ClipPlanes { near, far }),
        })
    }
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
    let (projection, aspect, planes) = match (kind, perspective, orthographic) {
        ("perspective", Some(lens), _) => {
            (self::perspective(&lens)?, aspect(&lens)?, planes(&lens)?)
        }
        ("orthographic", _, Some(lens)) => {
            lens.required_number("zfar")?;
            let [xmag, ymag] = self::magnitudes(&lens, notices)?;
            (Projection::Orthographic { xmag, ymag }, Some(xmag / ymag), planes(&lens)?)
        }
        ("perspective" | "orthographic", _, _) => return Err(object.absent(kind)),
        _ => {
            let message = format!("{kind:?} is neither perspective nor orthographic");
            return Err(object.fault_at("type", message));
        }
    };
    let aspect = aspect.filter(|aspect: &f32| aspect.is_normal());
    Ok(CameraDeclaration { name: object.name()?, aspect, projection, planes })
}

fn planes(lens: &Object) -> Result<Planes, Fault> {
    let near = lens.required_number("znear")?;
    Ok(Planes { place: lens.place().to_owned(), near, far: lens.number("zfar")? })
}

fn perspective(lens: &Object) -> Result<Projection, Fault> {
    let yfov = lens.required_number("yfov")?;
    if lens.required_number("znear")? <= 0.0 {
        return Err(lens.fault_at("znear", "must be above 0"));
    }
    if !(yfov > 0.0 && yfov < std::f32::consts::PI) {
        return Err(lens.fault_at("yfov", format!("{yfov} is not between 0 and pi")));
    }
    Ok(Projection::Perspective { yfov })
}

fn aspect(lens: &Object) -> Result<Option<f32>, Fault> {
    match lens.number("aspectRatio")? {
        Some(aspect) if aspect <= 0.0 => Err(lens.fault_at("aspectRatio", "must be above 0")),
        aspect => Ok(aspect),
    }
}

fn magnitudes(lens: &Object, notices: &mut Notices) -> Result<[f32; 2], Fault> {
    let mut size = |key| {
        let size = lens.required_number(key)?;
        if size.abs() < f32::MIN_POSITIVE {
            return Err(lens.fault_at(key, "must not be 0"));
        }
        if size < 0.0 {
            notices.add(lens.at(key), "is negative; its magnitude is used");
        }
        Ok(size.abs())
    };
    Ok([size("xmag")?, size("ymag")?])
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
        let projection = Projection::Perspective { yfov: 0.5 };
        let name = "a".to_owned();
        let place = "/cameras/0/perspective".to_owned();
        let planes = Planes { place, near: 1.0, far: None };
        assert_eq!(camera, Ok(CameraDeclaration { name, aspect: None, projection, planes }));

        let camera = camera_of(
            r#"{"type": "orthographic",
                "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 1}}"#,
        );
        assert_eq!(camera.expect("valid").aspect, Some(1.5));
    }

    #[test]
    fn a_nameless_camera_takes_the_name_of_its_node() {
        let camera =
            camera_of(r#"{"type": "perspective", "perspective": {"yfov": 0.5, "znear": 1}}"#)
                .expect("valid");
        let at = DAffine3::from_translation(glam::DVec3::X);
        let placed = camera.place(&at, "door").expect("has directions");
        assert_eq!(placed.name, "door");
        assert_eq!(placed.camera.to_world.translation, glam::Vec3A::X);
        assert!(camera.place(&DAffine3::from_scale(glam::DVec3::ZERO), "").is_none());
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
