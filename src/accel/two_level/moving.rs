//! What moves, in the walk of `wide`: placements and bodies as they stand at the ray's time.

use std::ops::ControlFlow;

use fearless_simd::{Simd, f32x8};

use super::body::OwnTriangle;
use super::moved::{Moved, Within, test_at};
use super::placement::{Entered, LocalRay};
use super::trees::W;
use super::verdict::Inside;
use super::wide::{Flight, Walk, test_all};
use super::wide_levels::Mover;
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::stack::Stack;
use crate::accel::{Counters, Event, Query};
use crate::math::{InstanceId, PrimId, Ray, TriangleId};

/// What a ray finds where it is to enter.
struct Entry {
    /// The placement, of a body its base.
    placement: InstanceId,
    /// Of its structure.
    root: Link,
    entered: Entered,
    /// How far off its vertices may be.
    slack: f32,
    within: Within,
}

impl<'a, const MOVES: bool> Walk<'a, MOVES> {
    /// Takes a ray into what moves as a whole, if it meets its box at the ray's time; by its number
    /// in the upper trees.
    #[inline(never)]
    pub fn enter_moving<Q: Query>(
        &self,
        number: usize,
        flight: &mut Flight<'a, Q>,
        (stack, local, moved): (&mut Stack<W>, &mut Ray, &mut Moved),
    ) -> ControlFlow<()> {
        let entry = match self.levels.mover(number) {
            Mover::Placement(number) => self.entry_of_placement(number, flight, moved),
            Mover::Body(number) => self.entry_of_body(number, flight, moved),
        };
        let Some(Entry { placement, root, entered, slack, within }) = entry else {
            return ControlFlow::Continue(());
        };
        let (ray, shift) = match entered {
            Entered::Missed => return ControlFlow::Continue(()),
            Entered::Inside(LocalRay { ray, shift }) => (ray, shift),
            Entered::Far => return self.test_whole(placement, within, flight),
        };
        let inside = Inside::new(placement, slack, shift).moving();
        flight.enter((inside, ray), root, stack);
        (*local, moved.within) = (ray, within);
        ControlFlow::Continue(())
    }

    /// What a ray finds at a placement that moves, by its number among those.
    #[inline(always)]
    fn entry_of_placement<Q: Query>(
        &self,
        number: usize,
        flight: &Flight<'a, Q>,
        moved: &mut Moved,
    ) -> Option<Entry> {
        let (levels, time) = (&*self.levels.levels, self.time(flight.world.index));
        let prim = PrimId::from_index(levels.still + number);
        let placement = levels.placements[prim.index()];
        let mesh = levels.placed.get().mesh(placement);
        let apart = levels.meshes[mesh.index()].as_ref()?;
        let root = self.levels.root_of_mesh(levels.spans.find(mesh, time))?;
        let (ray, t_max) = (&flight.world.ray, flight.query.nearest().t);
        let timed = &levels.timed_boxes;
        let entered = if let Some(way) = levels.timed_ways.find(number, timed.part(time)) {
            way.enter(timed.place(time), &apart.grown, ray, t_max)
        } else {
            let to_world = moved.find((placement, time), levels.placed.get().motions()?);
            let to_mesh = levels.to_mesh(prim, &to_world);
            to_mesh.map_or(Entered::Far, |to_mesh| to_mesh.enter(&apart.grown, ray, t_max))
        };
        let within = if apart.deforming { Within::Deforming } else { Within::Stiff };
        Some(Entry { placement, root, entered, slack: apart.slack, within })
    }

    /// What a ray finds at a body.
    #[inline(always)]
    fn entry_of_body<Q: Query>(
        &self,
        number: usize,
        flight: &Flight<'a, Q>,
        moved: &mut Moved,
    ) -> Option<Entry> {
        let (levels, time) = (&*self.levels.levels, self.time(flight.world.index));
        let body = &self.levels.bodies[number];
        let (placement, apart) = (body.base, &body.apart);
        let root = self.levels.root_of_body(number)?;
        let (ray, t_max) = (&flight.world.ray, flight.query.nearest().t);
        let entered = if let Some(entered) = body.enter(time, ray, t_max) {
            entered
        } else {
            let to_world = moved.find((placement, time), levels.placed.get().motions()?);
            let to_body = body.find_way(&to_world);
            to_body.map_or(Entered::Far, |to_body| to_body.enter(&apart.grown, ray, t_max))
        };
        let within = Within::Body(number);
        Some(Entry { placement, root, entered, slack: apart.slack, within })
    }

    /// Holds a ray that can't be placed against all triangles of a placement, or a body.
    #[cold]
    fn test_whole<Q: Query>(
        &self,
        placement: InstanceId,
        within: Within,
        flight: &mut Flight<'a, Q>,
    ) -> ControlFlow<()> {
        let (levels, time) = (&*self.levels.levels, self.time(flight.world.index));
        let Within::Body(number) = within else {
            return test_all(levels, flight, placement, time);
        };
        for &placement in self.levels.bodies[number].placements() {
            test_all(levels, flight, placement, time)?;
        }
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
        let time = self.time(world.index);
        self.levels.moving.test(simd, counters, block, (world, time), (query, moved))
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
        (local, moved): (&Ray, &mut Moved),
    ) -> ControlFlow<()> {
        let Flight { world, slab, query, link, inside, .. } = flight;
        let Some(inside) = inside else { return ControlFlow::Continue(()) };
        counters.count(Event::Leaf);
        counters.count(Event::TriangleTest);
        let block = self.stripes.block(*link);
        let mut lanes = match moved.within {
            // The leaves of a mesh that changes its shape hold boxes.
            Within::Deforming => block.find_boxes::<S, f32x8<S>>(simd, slab, query.t_max()),
            _ => block.find_near::<S, f32x8<S>>(simd, local, query.t_max(), inside.slack),
        };
        let (placements, time) = (self.levels.levels.placed.get(), self.time(world.index));
        let Some(motions) = placements.motions().filter(|_| lanes != 0) else {
            return ControlFlow::Continue(());
        };
        let placement = inside.placement;
        let of_placement = |prim: PrimId| TriangleId { instance: placement, index: prim.0 };
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % W;
            lanes &= lanes - 1;
            let prim = block.ids[lane];
            if prim == PrimId::NONE {
                continue;
            }
            counters.count(Event::ExactTest);
            let (id, corners) = match moved.within {
                Within::Body(number) => {
                    let OwnTriangle { id, corners } = *self.levels.bodies[number].own(prim);
                    (id, corners)
                }
                Within::Stiff => (of_placement(prim), block.triangle(lane)),
                Within::Deforming => {
                    let id = of_placement(prim);
                    (id, motions.mesh_at(placements.mesh(placement), time).triangle(prim.0))
                }
            };
            let hit = test_at(simd, motions, (id, &corners, time), (world, query), moved);
            if let Some(hit) = hit {
                query.take(hit, inside.limit(hit.t))?;
            }
        }
        ControlFlow::Continue(())
    }
}
