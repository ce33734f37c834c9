//! A camera that sees all of a scene.

use super::Camera;
use crate::math::{Aabb, Vec3, turn_upright};

impl Camera {
    /// A camera that sees all of `bounds`, from the front, a little to the right and above; `yfov`
    /// in radians. An empty box counts as the unit box.
    pub fn framing(bounds: &Aabb, yfov: f32, aspect: f32) -> Self {
        Self::framing_upright(bounds, Vec3::Y, yfov, aspect)
    }

    /// The same where another unit direction is `up`. Front is where +Z comes to if +Y is turned
    /// there by the shortest way: with +Z up it is -Y, as modellers have it.
    pub fn framing_upright(bounds: &Aabb, up: Vec3, yfov: f32, aspect: f32) -> Self {
        const MARGIN: f32 = 1.05;
        let finite = !bounds.is_empty() && bounds.min.is_finite() && bounds.max.is_finite();
        let unit = Aabb { min: Vec3::splat(-0.5), max: Vec3::splat(0.5) };
        let bounds = if finite { *bounds } else { unit };
        let centre = bounds.centre();
        let half = bounds.max * 0.5 - bounds.min * 0.5;
        // A single point has no size to go by, but perhaps a place: away from it by a part of that.
        let least = [half.max_element() * 1e-6, centre.abs().max_element() * 1e-3];
        let least = least.into_iter().find(|&least| least > 0.0).unwrap_or(1.0);
        let half = half.max(Vec3::splat(least));

        let sky = up;
        let back = turn_upright(sky) * Vec3::new(0.45, 0.35, 1.0).normalize();
        let right = sky.cross(back).normalize();
        let up = back.cross(right);
        let tan_y = libm::tanf(0.5 * yfov);
        let tan_x = tan_y * aspect;
        // A corner at (x, y, z) of the camera's axes is on the film from distance z + |x| / tan on.
        let mut distance = 0.0_f32;
        for corner in 0..8 {
            let sign = |axis: u32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
            let corner = half * Vec3::new(sign(0), sign(1), sign(2));
            let across = (corner.dot(right).abs() / tan_x).max(corner.dot(up).abs() / tan_y);
            distance = distance.max(corner.dot(back) + across * MARGIN);
        }
        Self::look_at(centre + back * distance, centre, sky, yfov)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn framed_boxes_fill_the_film_and_stay_on_it() {
        for (size, aspect) in [
            (Vec3::ONE, 1.0),
            (Vec3::new(9.0, 0.1, 2.0), 1.8),
            (Vec3::new(0.0, 5.0, 0.0), 0.5),
            (Vec3::splat(1e-4), 1.0),
            (Vec3::new(1e-12, 2e-12, 1e-13), 1.0),
            (Vec3::new(1e-30, 0.0, 0.0), 1.0),
            (Vec3::splat(1e6), 2.0),
        ] {
            let corner = Vec3::new(10.0, -3.0, 7.0) * size.max_element();
            let bounds = Aabb { min: corner, max: corner + size };
            let camera = Camera::framing(&bounds, 0.8, aspect);
            let (tan_y, mut fullest) = (libm::tanf(0.4), 0.0_f32);
            for i in 0..8 {
                let pick = |axis: usize| if i >> axis & 1 == 0 { bounds.min } else { bounds.max };
                let p = Vec3::new(pick(0).x, pick(1).y, pick(2).z);
                let local = camera.to_world.inverse().transform_point3(p);
                assert!(local.z < 0.0);
                let film = (local.y / -local.z / tan_y).abs();
                fullest = fullest.max(film).max((local.x / -local.z / tan_y / aspect).abs());
            }
            assert!(fullest < 1.0 && fullest > 0.85, "{size} {fullest}");
        }
        let empty = Camera::framing(&Aabb::EMPTY, 0.8, 1.0);
        assert!(empty.to_world.translation.is_finite());
        for place in [Vec3::ZERO, Vec3::splat(1e-20), Vec3::new(3e7, 0.0, 1.0)] {
            let eye = Camera::framing(&Aabb { min: place, max: place }, 0.8, 1.0).to_world;
            assert!(Vec3::from(eye.translation) != place && eye.is_finite(), "{place}");
        }
    }
}
