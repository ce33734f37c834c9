//! A mesh where it is placed: what holds it, and a ray in its space.
//!
//! # Errors
//! The verdict is about vertices in the world, `M p + t` rounded, and about the ray as it is. Both
//! are taken into the mesh's space by the inverse of `M` in f64; what is left of the error is
//! bounded by one number a mesh, the slack, by which its structure's boxes are grown:
//!
//! - A vertex in the world is off by the last rounding, of the sum, and a few of `M p` before it;
//!   its place in the mesh's space is off by `|M^-1|` times that. Where this is more than a small
//!   part of the mesh, the placement is not kept apart ([`error_inside`]).
//! - A ray begins where it enters the mesh's box, computed in f64, however far it has come. So its
//!   rounded origin and direction are off by `2^-24` of the box's coordinates and size, and not of
//!   the way to it. Where the way is longer than 2^24 boxes even f64 is too coarse: such a ray is
//!   held against all triangles of the mesh.
//!
//! So the line that the verdict accepts meets the grown box of its triangle, and all around it, in
//! the mesh's space as well. Along the line, `t` is the same in both spaces but for where it begins
//! to count. What the verdict computes is off by a few of its own roundings, `2^-20 t` at most with
//! room to spare, and by that much the limit is raised behind which boxes do not matter.

use glam::{DAffine3, DMat3, DVec3};

use crate::geom::{Motions, Placements};
use crate::math::{Aabb, Affine3A, InstanceId, MeshId, Ray};
use crate::motion::Piece;

/// 2^-20: bounds the relative errors of hits' distances, and with room to spare those of vertices
/// and boxes.
const ROUNDING: f64 = 1.0 / 1_048_576.0;
/// 2^-24, of f32: what a rounding takes.
const HALF_ULP: f64 = 1.0 / 16_777_216.0;
/// 2^-90, the least by which boxes are grown.
const TINY: f64 = 1.0 / (1_u128 << 90) as f64;
/// 2^24: a ray from further away, in sizes of the box, can't be placed.
const FARTHEST: f64 = 16_777_216.0;
/// The largest slack of a mesh that is kept apart, in its sizes.
const MOST_SLACK: f64 = 1.0 / 32.0;

/// What all placements of a mesh have in common.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    centre: DVec3,
    /// Half the box's size.
    half: DVec3,
    /// Radius around the centre.
    radius: f64,
    /// Largest magnitude of the coordinates along each axis.
    reach: DVec3,
}

impl Shape {
    /// The box and the radius of a mesh; `None` without triangles.
    pub fn new(placements: &dyn Placements, mesh: MeshId) -> Option<Self> {
        if let Some(motions) = placements.motions().filter(|it| it.is_deforming(mesh)) {
            let bounds = motions.mesh_bounds_over_time(mesh);
            return (!bounds.is_empty()).then(|| Self::of_box(&bounds));
        }
        let bounds = placements.mesh_bounds(mesh);
        if bounds.is_empty() {
            return None;
        }
        let boxed = Self::of_box(&bounds);
        let centre = boxed.centre;
        let triangles = placements.mesh_len(mesh) as u32;
        let farthest = (0..triangles)
            .flat_map(|index| placements.mesh_triangle(mesh, index).corners())
            .map(|corner| corner.as_dvec3().distance_squared(centre))
            .fold(0.0, f64::max);
        Some(Self { radius: farthest.sqrt() * (1.0 + ROUNDING), ..boxed })
    }

    /// Of all that a box holds.
    pub fn of_box(bounds: &Aabb) -> Self {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let (centre, half) = ((min + max) * 0.5, (max - min) * 0.5);
        let radius = half.length() * (1.0 + ROUNDING);
        Self { centre, half, radius, reach: min.abs().max(max.abs()) }
    }

    /// Pieces of the time in which a moving placement goes no further than is worth cutting it.
    pub fn pieces(&self, motions: &dyn Motions, placement: InstanceId) -> Vec<Piece> {
        let start = world_box(self, &motions.to_world_at(placement, 0.0));
        let margin = f64::from(start.extent().max_element()) / 32.0;
        motions.pieces(placement, self.reach.length(), margin)
    }

    /// The boxes in the world of what a moving placement comes to hold, each with from when to when
    /// it does; by the shapes that its mesh has over time. See [`world_box`].
    pub fn boxes_over_time(
        &self,
        motions: &dyn Motions,
        placement: InstanceId,
        poses: &[([f64; 2], Self)],
    ) -> Vec<([f64; 2], Aabb)> {
        let mut boxes = Vec::new();
        for Piece { span: [from, to], middle, margin } in self.pieces(motions, placement) {
            let to_world = motions.to_world_at(placement, middle);
            for ([first, last], shape) in poses {
                let span = [from.max(*first), to.min(*last)];
                if span[0] <= span[1] {
                    boxes.push((span, grow(&world_box(shape, &to_world), margin)));
                }
            }
        }
        boxes
    }

    /// What holds all of these.
    pub fn box_over_time(&self, motions: &dyn Motions, placement: InstanceId) -> Aabb {
        let boxes = self.boxes_over_time(motions, placement, &[([0.0, 1.0], *self)]);
        boxes.into_iter().map(|(_, held)| held).fold(Aabb::EMPTY, Aabb::union)
    }

    /// The largest magnitude of the coordinates along each axis.
    pub fn reach(&self) -> DVec3 {
        self.reach
    }

    /// Bounds by how much vertices and their own boxes are off in the world from where they are by
    /// numbers without end.
    pub fn rounding(&self, to_world: &Affine3A) -> f64 {
        let (matrix, translation) = widen(to_world);
        let terms = magnitudes(&matrix) * self.reach + translation.abs();
        terms.max_element() * ROUNDING + TINY
    }

    /// Bounds how far a transform takes anything in the mesh.
    pub fn farthest(&self, transform: &DAffine3) -> f64 {
        let DAffine3 { matrix3, translation } = *transform;
        (magnitudes(&(matrix3 - DMat3::IDENTITY)) * self.reach + translation.abs()).length()
    }

    /// The same, with terms of vertices that reach as far as `reach` along each axis.
    pub fn reaching(self, reach: DVec3) -> Self {
        Self { reach: self.reach.max(reach), ..self }
    }

    /// The largest side of the box.
    pub fn size(&self) -> f64 {
        2.0 * self.half.max_element()
    }

    /// By how much a structure of the mesh grows its boxes, where placements need `off` of it.
    pub fn slack(&self, off: f32) -> f32 {
        let rounding = 0.5 * ROUNDING * (self.reach.max_element() + 2.0 * self.size());
        (f64::from(off) * (1.0 + ROUNDING) + rounding + TINY) as f32
    }

    /// Whether vertices may be `off` by so much in a structure of the mesh.
    pub fn allows(&self, off: f64) -> bool {
        self.slack(off as f32) <= (MOST_SLACK * self.size()) as f32
    }

    /// The box of what a structure holds that is grown by `slack`, and once more by as much.
    pub fn grown(&self, slack: f32) -> [DVec3; 2] {
        let half = self.half + 2.0 * f64::from(slack);
        [self.centre - half, self.centre + half]
    }
}

/// A box with a margin around it, rounded outwards.
fn grow(held: &Aabb, margin: f64) -> Aabb {
    let (min, max) = (held.min.as_dvec3() - margin, held.max.as_dvec3() + margin);
    let room = |end: DVec3| end.abs() * ROUNDING;
    Aabb { min: (min - room(min)).as_vec3(), max: (max + room(max)).as_vec3() }
}

/// The box in the world of what a placement holds: of the own boxes of its triangles.
pub fn world_box(shape: &Shape, to_world: &Affine3A) -> Aabb {
    let (matrix, translation) = widen(to_world);
    let rows = matrix.transpose();
    let magnitudes = magnitudes(&matrix);
    let centre = matrix * shape.centre + translation;
    let half = magnitudes * shape.half;
    let lengths = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
    let half = half.min(lengths * shape.radius * (1.0 + ROUNDING));
    let terms = magnitudes * shape.reach + translation.abs();
    let grown = half + terms * ROUNDING + TINY;
    Aabb { min: (centre - grown).as_vec3(), max: (centre + grown).as_vec3() }
}

/// How far off the vertices of a placement may be in its mesh's space, or `None` if that is too
/// much for a structure of its own: it is singular, or far from the world's origin for its size.
pub fn error_inside(shape: &Shape, to_world: &Affine3A) -> Option<f32> {
    ToMesh::new(to_world).error(shape, to_world)
}

/// A ray in the space of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct LocalRay {
    /// The ray, from where it enters the mesh's box.
    pub ray: Ray,
    /// The world's `t` there.
    pub shift: f64,
}

/// What becomes of a ray at a placement.
pub enum Entered {
    /// It does not meet the box.
    Missed,
    /// It goes on in the mesh's space.
    Inside(LocalRay),
    /// It can't be placed there.
    Far,
}

/// From the world to a mesh's space.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ToMesh {
    inverse: DMat3,
    translation: DVec3,
}

impl ToMesh {
    /// The way back of a placement that has one.
    #[inline(always)]
    pub fn new(to_world: &Affine3A) -> Self {
        let (matrix, translation) = widen(to_world);
        Self { inverse: matrix.inverse(), translation }
    }

    /// See [`error_inside`], of the placement at `to_world` that this is the way into.
    #[inline]
    pub fn error(&self, shape: &Shape, to_world: &Affine3A) -> Option<f32> {
        if !self.inverse.is_finite() || shape.size() <= 0.0 {
            return None;
        }
        let (matrix, translation) = widen(to_world);
        let turned = magnitudes(&matrix) * shape.reach;
        let sum = turned + translation.abs();
        let rounded = (turned * 4.0 + sum * 1.0625) * HALF_ULP + TINY;
        let off = (magnitudes(&self.inverse) * rounded).max_element();
        shape.allows(off).then_some(off as f32)
    }

    /// Takes a ray into the space of a mesh whose box, grown, is `bounds`; hits beyond `t_max` do
    /// not matter.
    #[inline(always)]
    pub fn enter(&self, bounds: &[DVec3; 2], ray: &Ray, t_max: f32) -> Entered {
        let origin = self.inverse * (ray.origin().as_dvec3() - self.translation);
        enter_box([origin, self.inverse * ray.direction().as_dvec3()], bounds, t_max)
    }

    /// The same as one transform.
    pub fn to_affine(self) -> DAffine3 {
        DAffine3 { matrix3: self.inverse, translation: -(self.inverse * self.translation) }
    }
}

/// See [`ToMesh::enter`], of a ray by its origin and its direction in the mesh's space.
#[inline(always)]
pub fn enter_box([origin, direction]: [DVec3; 2], bounds: &[DVec3; 2], t_max: f32) -> Entered {
    let reciprocal = direction.recip();
    // A ray that runs within a plane of the box may be left out: there is no number then. The
    // box is grown, so that nothing lies in its planes.
    let (low, high) = ((bounds[0] - origin) * reciprocal, (bounds[1] - origin) * reciprocal);
    let near = |axis: usize| low[axis].min(high[axis]);
    let far = |axis: usize| low[axis].max(high[axis]);
    let enter = near(0).max(near(1)).max(near(2)).max(0.0);
    let exit = far(0).min(far(1)).min(far(2));
    let beyond = f64::from(t_max) * (1.0 + ROUNDING);
    if !(enter <= exit && enter <= beyond) {
        return Entered::Missed;
    }
    let from = origin + direction * enter;
    let size = (bounds[1] - bounds[0]).max_element();
    let ray = Ray::new(from.as_vec3(), direction.as_vec3(), 0.0, limit(enter, t_max));
    let is_placed = origin.abs().max_element() <= FARTHEST * size && ray.t_max() >= 0.0;
    if is_placed { Entered::Inside(LocalRay { ray, shift: enter }) } else { Entered::Far }
}

/// What no box beyond matters in the mesh's space, once there is a hit at `t`.
#[inline(always)]
pub fn limit(shift: f64, t: f32) -> f32 {
    let t = f64::from(t);
    ((t - shift + t * ROUNDING) * (1.0 + ROUNDING)) as f32
}

fn widen(to_world: &Affine3A) -> (DMat3, DVec3) {
    (to_world.matrix3.as_dmat3(), to_world.translation.as_dvec3())
}

/// The magnitudes of all entries.
pub fn magnitudes(matrix: &DMat3) -> DMat3 {
    DMat3::from_cols(matrix.x_axis.abs(), matrix.y_axis.abs(), matrix.z_axis.abs())
}
