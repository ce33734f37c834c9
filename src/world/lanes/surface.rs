//! Surfaces in lanes.

use super::super::World;
use super::super::interpolation::Interpolation;
use super::super::robust::LEAST_VIEW_COSINE;
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
    /// Whether shading normals lose no light.
    pub robust: bool,
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
                computed = world.bsdf_rows(instance, mesh, &point);
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
    pub fn new(lanes: L, world: &World, rows: &SurfaceRows, direction: Vec3f<L>) -> Self {
        let (zero, one) = (lanes.float(0.0), lanes.float(1.0));
        let [t, u, v, _] = lanes.columns(&rows.hit);
        let a = Vec3f::<L>::of_columns(lanes.columns(&rows.corners[0]));
        let b = Vec3f::<L>::of_columns(lanes.columns(&rows.corners[1]));
        let c = Vec3f::<L>::of_columns(lanes.columns(&rows.corners[2]));
        let (position, position_error) = triangle_point(lanes, [a, b, c], [u, v], world.slack);

        let double_area = (b - a).cross(c - a);
        let length2 = double_area.dot(double_area);
        let length = length2.sqrt();
        let normal = double_area.divide(length);
        let smooth = Vec3f::<L>::of_columns(lanes.columns(&rows.normal));
        let inverse = one / smooth.dot(smooth).sqrt();
        let usable = inverse.lt(lanes.float(f32::INFINITY)) & inverse.gt(zero);
        let shading = Vec3f::select(usable, smooth.scale(inverse), normal);
        let shading = Vec3f::select(shading.dot(normal).lt(zero), -shading, shading);
        let front = normal.dot(-direction).gt(zero);
        let shading = if world.robust {
            bent_to_viewer(lanes, shading, normal, -direction, front)
        } else {
            shading
        };
        Self {
            position,
            position_error,
            normal,
            frame: FrameLanes::from_normal(lanes, shading),
            front,
            t,
            robust: world.robust,
            valid: length2.gt(lanes.float(1e-30)) & length2.lt(lanes.float(1e30)),
        }
    }

    /// Where rays in some directions leave from; see [`super::super::Surface::ray_towards`].
    #[inline(always)]
    pub fn offset_origin(&self, lanes: L, direction: Vec3f<L>) -> Vec3f<L> {
        offset_origin(lanes, self.position, self.position_error, self.normal, direction)
    }

    /// The geometric normals on the viewers' sides.
    #[inline(always)]
    pub fn facing(&self) -> Vec3f<L> {
        Vec3f::select(self.front, self.normal, -self.normal)
    }

    /// The normals of the half-spaces that opaque surfaces take light from.
    #[inline(always)]
    pub fn light_side(&self) -> Vec3f<L> {
        let normal = if self.robust { self.frame.normal } else { self.normal };
        Vec3f::select(self.front, normal, -normal)
    }

    /// See [`super::super::Surface::origin_beyond`].
    #[inline(always)]
    pub fn origin_beyond(&self, lanes: L, side: Vec3f<L>, bulge: L::Float) -> Vec3f<L> {
        let moved = self.position + side.scale(bulge);
        let size = moved.abs().scale(lanes.float(GAMMA_7));
        offset_origin(lanes, moved, self.position_error + size, self.normal, side)
    }
}

/// See [`super::super::robust::bent_to_viewer`].
#[inline(always)]
fn bent_to_viewer<L: Lanes>(
    lanes: L,
    shading: Vec3f<L>,
    geometric: Vec3f<L>,
    viewer: Vec3f<L>,
    front: L::Mask,
) -> Vec3f<L> {
    let (zero, one) = (lanes.float(0.0), lanes.float(1.0));
    let side = front.select(one, -one);
    let (along, upright) = (shading.dot(viewer) * side, geometric.dot(viewer) * side);
    let turned = along.lt(upright.least(lanes.float(LEAST_VIEW_COSINE)));
    if turned.to_bits() == 0 {
        return shading;
    }
    let shown = upright.least(lanes.float(2.0 * LEAST_VIEW_COSINE) - along);
    let bent = shading + viewer.scale((shown - along) * side);
    let inverse = one / bent.dot(bent).sqrt();
    let usable = inverse.lt(lanes.float(f32::INFINITY)) & inverse.gt(zero);
    let bent = Vec3f::select(usable, bent.scale(inverse), geometric);
    Vec3f::select(turned, bent, shading)
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
