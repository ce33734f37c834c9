//! What builders sort: the box of a triangle, or of a part of it, and its id.

use std::cmp::Ordering;

use rayon::prelude::*;

use crate::geom::TriangleSource;
use crate::math::{Aabb, PrimId, Vec3};

/// A triangle or a part of one, as a builder sees it.
#[derive(Clone, Copy, Debug)]
pub struct Prim {
    /// Its own box, or a part's ([`super::parts`]).
    pub bounds: Aabb,
    /// Whose it is.
    pub id: PrimId,
}

impl Prim {
    /// The middle of its box, by which it is put left or right.
    #[inline(always)]
    pub fn key(&self) -> Vec3 {
        // Halved first: two coordinates near the largest float must not add up to infinity.
        self.bounds.min * 0.5 + self.bounds.max * 0.5
    }

    /// The order along an axis: by keys, where they are equal by ids.
    #[inline(always)]
    pub fn order(&self, other: &Self, axis: usize) -> Ordering {
        self.key()[axis].total_cmp(&other.key()[axis]).then(self.id.cmp(&other.id))
    }
}

/// All triangles in the order of their ids.
pub fn make_prims(source: &dyn TriangleSource) -> Vec<Prim> {
    (0..source.len())
        .into_par_iter()
        .with_min_len(1024)
        .map(|i| {
            let id = PrimId::from_index(i);
            Prim { bounds: source.own_box(id), id }
        })
        .collect()
}
