//! The boxes of what moves, by equal parts of the time that the shutter is open.
//!
//! Over all of the time a blade that turns is as large as the disc of its way: a ray that meets
//! that box would have to look for where the blade is at its time, which takes as long as a walk
//! through a tree. A box for each part of the time tells most such rays that they pass by.

use rayon::prelude::*;

use super::placement::Shape;
use crate::geom::Placements;
use crate::math::{Aabb, InstanceId};

/// The most boxes of a placement.
const MOST: usize = 256;
/// The most of all: 24 bytes each.
const MOST_OF_ALL: usize = 1 << 19;
/// Times of pieces are rounded by less than this.
const ROUNDING: f64 = 1e-9;

/// The boxes, by placement and then by time.
#[derive(Default)]
pub struct TimedBoxes {
    /// Of each placement the number of its first box, and last how many there are.
    first: Vec<u32>,
    boxes: Vec<Aabb>,
}

impl TimedBoxes {
    /// Those of placements of meshes that have `shapes`; of what stands still there are none.
    pub fn new(
        placements: &dyn Placements,
        apart: &[InstanceId],
        shapes: &[Option<Shape>],
    ) -> Self {
        let Some(motions) = placements.motions() else { return Self::default() };
        let moving = apart.iter().filter(|&&placement| motions.is_moving(placement)).count();
        let most = (MOST_OF_ALL / moving.max(1)).min(MOST);
        let find = |&placement: &InstanceId| {
            let shape = shapes[placements.mesh(placement).index()].as_ref();
            match shape.filter(|_| motions.is_moving(placement)) {
                Some(shape) => divide(&shape.boxes_over_time(motions, placement), most),
                None => Vec::new(),
            }
        };
        let found: Vec<Vec<Aabb>> = apart.par_iter().map(find).collect();
        let mut first = vec![0];
        first.extend(found.iter().scan(0, |sum, boxes| {
            *sum += boxes.len() as u32;
            Some(*sum)
        }));
        Self { first, boxes: found.concat() }
    }

    /// What holds a placement at a time from 0 to 1, if that is known better than for all times.
    #[inline]
    pub fn at(&self, placement: usize, time: f32) -> Option<&Aabb> {
        let [first, end] = *self.first.get(placement..placement + 2)? else { return None };
        let count = end - first;
        // Exact, since there are 2^n of them.
        let part = ((time * count as f32) as u32).min(count.checked_sub(1)?);
        self.boxes.get((first + part) as usize)
    }

    /// Bytes of all.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.first) + size_of_val(&*self.boxes)
    }
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
        let timed = TimedBoxes { first: vec![0, 0, 4], boxes };
        assert_eq!(timed.at(0, 0.5), None);
        assert_eq!(timed.at(1, 0.2).map(|held| held.max.x), Some(1.0));
        assert_eq!(timed.at(1, 1.0).map(|held| held.min.x), Some(9.0));
        assert_eq!(timed.at(2, 0.0), None);
    }
}
