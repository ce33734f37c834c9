//! A stiff body: placements that move, but keep their places to each other, in one structure.
//!
//! Its space is that of the mesh of one of them, the base. The others' triangles are taken there.
//!
//! # Errors
//! A vertex is not quite where the world has it:
//!
//! - It is rounded in the world, by the numbers of its own placement. Those are the base's times
//!   its place in the body, so that the base's bound holds for all if it is asked for a shape that
//!   reaches as far as the terms of each ([`Shape::reaching`]).
//! - It is rounded once more in the body's space.
//! - The way there is interpolated ([`super::timed_ways`]).
//!
//! All that is the slack by which the structure's boxes are grown, as in [`super::placement`]. What
//! passes is asked about by the exact test, with the corners and the transform of its own
//! placement.

use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::division::Apart;
use super::levels::Levels;
use super::placement::{Entered, Shape, ToMesh, magnitudes};
use super::sources::{FlatTriangles, Placed};
use super::timed_boxes::part_of;
use super::timed_ways::{TimedWay, find_ways};
use crate::geom::{Motions, Triangle, TriangleSource, own_box};
use crate::math::{Aabb, Affine3A, InstanceId, PrimId, Ray, TriangleId, Vec3};
use crate::simd::prefetch;

/// The most ways into a body.
const MOST_PARTS: usize = 1024;
/// Fewer ways will do if they are off by so much of the body's size.
const MOST_OFF: f64 = 1.0 / 8192.0;

/// A stiff body.
pub struct Body {
    triangles: BodyTriangles,
    /// Its placements, by their numbers among those that move.
    pub members: Vec<u32>,
    /// The one whose mesh's space it is in.
    pub base: InstanceId,
    /// What its structure takes.
    pub apart: Apart,
    shape: Shape,
    /// Its triangles as the exact test is asked about them.
    own: Vec<OwnTriangle>,
    /// The ways into it, by 2^n equal parts of the time, as far as they are known.
    ways: Vec<Option<TimedWay>>,
}

/// A triangle of a body, in the space of its own mesh.
#[derive(Clone, Copy)]
pub struct OwnTriangle {
    /// Whose it is.
    pub id: TriangleId,
    /// Its corners.
    pub corners: Triangle,
}

/// The triangles of a body in its space.
#[derive(Clone)]
pub struct BodyTriangles {
    placed: Placed,
    flat: FlatTriangles,
    /// Of each placement the way into that space.
    to_body: Arc<[DAffine3]>,
    /// By how much its boxes are grown.
    slack: f32,
}

impl BodyTriangles {
    fn own(&self, prim: PrimId) -> OwnTriangle {
        let (placements, id) = (self.placed.get(), self.flat.locate(prim));
        let corners = placements.mesh_triangle(placements.mesh(id.instance), id.index);
        OwnTriangle { id, corners }
    }
}

impl TriangleSource for BodyTriangles {
    fn len(&self) -> usize {
        self.flat.len()
    }

    fn triangle(&self, prim: PrimId) -> Triangle {
        let to_body = &self.to_body[self.flat.find(prim).0];
        let at = |corner: Vec3| to_body.transform_point3(corner.as_dvec3()).as_vec3();
        let [a, b, c] = self.own(prim).corners.corners().map(at);
        Triangle { a, b, c }
    }

    fn own_box(&self, prim: PrimId) -> Aabb {
        let own = own_box(&self.triangle(prim));
        Aabb { min: own.min - self.slack, max: own.max + self.slack }
    }

    fn slack(&self) -> f32 {
        self.slack
    }
}

impl Body {
    /// A body of placements by their numbers among those that move, and their places in the space
    /// that they have in common; `None` if it can't be entered by a way that is off by little.
    pub fn new(levels: &Levels, motions: &dyn Motions, group: &[(u32, DAffine3)]) -> Option<Self> {
        let moving = &levels.placements[levels.still..];
        let (members, places): (Vec<u32>, Vec<DAffine3>) = group.iter().copied().unzip();
        let placements = members.iter().map(|&number| moving[number as usize]).collect();
        let flat = FlatTriangles::new(levels.placed.clone(), placements);
        let base = find_base(&places)?;
        let to_base = places[base].inverse();
        let to_body: Arc<[DAffine3]> = places.iter().map(|place| to_base * *place).collect();
        let base = flat.placements()[base];
        let placed = levels.placed.clone();
        let mut triangles = BodyTriangles { placed, flat, to_body, slack: 0.0 };
        let shape = triangles.shape(levels)?;
        let (ways, off) = find_close_ways(motions, base, &shape, levels.timed_boxes.parts())?;
        let off = off + f64::from(f32::EPSILON) * shape.reach().max_element();
        if !triangles.keep_places(levels, motions, (base, off)) {
            return None;
        }
        let apart = Apart::of_body(&shape, off)?;
        triangles.slack = apart.slack;
        let own = |number| triangles.own(PrimId::from_index(number));
        let own = (0..triangles.len()).map(own).collect();
        Some(Self { triangles, members, base, apart, shape, own, ways })
    }

    /// Its triangles in its own space.
    pub fn triangles(&self) -> BodyTriangles {
        self.triangles.clone()
    }

    /// The placements that are in it.
    pub fn placements(&self) -> &[InstanceId] {
        self.triangles.flat.placements()
    }

    /// A triangle as the exact test is asked about it.
    #[inline(always)]
    pub fn own(&self, prim: PrimId) -> &OwnTriangle {
        &self.own[prim.index()]
    }

    /// Takes a ray at a time into its space, if the way is known.
    #[inline(always)]
    pub fn enter(&self, time: f32, ray: &Ray, t_max: f32) -> Option<Entered> {
        let part = part_of(time, self.ways.len());
        // Exact, since there are 2^n parts.
        let place = time * self.ways.len() as f32 - part as f32;
        Some(self.ways[part].as_ref()?.enter(place, &self.apart.grown, ray, t_max))
    }

    /// Prefetches that way.
    #[inline(always)]
    pub fn prefetch(&self, time: f32) {
        prefetch(&self.ways, part_of(time, self.ways.len()), size_of::<Option<TimedWay>>());
    }

    /// The way into it where its base stands at `to_world`, if no vertex is off by more than its
    /// boxes allow for: the base's numbers are rounded, and those of the others.
    pub fn find_way(&self, to_world: &Affine3A) -> Option<ToMesh> {
        let to_mesh = ToMesh::new(to_world);
        (2.0 * to_mesh.error(&self.shape, to_world)? <= self.apart.off).then_some(to_mesh)
    }

    /// What holds it over a part of the time.
    pub fn bounds(&self, levels: &Levels, part: usize) -> Aabb {
        let members = self.members.iter();
        let boxes = members.map(|&member| levels.box_of_moving(member as usize, part));
        boxes.fold(Aabb::EMPTY, Aabb::union)
    }

    /// Bytes of its lists.
    pub fn bytes(&self) -> usize {
        let of_member = size_of::<u32>() + size_of::<InstanceId>() + size_of::<DAffine3>();
        let triangles = size_of_val(&*self.own);
        self.members.len() * of_member + size_of_val(&*self.ways) + triangles
    }
}

impl BodyTriangles {
    /// What the body takes up, and how far its members' terms reach; `None` if that is not finite.
    fn shape(&self, levels: &Levels) -> Option<Shape> {
        let prims = (0..self.len()).map(PrimId::from_index);
        let bounds = Aabb::of_points(prims.flat_map(|prim| self.triangle(prim).corners()));
        let mut reach = DVec3::ZERO;
        for (placement, to_body) in self.flat.placements().iter().zip(&*self.to_body) {
            let mesh = self.placed.get().mesh(*placement).index();
            let of_mesh = levels.shapes[mesh].as_ref()?.reach();
            let terms = magnitudes(&to_body.matrix3) * of_mesh + to_body.translation.abs();
            if !terms.is_finite() {
                return None;
            }
            reach = reach.max(terms);
        }
        let is_finite = bounds.min.is_finite() && bounds.max.is_finite();
        is_finite.then(|| Shape::of_box(&bounds).reaching(reach))
    }

    /// Whether the members' transforms are the base's times their places, to `off`, as the
    /// shutter opens, midway and as it closes. Where numbers cancel that are far larger than the
    /// body, they may not be.
    fn keep_places(
        &self,
        levels: &Levels,
        motions: &dyn Motions,
        (base, off): (InstanceId, f64),
    ) -> bool {
        [0.0, 0.5, 1.0].into_iter().all(|time| {
            let to_base = ToMesh::new(&motions.to_world_at(base, time)).to_affine();
            let mut members = self.flat.placements().iter().zip(&*self.to_body);
            members.all(|(&member, place)| {
                let to_world = motions.to_world_at(member, time);
                let found = to_base * widen(&to_world);
                let mesh = self.placed.get().mesh(member).index();
                let reach = levels.shapes[mesh].as_ref().map_or(DVec3::INFINITY, Shape::reach);
                let difference = magnitudes(&(found.matrix3 - place.matrix3)) * reach;
                let moved = (found.translation - place.translation).abs();
                (difference + moved).max_element() <= off
            })
        })
    }
}

fn widen(to_world: &Affine3A) -> DAffine3 {
    let (matrix3, translation) = (to_world.matrix3, to_world.translation);
    DAffine3 { matrix3: matrix3.as_dmat3(), translation: translation.as_dvec3() }
}

/// The member whose space is stretched the least: the one of the least condition number.
fn find_base(places: &[DAffine3]) -> Option<usize> {
    let norm = |matrix: &DMat3| matrix.to_cols_array().map(|x| x * x).iter().sum::<f64>();
    let condition = |place: &DAffine3| norm(&place.matrix3) * norm(&place.matrix3.inverse());
    let conditions = places.iter().map(condition).enumerate();
    let finite = conditions.filter(|(_, condition)| condition.is_finite());
    finite.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(member, _)| member)
}

/// The ways into a placement, by so many parts of the time that they are off by little, at least
/// so many as `parts`; `None` if most are not known.
fn find_close_ways(
    motions: &dyn Motions,
    placement: InstanceId,
    shape: &Shape,
    mut parts: usize,
) -> Option<(Vec<Option<TimedWay>>, f64)> {
    loop {
        let found = find_ways(motions, placement, shape, parts);
        let known = found.as_ref().map_or(0, |(ways, _)| ways.iter().flatten().count());
        let is_close = found.as_ref().is_some_and(|(_, off)| *off <= MOST_OFF * shape.size());
        if is_close && known * 8 >= parts * 7 || 2 * parts > MOST_PARTS {
            return found.filter(|_| 2 * known > parts);
        }
        parts *= 2;
    }
}

#[cfg(test)]
mod tests;
