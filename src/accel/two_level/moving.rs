//! What moves, in the walk of `wide`: a placement as it stands at the ray's time.

use std::ops::ControlFlow;

use fearless_simd::{Simd, f32x8};

use super::placement::{Entered, LocalRay};
use super::verdict::Inside;
use super::wide::{Above, Flight, test_all};
use super::wide_levels::{BACK, Local, Moved, W};
use crate::accel::bvh::wide::stack::Stack;
use crate::accel::{Counters, Event, Query};
use crate::math::PrimId;

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
        let prim = PrimId::from_index(levels.still + number);
        let (placement, to_world) = levels.placement(prim, time);
        let placements = levels.placed.get();
        let mesh = placements.mesh(placement);
        let structure = levels.spans.find(mesh, time);
        let (Some(apart), Some(root)) =
            (&levels.meshes[mesh.index()], self.levels.below.root(structure))
        else {
            return ControlFlow::Continue(());
        };
        let (ray, t_max) = (&flight.world.ray, flight.query.nearest().t);
        let entered = levels.to_mesh(prim, &to_world);
        let entered =
            entered.map_or(Entered::Far, |to_mesh| to_mesh.enter(&apart.grown, ray, t_max));
        let (ray, shift) = match entered {
            Entered::Missed => return ControlFlow::Continue(()),
            Entered::Inside(LocalRay { ray, shift }) => (ray, shift),
            Entered::Far => return test_all(levels, flight, placement, time),
        };
        flight.inside = Some(Inside::new(placement, apart.slack, shift).moving());
        let deforming = apart.deforming.then_some(mesh);
        (*local, *moved) = (Local::new(ray), Moved { to_world, time, deforming });
        flight.query.set_limit(ray.t_max());
        stack.put(0, BACK, &mut flight.top);
        stack.put(1, root, &mut flight.top);
        ControlFlow::Continue(())
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
        (local, moved): (&Local, &Moved),
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
        let posed = moved.deforming.zip(motions);
        let posed = posed.map(|(mesh, motions)| motions.mesh_at(mesh, moved.time));
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
            let (at, nearest) = ((&moved.to_world, &*world), query.nearest());
            let hit = inside.test(simd, at, (prim, &triangle), &nearest, Q::ANY);
            if let Some(hit) = hit {
                query.take(hit, inside.limit(hit.t))?;
            }
        }
        ControlFlow::Continue(())
    }
}
