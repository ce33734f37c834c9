//! Surfaces in lanes.

use super::super::World;
use super::super::interpolation::Interpolation;
use super::super::surface::GAMMA_7;
use crate::accel::ClosestHit;
use crate::material::lanes::{BSDF_ROWS, BsdfRows};
use crate::math::InstanceId;
use crate::simd::lanes::{Float, FrameLanes, Lanes, Mask, Rows, SIGN, Uint, Vec3f};

/// What the surfaces that rays have met are computed from, a row or more a lane.
#[derive(Default)]
pub struct SurfaceRows {
    /// Distance and barycentrics.
    hit: Rows,
    /// The triangle's corners in the world.
    corners: [Rows; 3],
    /// The interpolated normal, of any length; zero where the mesh has none.
    normal: Rows,
    /// The BSDF, see [`crate::material::lanes::BsdfLanes::load`].
    pub bsdf: [Rows; BSDF_ROWS],
}

/// A point of a surface in each lane; see [`super::super::Surface`].
#[derive(Clone, Copy)]
pub struct SurfaceLanes<L: Lanes> {
    /// Where it is, world space.
    pub position: Vec3f<L>,
    /// Componentwise bound of the position's error.
    pub position_error: Vec3f<L>,
    /// Unit geometric normal.
    pub normal: Vec3f<L>,
    /// The shading frame.
    pub frame: FrameLanes<L>,
    /// Whether the ray arrived at the side that the geometric normal points to.
    pub front: L::Mask,
    /// Distance along the ray.
    pub t: L::Float,
    /// Where all of this holds: not for triangles so small or large that their normal needs f64.
    pub valid: L::Mask,
}

impl SurfaceRows {
    /// Fetches what lane number `lane` has hit at a time, a triangle of an instance; `rows`
    /// describe its BSDF.
    #[inline(always)]
    pub fn fetch(
        &mut self,
        lane: usize,
        world: &World,
        (id, index): (InstanceId, usize),
        (hit, time): (&ClosestHit, f32),
        count: usize,
    ) {
        let instance = &world.scene.instances[id.index()];
        let posed = world.scene.mesh_at(instance.mesh, time);
        let (mesh, transform) = (posed.mesh, &world.scene.transform_at(id, time));
        let point = Interpolation::new(mesh, index, transform.mirrored(), hit.u, hit.v);
        for (rows, corner) in self.corners.iter_mut().zip(point.corners) {
            let p = transform.point(posed.position(corner));
            rows[lane] = [p.x, p.y, p.z, 0.0];
        }
        self.normal[lane] = if posed.has_normals() {
            let n = transform.normal(point.vec3(|i| posed.normal(i)));
            [n.x, n.y, n.z, 0.0]
        } else {
            [0.0; 4]
        };
        self.hit[lane] = [hit.t, hit.u, hit.v, 0.0];
        let described: &BsdfRows;
        let computed;
        match &world.materials[instance.material.index()].rows {
            Some(rows) if mesh.colors.is_empty() => described = rows,
            _ => {
                computed = world.bsdf_rows(instance.material, mesh, &point);
                described = &computed;
            }
        }
        for (rows, row) in self.bsdf.iter_mut().zip(described).take(count) {
            rows[lane] = *row;
        }
    }
}

impl<L: Lanes> SurfaceLanes<L> {
    /// The surfaces that rays of unit direction have met.
    #[inline(always)]
    pub fn new(lanes: L, rows: &SurfaceRows, direction: Vec3f<L>, slack: f32) -> Self {
        let (zero, one) = (lanes.float(0.0), lanes.float(1.0));
        let [t, u, v, _] = lanes.columns(&rows.hit);
        let a = Vec3f::<L>::of_columns(lanes.columns(&rows.corners[0]));
        let b = Vec3f::<L>::of_columns(lanes.columns(&rows.corners[1]));
        let c = Vec3f::<L>::of_columns(lanes.columns(&rows.corners[2]));
        let (position, position_error) = triangle_point(lanes, [a, b, c], [u, v], slack);

        let double_area = (b - a).cross(c - a);
        let length2 = double_area.dot(double_area);
        let length = length2.sqrt();
        let normal = double_area.divide(length);
        let smooth = Vec3f::<L>::of_columns(lanes.columns(&rows.normal));
        let inverse = one / smooth.dot(smooth).sqrt();
        let usable = inverse.lt(lanes.float(f32::INFINITY)) & inverse.gt(zero);
        let shading = Vec3f::select(usable, smooth.scale(inverse), normal);
        let shading = Vec3f::select(shading.dot(normal).lt(zero), -shading, shading);
        Self {
            position,
            position_error,
            normal,
            frame: FrameLanes::from_normal(lanes, shading),
            front: normal.dot(-direction).gt(zero),
            t,
            valid: length2.gt(lanes.float(1e-30)) & length2.lt(lanes.float(1e30)),
        }
    }

    /// Where rays in some directions leave from; see [`super::super::Surface::ray_towards`].
    #[inline(always)]
    pub fn offset_origin(&self, lanes: L, direction: Vec3f<L>) -> Vec3f<L> {
        offset_origin(lanes, self.position, self.position_error, self.normal, direction)
    }
}

/// See [`super::super::surface::triangle_point`].
#[inline(always)]
pub fn triangle_point<L: Lanes>(
    lanes: L,
    [a, b, c]: [Vec3f<L>; 3],
    [u, v]: [L::Float; 2],
    slack: f32,
) -> (Vec3f<L>, Vec3f<L>) {
    let (a, b, c) = (a.scale(lanes.float(1.0) - u - v), b.scale(u), c.scale(v));
    let size = a.abs() + b.abs() + c.abs();
    let error = size.map(
        #[inline(always)]
        |x| x * GAMMA_7 + slack,
    );
    (a + b + c, error)
}

/// See [`super::super::surface::offset_origin`].
#[inline(always)]
pub fn offset_origin<L: Lanes>(
    lanes: L,
    point: Vec3f<L>,
    error: Vec3f<L>,
    normal: Vec3f<L>,
    towards: Vec3f<L>,
) -> Vec3f<L> {
    let zero = lanes.float(0.0);
    let distance = normal.abs().dot(error);
    let side = Vec3f::select(towards.dot(normal).lt(zero), -normal, normal);
    let moved = point + side.scale(distance);
    moved.zip(
        side,
        #[inline(always)]
        |value, way| round_outward(lanes, value, way),
    )
}

/// The next number on the side of `way`, which itself is any number of that sign, or zero: then
/// `value` stays.
#[inline(always)]
fn round_outward<L: Lanes>(lanes: L, value: L::Float, way: L::Float) -> L::Float {
    let (bits, sign) = (value.to_bits(), way.to_bits());
    let grows = ((bits ^ sign) >> 31).eq(0);
    let next = bits + grows.select_uint(lanes.uint(1), lanes.uint(u32::MAX));
    let next = (bits << 1).eq(0).select_uint((sign & SIGN) | 1, next);
    (sign << 1).eq(0).select_uint(bits, next).to_float_bits()
}
