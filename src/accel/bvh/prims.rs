//! What builders sort: a triangle's box and its id.

use rayon::prelude::*;

use crate::geom::{TriangleSource, own_box};
use crate::math::{Aabb, TriangleId, Vec3};

/// A triangle, as a builder sees it.
#[derive(Clone, Copy, Debug)]
pub struct Prim {
    /// Its own box.
    pub bounds: Aabb,
    /// Whose it is.
    pub id: TriangleId,
}

impl Prim {
    /// The middle of its box, by which it is put left or right.
    #[inline(always)]
    pub fn key(&self) -> Vec3 {
        // Halved first: two coordinates near the largest float must not add up to infinity.
        self.bounds.min * 0.5 + self.bounds.max * 0.5
    }
}

/// All triangles in the order of their ids.
pub fn prims(source: &dyn TriangleSource) -> Vec<Prim> {
    (0..source.len())
        .into_par_iter()
        .with_min_len(1024)
        .map(|i| {
            let id = TriangleId::from_index(i);
            Prim { bounds: own_box(&source.triangle(id)), id }
        })
        .collect()
}
