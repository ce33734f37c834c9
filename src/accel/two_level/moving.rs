//! What moves, in the walk of `wide`: a placement as it stands at the ray's time.

use std::ops::ControlFlow;

use fearless_simd::{Simd, f32x8};

use super::placement::{Entered, LocalRay};
use super::trees::W;
use super::verdict::Inside;
use super::wide::{Above, Flight, test_all};
use super::wide_levels::{BACK, Local, Moved};
use crate::accel::bvh::wide::stack::Stack;
use crate::accel::{ClosestHit, Counters, Event, PreparedRay, Query};
use crate::math::{PrimId, TriangleId};

impl<'a, const MOVES: bool> Above<'a, MOVES> {
    /// Takes a ray into a placement that moves, if it meets its box at the ray's time; by its
    /// number among those.
    #[inline(never)]
    pub fn enter_moving<Q: Query>(
        &self,
        number: usize,
        flight: &mut Flight<'a, Q>,
        (stack, local, moved): (&mut Stack<W>, &mut Local, &mut Moved),
    ) -> ControlFlow<()> {
        let (levels, time) = (&*self.levels.levels, self.time(flight.world.index));
        let number = self.levels.moving.rest()[number] as usize;
        let prim = PrimId::from_index(levels.still + number);
        let placement = levels.placements[prim.index()];
        let mesh = levels.placed.get().mesh(placement);
        let structure = levels.spans.find(mesh, time);
        let (Some(apart), Some(root)) =
            (&levels.meshes[mesh.index()], self.levels.below.root(structure))
        else {
            return ControlFlow::Continue(());
        };
        let (ray, t_max) = (&flight.world.ray, flight.query.nearest().t);
        let timed = &levels.timed_boxes;
        let entered = if let Some(way) = levels.timed_ways.find(number, timed.part(time)) {
            way.enter(timed.place(time), &apart.grown, ray, t_max)
        } else {
            let to_world = moved.find((placement, time), levels);
            let to_mesh = levels.to_mesh(prim, &to_world);
            to_mesh.map_or(Entered::Far, |to_mesh| to_mesh.enter(&apart.grown, ray, t_max))
        };
        let (ray, shift) = match entered {
            Entered::Missed => return ControlFlow::Continue(()),
            Entered::Inside(LocalRay { ray, shift }) => (ray, shift),
            Entered::Far => return test_all(levels, flight, placement, time),
        };
        flight.inside = Some(Inside::new(placement, apart.slack, shift).moving());
        moved.deforming = apart.deforming.then_some(mesh);
        *local = Local::new(ray);
        flight.query.set_limit(ray.t_max());
        stack.put(0, BACK, &mut flight.top);
        stack.put(1, root, &mut flight.top);
        ControlFlow::Continue(())
    }

    /// Tests a block of triangles that move, as they are at the ray's time.
    #[inline(always)]
    pub fn test_moving_block<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        counters: &mut C,
        flight: &mut Flight<'_, Q>,
        (block, moved): (usize, &mut Moved),
    ) -> ControlFlow<()> {
        let Flight { world, query, .. } = flight;
        counters.count(Event::Leaf);
        counters.count(Event::TriangleTest);
        let (time, block) = (self.time(world.index), &self.levels.blocks[block]);
        let place = self.levels.levels.timed_boxes.place(time);
        let mut lanes = block.find_near::<S, f32x8<S>>(simd, &world.ray, place, query.t_max());
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % W;
            lanes &= lanes - 1;
            let id = block.ids[lane];
            if id == PrimId::NONE {
                continue;
            }
            counters.count(Event::ExactTest);
            if let Some(hit) = self.test_moving(simd, (id, time), (world, query), moved) {
                query.take(hit, hit.t)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// What the exact test says of a triangle that moves, at a time.
    #[inline(always)]
    fn test_moving<S: Simd, Q: Query>(
        &self,
        simd: S,
        (id, time): (PrimId, f32),
        (world, query): (&PreparedRay<'_>, &Q),
        moved: &mut Moved,
    ) -> Option<ClosestHit> {
        let placements = self.levels.levels.placed.get();
        let motions = placements.motions()?;
        let TriangleId { instance: placement, index } = self.levels.moving.locate(id);
        let to_world = moved.find((placement, time), &self.levels.levels);
        let triangle = motions.mesh_at(placements.mesh(placement), time).triangle(index);
        let inside = Inside::new(placement, 0.0, 0.0);
        let at = (&to_world, world);
        inside.test(simd, at, (PrimId(index), &triangle), &query.nearest(), Q::ANY)
    }

    /// Tests the triangles of a leaf in a mesh, as they are at the ray's time.
    ///
    /// It has its own loop over lanes: with one function for this and for what stands still, rays
    /// in a hall of robots take 5 to 9 % longer.
    #[inline(always)]
    pub fn test_moving_leaf<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        counters: &mut C,
        flight: &mut Flight<'_, Q>,
        (local, moved): (&Local, &mut Moved),
    ) -> ControlFlow<()> {
        let Flight { world, query, link, inside, .. } = flight;
        let Some(inside) = inside else { return ControlFlow::Continue(()) };
        counters.count(Event::Leaf);
        counters.count(Event::TriangleTest);
        let block = self.meshes.block(*link);
        let mut lanes = match moved.deforming {
            // The leaves of a mesh that changes its shape hold boxes.
            Some(_) => block.find_boxes::<S, f32x8<S>>(simd, &local.slab, query.t_max()),
            None => block.find_near::<S, f32x8<S>>(simd, &local.ray, query.t_max(), inside.slack),
        };
        if lanes == 0 {
            return ControlFlow::Continue(());
        }
        let motions = self.levels.levels.placed.get().motions();
        let time = self.time(world.index);
        let posed = moved.deforming.zip(motions);
        let posed = posed.map(|(mesh, motions)| motions.mesh_at(mesh, time));
        let to_world = moved.find((inside.placement, time), &self.levels.levels);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % W;
            lanes &= lanes - 1;
            let prim = block.ids[lane];
            if prim == PrimId::NONE {
                continue;
            }
            counters.count(Event::ExactTest);
            let triangle = match &posed {
                Some(posed) => posed.triangle(prim.0),
                None => block.triangle(lane),
            };
            let (at, nearest) = ((&to_world, &*world), query.nearest());
            let hit = inside.test(simd, at, (prim, &triangle), &nearest, Q::ANY);
            if let Some(hit) = hit {
                query.take(hit, inside.limit(hit.t))?;
            }
        }
        ControlFlow::Continue(())
    }
}
