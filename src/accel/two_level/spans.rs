//! Which structures meshes have: one each, and those that change their shape one for each of some
//! equal pieces of the time.
//!
//! Over all of the time the boxes of a leg that swings are as large as its way, and a ray meets
//! most of them. Over a piece in which triangles go no further than they are large, a ray meets
//! few more than of a mesh that stands still.

use std::ops::Range;

use rayon::prelude::*;

use crate::geom::{Motions, Placements};
use crate::math::{Aabb, MeshId};

/// The most pieces.
const MOST: u32 = 64;
/// The most triangles that all structures of a mesh have, if they are more than one.
const MOST_TRIANGLES: u64 = 1 << 20;
/// How much larger boxes may be over a piece than at one time.
const GROWTH: f32 = 1.25;
/// How many triangles of a mesh are looked at.
const SAMPLES: usize = 256;

/// The structures, by mesh and then by time.
pub struct Spans {
    /// Of each mesh the number of its first structure, and last how many there are.
    first: Vec<u32>,
}

impl Spans {
    /// Chooses how many structures each mesh has.
    pub fn new(placements: &dyn Placements) -> Self {
        let count = |mesh| match placements.motions() {
            Some(motions) => count_pieces(placements, motions, MeshId::from_index(mesh)),
            None => 1,
        };
        let counts: Vec<u32> = (0..placements.meshes()).into_par_iter().map(count).collect();
        let mut first = vec![0];
        first.extend(counts.iter().scan(0, |sum, count| {
            *sum += count;
            Some(*sum)
        }));
        Self { first }
    }

    /// How many structures there are.
    pub fn len(&self) -> usize {
        self.first[self.first.len() - 1] as usize
    }

    /// The structures of a mesh, in the order of time.
    #[inline(always)]
    pub fn of_mesh(&self, mesh: MeshId) -> Range<usize> {
        self.first[mesh.index()] as usize..self.first[mesh.index() + 1] as usize
    }

    /// The structure for a mesh at a time from 0 to 1.
    #[inline]
    pub fn find(&self, mesh: MeshId, time: f32) -> usize {
        let [first, end] = [self.first[mesh.index()], self.first[mesh.index() + 1]];
        // Exact, since there are 2^n of them.
        let piece = (time * (end - first) as f32) as u32;
        (first + piece.min(end - first - 1)) as usize
    }

    /// The mesh of a structure, and from when to when it is so.
    pub fn locate(&self, structure: usize) -> (MeshId, [f32; 2]) {
        let mesh = self.first.partition_point(|&first| first as usize <= structure) - 1;
        let [first, end] = [self.first[mesh], self.first[mesh + 1]];
        let piece = structure as u32 - first;
        let span = [piece, piece + 1].map(|end_of| end_of as f32 / (end - first) as f32);
        (MeshId::from_index(mesh), span)
    }
}

/// The least 2^n for which boxes grow little, within the limits.
fn count_pieces(placements: &dyn Placements, motions: &dyn Motions, mesh: MeshId) -> u32 {
    let triangles = placements.mesh_len(mesh);
    if !motions.is_deforming(mesh) || triangles == 0 {
        return 1;
    }
    let step = triangles.div_ceil(SAMPLES);
    let size = |span: [f32; 2]| {
        let seen = (0..triangles).step_by(step);
        let extent = |index: usize| -> Aabb { motions.own_box_over(mesh, index as u32, span) };
        seen.map(|index| extent(index).extent().element_sum()).sum::<f32>()
    };
    let grows_little = |&count: &u32| {
        let ends = (0..count).map(|piece| [piece, piece + 1].map(|end| end as f32 / count as f32));
        let sizes = ends.map(|[from, to]| [size([from, to]), size([from, from])]);
        let [over, at] = sizes.fold([0.0, 0.0], |sum, it| [sum[0] + it[0], sum[1] + it[1]]);
        over <= GROWTH * at
    };
    let is_allowed = |count: &u32| u64::from(*count) * triangles as u64 <= MOST_TRIANGLES;
    let counts = (0..).map(|power| 1_u32 << power);
    let allowed = counts.take_while(|count| *count <= MOST && is_allowed(count));
    let allowed: Vec<u32> = allowed.collect();
    let enough = allowed.iter().copied().find(grows_little);
    enough.or(allowed.last().copied()).unwrap_or(1)
}
