//! Near and far planes of cameras, which nothing is cut at here. Where they would cut something
//! away that the camera frames, that is said.

use super::notices::Notices;
use crate::camera::Camera;
use crate::math::Vec3;
use crate::scene::Scene;
use crate::scene::frustum::{Side, sides, touches};

/// Where a file says that a camera's sight begins and ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes {
    /// The JSON pointer to the lens.
    pub place: String,
    /// Metres.
    pub near: f32,
    /// Metres; none: no end.
    pub far: Option<f32>,
}

/// What is nearer than a plane by less than this share is not told from what is on it.
const SLACK: f32 = 1e-4;

impl Planes {
    /// Notes what a camera would not see if its planes were honoured. `aspect` is width over height
    /// of its picture.
    pub fn note(&self, camera: &Camera, aspect: f32, scene: &Scene, notices: &mut Notices) {
        let Some(sides) = sides(camera, aspect) else { return };
        let mut say = |key: &str, message: String| {
            notices.add(format!("{}/{key}", self.place), message);
        };
        // Depth counts along -Z.
        let before = Side { normal: Vec3::Z, offset: self.near * (1.0 - SLACK) };
        let ahead = Side { normal: Vec3::NEG_Z, offset: 0.0 };
        let near = [&sides[..], &[before, ahead]].concat();
        if self.near > 0.0 && touches(&near, camera, scene) {
            let near = self.near;
            say("znear", format!("what is nearer than {near} is seen nevertheless"));
        }
        let Some(far) = self.far else { return };
        let beyond = Side { normal: Vec3::NEG_Z, offset: -far * (1.0 + SLACK) };
        if touches(&[&sides[..], &[beyond]].concat(), camera, scene) {
            say("zfar", format!("what is beyond {far} is seen nevertheless"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Projection;
    use crate::geom::Mesh;
    use crate::math::Affine3A;

    /// A triangle across the view, of that size, in that depth before a camera at the origin.
    fn said(depth: f32, at: [f32; 2], size: f32, projection: Projection) -> Vec<String> {
        let [x, y] = at;
        let corner = |a: f32, b: f32| Vec3::new(x + a * size, y + b * size, -depth);
        let mesh = Mesh {
            positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)],
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let scene = Scene::of_mesh(mesh);
        let camera = Camera { projection, to_world: Affine3A::IDENTITY, lens: None };
        let planes = Planes { place: "/cameras/0/lens".to_owned(), near: 1.0, far: Some(10.0) };
        let mut notices = Notices::default();
        planes.note(&camera, 1.0, &scene, &mut notices);
        let all = notices.finish(std::path::Path::new("a"));
        all.into_iter().map(|notice| format!("{} {}", notice.place, notice.message)).collect()
    }

    const LENS: Projection = Projection::Perspective { yfov: std::f32::consts::FRAC_PI_2 };

    #[test]
    fn what_the_planes_would_cut_is_said() {
        let near = ["a: /cameras/0/lens/znear what is nearer than 1 is seen nevertheless"];
        let far = ["a: /cameras/0/lens/zfar what is beyond 10 is seen nevertheless"];
        let box_lens = Projection::Orthographic { xmag: 1.0, ymag: 1.0 };
        for lens in [LENS, box_lens] {
            assert_eq!(said(0.5, [0.0; 2], 0.1, lens), near);
            // None of its corners is in sight.
            assert_eq!(said(0.5, [0.0; 2], 50.0, lens), near);
            assert_eq!(said(20.0, [0.0; 2], 0.1, lens), far);
            assert!(said(5.0, [0.0; 2], 0.1, lens).is_empty());
            assert!(said(-0.5, [0.0; 2], 0.1, lens).is_empty(), "behind the camera");
            assert!(said(0.5, [9.0, 0.0], 0.1, lens).is_empty(), "beside the frame");
        }
        // Its box reaches into the frame, itself it does not.
        assert!(said(0.5, [-1.3, -1.3], 0.9, LENS).is_empty());
    }
}
