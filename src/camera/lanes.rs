//! Camera rays in lanes.

use super::{CameraRays, Projection};
use crate::math::Affine3A;
use crate::sampling::warp;
use crate::simd::lanes::{Lanes, MAX_LANES, Rows, Vec3f};

/// Where the camera stands: the columns of its way to the world, and its place there.
#[derive(Clone, Copy)]
pub struct Stand<L: Lanes> {
    axes: [Vec3f<L>; 3],
    eye: Vec3f<L>,
}

impl<L: Lanes> Stand<L> {
    /// The same in all lanes.
    #[inline(always)]
    fn still(lanes: L, to_world: &Affine3A) -> Self {
        let axes = &to_world.matrix3;
        let axes = [axes.x_axis, axes.y_axis, axes.z_axis].map(
            #[inline(always)]
            |axis| Vec3f::of_vector(lanes, axis.into()),
        );
        Self { axes, eye: Vec3f::of_vector(lanes, to_world.translation.into()) }
    }

    /// Vectors turned as the camera is.
    #[inline(always)]
    fn turn(&self, v: Vec3f<L>) -> Vec3f<L> {
        let [x, y, z] = self.axes;
        x.scale(v.x) + y.scale(v.y) + z.scale(v.z)
    }
}

impl CameraRays {
    /// Whether [`CameraRays::ray_in_lanes`] can make its rays.
    #[inline(always)]
    pub fn has_lanes(&self) -> bool {
        self.camera.projection != Projection::Panorama
    }

    /// Where the camera stands at the `times` of the first `count` lanes; where its node has no
    /// directions at a time, there is no number.
    #[inline(always)]
    pub fn stand<L: Lanes>(&self, lanes: L, times: &[f32; MAX_LANES], count: usize) -> Stand<L> {
        let Some(motion) = &self.motion else { return Stand::still(lanes, &self.camera.to_world) };
        let mut columns = [Rows::default(); 4];
        for (lane, &time) in times[..count].iter().enumerate() {
            let to_world = motion.rigid_at(time).map(|it| it.to_cols_array().map(|x| x as f32));
            let (vectors, _) = to_world.as_ref().unwrap_or(&[f32::NAN; 12]).as_chunks::<3>();
            for (rows, [x, y, z]) in columns.iter_mut().zip(vectors) {
                rows[lane] = [*x, *y, *z, 0.0];
            }
        }
        let [x, y, z, eye] = columns.map(
            #[inline(always)]
            |rows| {
                let [x, y, z, _] = lanes.columns(&rows);
                Vec3f { x, y, z }
            },
        );
        Stand { axes: [x, y, z], eye }
    }

    /// Origins and directions of the rays of [`CameraRays::ray_at`], in lanes; of no panorama.
    #[inline(always)]
    pub fn ray_in_lanes<L: Lanes>(
        &self,
        lanes: L,
        stand: &Stand<L>,
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
        (stand.turn(origin) + stand.eye, stand.turn(direction).normalize(lanes))
    }
}
