//! Camera rays in lanes.

use super::{CameraRays, Projection};
use crate::math::{Affine3A, Vec3};
use crate::sampling::warp;
use crate::simd::lanes::{Lanes, Vec3f};

impl CameraRays {
    /// Whether [`CameraRays::ray_in_lanes`] can make its rays.
    #[inline(always)]
    pub fn has_lanes(&self) -> bool {
        self.camera.projection != Projection::Panorama && self.motion.is_none()
    }

    /// Origins and directions of the rays of [`CameraRays::ray`], in lanes; of no panorama.
    #[inline(always)]
    pub fn ray_in_lanes<L: Lanes>(
        &self,
        lanes: L,
        film: [L::Float; 2],
        lens: [L::Float; 2],
    ) -> (Vec3f<L>, Vec3f<L>) {
        let zero = lanes.float(0.0);
        let x = (film[0] * 2.0 - 1.0) * self.half.x;
        let y = (lanes.float(1.0) - film[1] * 2.0) * self.half.y;
        let (mut origin, mut direction) = match self.camera.projection {
            Projection::Orthographic { .. } => {
                (Vec3f::<L>::new(x, y, zero), Vec3f::<L>::new(zero, zero, lanes.float(-1.0)))
            }
            _ => (Vec3f::splat(zero), Vec3f::<L>::new(x, y, lanes.float(-1.0))),
        };
        if let Some(thin) = self.camera.lens {
            let focus = origin + direction.scale(lanes.float(thin.focus_distance));
            let [x, y] = warp::disk_in_lanes(lanes, lens);
            let aside = Vec3f::<L>::new(x * thin.aperture_radius, y * thin.aperture_radius, zero);
            origin = origin + aside;
            direction = focus - origin;
        }
        let to_world = &self.camera.to_world;
        let turn = turn_in_lanes(lanes, to_world, origin);
        let eye = Vec3::from(to_world.translation);
        let origin = Vec3f { x: turn.x + eye.x, y: turn.y + eye.y, z: turn.z + eye.z };
        (origin, turn_in_lanes(lanes, to_world, direction).normalize(lanes))
    }
}

/// Vectors turned as a transform turns them.
#[inline(always)]
fn turn_in_lanes<L: Lanes>(lanes: L, to_world: &Affine3A, v: Vec3f<L>) -> Vec3f<L> {
    let axes = &to_world.matrix3;
    let [x, y, z] = [axes.x_axis, axes.y_axis, axes.z_axis];
    Vec3f::of_vector(lanes, x.into()).scale(v.x)
        + Vec3f::of_vector(lanes, y.into()).scale(v.y)
        + Vec3f::of_vector(lanes, z.into()).scale(v.z)
}
