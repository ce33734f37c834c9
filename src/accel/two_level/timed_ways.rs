//! The ways into what moves, by equal parts of the time that the shutter is open.
//!
//! Where a placement stands at a ray's time takes long to find, and so does the way back. But only
//! the exact test needs that: to walk a mesh's structure a way will do that is off by a little, if
//! boxes and filters allow for it. Over a small part of the time the way back of a point is about
//! straight, so that the way is taken between those at both ends of the part. How far off it then
//! is, is bounded ([`crate::motion::Motion::bend_back`]), and the mesh's slack made larger by that.

use glam::{DAffine3, DVec3};
use rayon::prelude::*;

use super::division::Apart;
use super::placement::{Entered, Shape, ToMesh, enter_box};
use super::timed_boxes::{TimedBoxes, ends_of_part};
use crate::geom::{Motions, Placements};
use crate::math::{InstanceId, Ray};
use crate::simd::prefetch;

/// The most ways: 13 MB.
const MOST: usize = 1 << 16;

/// A way may be off by so much of the mesh's size.
const MOST_OFF: f64 = 1.0 / 128.0;

/// The ways of what moves.
#[derive(Default)]
pub struct TimedWays {
    /// Of each placement the number of its first way, and last how many there are.
    first: Vec<u32>,
    ways: Vec<Option<TimedWay>>,
}

/// A way over a part of the time.
#[derive(Clone, Copy)]
pub struct TimedWay {
    /// At the beginning.
    from: DAffine3,
    /// From there to the end.
    step: DAffine3,
}

impl TimedWays {
    /// The ways into those of the `moving` placements that are `asked` for, by their numbers in
    /// order, of meshes that have `shapes`. The slack of `meshes` grows by what they are off.
    pub fn new(
        placements: &dyn Placements,
        (moving, asked): (&[InstanceId], &[u32]),
        (shapes, timed_boxes): (&[Option<Shape>], &TimedBoxes),
        meshes: &mut [Option<Apart>],
    ) -> Self {
        let Some(motions) = placements.motions() else { return Self::default() };
        let parts = timed_boxes.parts();
        let mut room = MOST / parts;
        let mut chosen = vec![false; moving.len()];
        for number in asked.iter().map(|&number| number as usize) {
            chosen[number] = room > 0 && !motions.stays(moving[number]);
            room -= usize::from(chosen[number]);
        }
        let find = |(&placement, &chosen): (&InstanceId, &bool)| {
            let mesh = placements.mesh(placement).index();
            let shape = shapes[mesh].as_ref().filter(|_| chosen)?;
            find_ways(motions, placement, shape, parts)
        };
        let found: Vec<_> = moving.par_iter().zip(&chosen).map(find).collect();
        let (mut first, mut all) = (vec![0], Vec::new());
        for (placement, found) in moving.iter().zip(found) {
            if let Some((ways, off)) = found {
                let mesh = placements.mesh(*placement).index();
                if let (Some(apart), Some(shape)) = (&mut meshes[mesh], &shapes[mesh]) {
                    apart.allow(shape, off as f32);
                }
                all.extend(ways);
            }
            first.push(all.len() as u32);
        }
        Self { first, ways: all }
    }

    /// The way into a placement over a part of the time, by its number among those that move.
    #[inline(always)]
    pub fn find(&self, moving: usize, part: usize) -> Option<&TimedWay> {
        let number = *self.first.get(moving)? as usize + part;
        if number >= *self.first.get(moving + 1)? as usize {
            return None;
        }
        self.ways[number].as_ref()
    }

    /// Prefetches it.
    #[inline(always)]
    pub fn prefetch(&self, moving: usize, part: usize) {
        if let Some(&first) = self.first.get(moving) {
            prefetch(&self.ways, first as usize + part, size_of::<TimedWay>());
        }
    }

    /// Bytes of all.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.first) + size_of_val(&*self.ways)
    }
}

impl TimedWay {
    /// As [`ToMesh::enter`], at a `place` in the part from 0 to 1.
    #[inline(always)]
    pub fn enter(&self, place: f32, bounds: &[DVec3; 2], ray: &Ray, t_max: f32) -> Entered {
        let (from, step, place) = (&self.from, &self.step, f64::from(place));
        let matrix = from.matrix3 + step.matrix3 * place;
        let translation = from.translation + step.translation * place;
        let origin = matrix * ray.origin().as_dvec3() + translation;
        enter_box([origin, matrix * ray.direction().as_dvec3()], bounds, t_max)
    }
}

/// The ways into a placement over each of so many `parts` of the time, as far as they are known,
/// and how far off any of them is; `None` without any.
pub fn find_ways(
    motions: &dyn Motions,
    placement: InstanceId,
    shape: &Shape,
    parts: usize,
) -> Option<(Vec<Option<TimedWay>>, f64)> {
    let way = |part| find_way(motions, placement, shape, (part, parts));
    let found: Vec<_> = (0..parts).map(way).collect();
    let (ways, off): (Vec<_>, Vec<_>) = found.into_iter().map(Option::unzip).collect();
    Some((ways, off.into_iter().flatten().reduce(f64::max)?))
}

/// The way into a placement over a part of the time, of so many, and how far off it is; `None` if
/// that is too far or not known.
fn find_way(
    motions: &dyn Motions,
    placement: InstanceId,
    shape: &Shape,
    (part, parts): (usize, usize),
) -> Option<(TimedWay, f64)> {
    let span = [part, part + 1].map(|end| end as f64 / parts as f64);
    let bend = motions.bend_back(placement, shape.reach().length(), span)?;
    let ends = ends_of_part(part, parts).map(|time| {
        let to_world = motions.to_world_at(placement, time);
        let to_mesh = ToMesh::new(&to_world);
        let error = to_mesh.error(shape, &to_world)?;
        Some((to_mesh.to_affine(), f64::from(error)))
    });
    let [Some((from, first)), Some((to, last))] = ends else { return None };
    let way = shape.farthest(&(to * from.inverse()));
    let step = DAffine3 {
        matrix3: to.matrix3 - from.matrix3,
        translation: to.translation - from.translation,
    };
    // Vertices are rounded, and so is where it stands: at both ends, and at the ray's time. And the
    // end is up to 2^-24 of all of the time late.
    let late = 2.0 * way * parts as f64 * f64::from(f32::EPSILON);
    let off = 4.0 * first.max(last) + late + bend;
    (off <= MOST_OFF * shape.size()).then_some((TimedWay { from, step }, off))
}
