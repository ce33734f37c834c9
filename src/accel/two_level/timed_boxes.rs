//! The boxes of what moves, by equal parts of the time that the shutter is open.
//!
//! Over all of the time a blade that turns is as large as the disc of its way: a ray that meets
//! that box would have to look for where the blade is at its time, which takes as long as a walk
//! through a tree. A box for each part of the time tells most such rays that they pass by.

use rayon::prelude::*;

use super::placement::Shape;
use super::spans::Spans;
use crate::geom::{Motions, Placements};
use crate::math::{Aabb, InstanceId, MeshId};

/// The most boxes of a placement.
const MOST: usize = 256;
/// The most of all: 24 bytes each.
const MOST_OF_ALL: usize = 1 << 19;
/// Times of pieces are rounded by less than this.
const ROUNDING: f64 = 1e-9;

/// The boxes of all that moves, by placement and then by time.
pub struct TimedBoxes {
    /// Of each placement the number of its first box, and last how many there are.
    first: Vec<u32>,
    boxes: Vec<Aabb>,
    /// The most that any placement has, 2^n; 1 where none has any.
    parts: usize,
}

impl TimedBoxes {
    /// Those of `moving` placements of meshes that have `shapes`, and structures over `spans`.
    pub fn new(
        placements: &dyn Placements,
        moving: &[InstanceId],
        shapes: &[Option<Shape>],
        spans: &Spans,
    ) -> Self {
        let Some(motions) = placements.motions() else { return Self::of_parts(&[]) };
        let most = (MOST_OF_ALL / moving.len().max(1)).min(MOST);
        let poses: Vec<Vec<Pose>> = (0..shapes.len())
            .into_par_iter()
            .map(|mesh| match &shapes[mesh] {
                Some(shape) => {
                    find_poses(placements, motions, MeshId::from_index(mesh), (shape, spans))
                }
                None => Vec::new(),
            })
            .collect();
        let find = |&placement: &InstanceId| {
            let mesh = placements.mesh(placement).index();
            let shape = shapes[mesh].as_ref().expect("its mesh is kept apart");
            divide(&shape.boxes_over_time(motions, placement, &poses[mesh]), most)
        };
        Self::of_parts(&moving.par_iter().map(find).collect::<Vec<_>>())
    }

    fn of_parts(found: &[Vec<Aabb>]) -> Self {
        let mut first = vec![0];
        first.extend(found.iter().scan(0, |sum, boxes| {
            *sum += boxes.len() as u32;
            Some(*sum)
        }));
        let parts = found.iter().map(Vec::len).max().unwrap_or(0).max(1);
        Self { first, boxes: found.concat(), parts }
    }

    /// Into how many equal parts the time is cut.
    pub fn parts(&self) -> usize {
        self.parts
    }

    /// The part that a time from 0 to 1 lies in.
    #[inline(always)]
    pub fn part(&self, time: f32) -> usize {
        part_of(time, self.parts)
    }

    /// Where in its part a time lies, from 0 to 1.
    #[inline(always)]
    pub fn place(&self, time: f32) -> f32 {
        // Exact, since there are 2^n parts.
        time * self.parts as f32 - self.part(time) as f32
    }

    /// What holds a placement over a part of the time; `ever` holds it over all of it.
    pub fn over<'a>(&'a self, moving: usize, part: usize, ever: &'a Aabb) -> &'a Aabb {
        let middle = (part as f32 + 0.5) / self.parts as f32;
        self.at(moving, middle).unwrap_or(ever)
    }

    /// What holds a placement at a time from 0 to 1, if that is known better than for all times.
    #[inline]
    pub fn at(&self, moving: usize, time: f32) -> Option<&Aabb> {
        let [first, end] = *self.first.get(moving..moving + 2)? else { return None };
        if first == end {
            return None;
        }
        self.boxes.get(first as usize + part_of(time, (end - first) as usize))
    }

    /// Bytes of all.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.first) + size_of_val(&*self.boxes)
    }
}

/// Which of `count` equal parts a time from 0 to 1 lies in: exact, since there are 2^n of them.
#[inline(always)]
pub fn part_of(time: f32, count: usize) -> usize {
    ((time * count as f32) as usize).min(count - 1)
}

/// The first and the last time of a part, of 2^n: what jumps as it ends has not done so yet.
pub fn ends_of_part(part: usize, parts: usize) -> [f32; 2] {
    let [from, to] = [part, part + 1].map(|end| (end as f64 / parts as f64) as f32);
    // There is no part behind the last.
    [from, if part + 1 == parts { to } else { to.next_down() }]
}

/// A part of the time, and what all placements of a mesh have in common over it.
type Pose = ([f64; 2], Shape);

/// The shapes of a mesh over time: one, or one for each of its structures.
fn find_poses(
    placements: &dyn Placements,
    motions: &dyn Motions,
    mesh: MeshId,
    (shape, spans): (&Shape, &Spans),
) -> Vec<Pose> {
    if !motions.is_deforming(mesh) {
        return vec![([0.0, 1.0], *shape)];
    }
    let triangles = placements.mesh_len(mesh) as u32;
    let pose = |structure| {
        let (_, span) = spans.locate(structure);
        let boxes = (0..triangles).map(|triangle| motions.own_box_over(mesh, triangle, span));
        let bounds = boxes.fold(Aabb::EMPTY, Aabb::union);
        (span.map(f64::from), Shape::of_box(&bounds))
    };
    spans.of_mesh(mesh).map(pose).collect()
}

/// The boxes of 2^n equal parts of the time, no more than `most`, by those of pieces of it; none if
/// one part is all.
fn divide(pieces: &[([f64; 2], Aabb)], most: usize) -> Vec<Aabb> {
    let enough = pieces.len().next_power_of_two();
    let count = if enough <= most { enough } else { (most + 1).next_power_of_two() / 2 };
    if count < 2 {
        return Vec::new();
    }
    let part_of = |time: f64| ((time * count as f64) as usize).min(count - 1);
    let mut boxes = vec![Aabb::EMPTY; count];
    for ([from, to], held) in pieces {
        for part in &mut boxes[part_of(from - ROUNDING)..=part_of(to + ROUNDING)] {
            *part = part.union(*held);
        }
    }
    boxes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    #[test]
    fn a_part_of_the_time_holds_all_pieces_that_reach_into_it() {
        let at = |x: f32| Aabb { min: Vec3::splat(x), max: Vec3::splat(x + 1.0) };
        let pieces = [([0.0, 0.4], at(0.0)), ([0.4, 0.5], at(5.0)), ([0.5, 1.0], at(9.0))];
        let boxes = divide(&pieces, 256);
        let lowest: Vec<f32> = boxes.iter().map(|held| held.min.x).collect();
        let highest: Vec<f32> = boxes.iter().map(|held| held.max.x).collect();
        assert_eq!(lowest, [0.0, 0.0, 5.0, 9.0]);
        assert_eq!(highest, [1.0, 10.0, 10.0, 10.0]);
        assert_eq!(divide(&pieces, 3).len(), 2);
        assert!(divide(&pieces, 1).is_empty() && divide(&pieces[..1], 256).is_empty());
        let timed = TimedBoxes::of_parts(&[Vec::new(), boxes]);
        assert_eq!((timed.parts(), timed.part(0.49), timed.part(1.0)), (4, 1, 3));
        assert_eq!(timed.over(1, 2, &at(-7.0)).min.x, 5.0);
        assert_eq!(timed.over(0, 2, &at(-7.0)).min.x, -7.0);
        assert_eq!(timed.at(0, 0.5), None);
        assert_eq!(timed.at(1, 0.2).map(|held| held.max.x), Some(1.0));
        assert_eq!(timed.at(1, 1.0).map(|held| held.min.x), Some(9.0));
        assert_eq!(timed.at(2, 0.0), None);
    }
}
