//! Blocks of triangles that move, held against a ray as they are at its time.

use std::ops::ControlFlow;
use std::sync::Arc;

use fearless_simd::{Simd, f32x8};

use super::levels::Levels;
use super::moved::{Moved, test_at};
use super::moving_triangles::MovingTriangles;
use super::trees::W;
use crate::accel::{Counters, Event, PreparedRay, Query};
use crate::geom::MovingBlock;
use crate::math::TriangleId;
use crate::simd::prefetch;

/// The triangles of small placements that move, by blocks.
pub struct MovingBlocks {
    /// How the scene is divided.
    pub levels: Arc<Levels>,
    /// Whose they are.
    pub triangles: MovingTriangles,
    /// Those of the first part of the time, then those of the second, and so on.
    pub blocks: Vec<MovingBlock<W>>,
}

impl MovingBlocks {
    /// Prefetches a block.
    #[inline(always)]
    pub fn prefetch(&self, block: usize) {
        prefetch(&self.blocks, block, size_of::<MovingBlock<W>>());
    }

    /// Tests a block's triangles as they are at the ray's time.
    #[inline(always)]
    pub fn test<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        counters: &mut C,
        block: usize,
        (world, time): (&PreparedRay<'_>, f32),
        (query, moved): (&mut Q, &mut Moved),
    ) -> ControlFlow<()> {
        counters.count(Event::TriangleTest);
        let (levels, block) = (&*self.levels, &self.blocks[block]);
        let place = levels.timed_boxes.place(time);
        let mut lanes = block.find_near::<S, f32x8<S>>(simd, &world.ray, place, query.t_max());
        let placements = levels.placed.get();
        let Some(motions) = placements.motions().filter(|_| lanes != 0) else {
            return ControlFlow::Continue(());
        };
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % W;
            lanes &= lanes - 1;
            let id = block.ids[lane];
            if id == TriangleId::NONE {
                continue;
            }
            counters.count(Event::ExactTest);
            let corners = motions.mesh_at(placements.mesh(id.instance), time).triangle(id.index);
            let hit = test_at(simd, motions, (id, &corners, time), (world, query), moved);
            if let Some(hit) = hit {
                query.take(hit, hit.t)?;
            }
        }
        ControlFlow::Continue(())
    }
}
