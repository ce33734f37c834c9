//! Wide hierarchies on both levels, a slice of rays with sixteen of them in flight.
//!
//! As in [`crate::accel::bvh::wide`] each ray takes one step in turn and asks for what its next one
//! needs. The tree above is one of parts of placements and of what is flattened, so that the
//! nearest comes first whichever it is of; where anything moves, that has trees of its own, which
//! come before. A step may lead into a placement: then the ray goes on below, in the mesh's space
//! and nodes, on the same stack, where a key of zero marks the way back. As the stack's end, that
//! is found at the ray's next turn.
//!
//! All that links lead to lies in one piece of memory, whichever level it is of, and boxes are held
//! against the ray as it is where it is: so a step in a node is the same on both levels.

use std::ops::ControlFlow;

use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x8, u32x8};

use super::levels::Levels;
use super::moved::Moved;
use super::parts::Part;
use super::placement::{Entered, LocalRay};
use super::sources::FlatTriangles;
use super::trees::W;
use super::verdict::{Inside, nearest_of_all};
use super::wide_levels::{BACK, Scratch, WideLevels};
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::arena::Stripes;
use crate::accel::bvh::wide::node;
use crate::accel::bvh::wide::stack::{Sorting, Stack};
use crate::accel::bvh::wide::wide_bvh::RAYS;
use crate::accel::{ClosestHit, Counters, Event, PreparedRay, Query, SliceContext, Traverse};
use crate::geom::{BlockRef, SlabRay, TriangleSource, intersect_triangle};
use crate::math::{InstanceId, PrimId, Ray};
use crate::simd::order::key_limit;

/// A ray under way.
pub struct Flight<'a, Q> {
    /// The ray.
    pub world: PreparedRay<'a>,
    /// The ray for boxes, where it is: in the world or in the space of a mesh.
    pub slab: SlabRay,
    /// Where it begins there.
    t_min: f32,
    /// The placement that it is in; then what it is there lies among [`Scratch::locals`].
    pub inside: Option<Inside>,
    /// The question, with the best answer so far.
    pub query: Q,
    /// Taken off the stack for its next turn.
    key: u32,
    /// Likewise.
    pub link: Link,
    /// The height of its stack.
    pub top: usize,
    /// Which of the tracer's stacks and local rays is its own.
    own: usize,
}

/// Both levels, as a walk reads them. Where nothing `MOVES`, it is compiled without all that is
/// asked for that.
#[derive(Clone, Copy)]
pub struct Walk<'a, const MOVES: bool> {
    /// What was built.
    pub levels: &'a WideLevels,
    /// Of all trees.
    pub stripes: Stripes<'a, W>,
    /// Of the tree of what stands still.
    root: Option<Link>,
    /// The times of the batch's rays.
    pub times: Option<&'a [f32]>,
}

impl WideLevels {
    /// Traces a slice.
    #[inline(always)]
    fn fly<'a, S: Simd, Q: Query, C: Counters, const MOVES: bool>(
        &'a self,
        slice: &mut SliceContext<'a, S, Q, C>,
        scratch: &mut Scratch,
    ) {
        let (stripes, root, times) =
            (self.trees.stripes(), self.root_of_standing(), slice.batch.times());
        let walk = Walk::<MOVES> { levels: self, stripes, root, times };
        if root.is_none() && !MOVES {
            return slice.answer_nothing();
        }
        let Scratch { stacks, locals, moved } = scratch;
        let count = slice.batch.rays().len();
        let mut next = count.min(RAYS);
        let mut flights: Vec<Flight<'_, Q>> =
            (0..next).map(|index| walk.start(slice, (index, index), &mut stacks[index])).collect();
        while !flights.is_empty() {
            let mut turn = 0;
            while turn < flights.len() {
                let flight = &mut flights[turn];
                let own = flight.own;
                let (simd, counters) = (slice.simd, &mut *slice.counters);
                let waiting = (&mut stacks[own], &mut locals[own], &mut **moved);
                if walk.take_turn(simd, counters, flight, waiting).is_continue() {
                    turn += 1;
                    continue;
                }
                slice.answers[flight.world.index] = flight.query.answer();
                if next < count {
                    flights[turn] = walk.start(slice, (next, own), &mut stacks[own]);
                    next += 1;
                    turn += 1;
                } else {
                    flights.swap_remove(turn);
                }
            }
        }
    }
}

impl<'a, const MOVES: bool> Walk<'a, MOVES> {
    #[inline(always)]
    fn start<Q: Query>(
        &self,
        slice: &SliceContext<'a, impl Simd, Q, impl Counters>,
        (index, own): (usize, usize),
        stack: &mut Stack<W>,
    ) -> Flight<'a, Q> {
        let world = PreparedRay::of_batch(&slice.batch, index);
        let query = Q::new(&world.ray);
        // At the bottom of the stack lies the end.
        let (mut root, mut top) = (self.root, 1);
        if MOVES {
            for moving in self.levels.roots_of_moving(self.time(index)).into_iter().flatten() {
                if let Some(before) = root {
                    stack.put(1, before, &mut top);
                }
                root = Some(moving);
            }
        }
        let (key, link) = root.map_or((0, BACK), |root| (1, root));
        let (slab, t_min) = (world.slab, world.ray.t_min());
        Flight { world, slab, t_min, inside: None, query, key, link, top, own }
    }

    /// The time of a ray, by its place in the batch.
    #[inline(always)]
    pub fn time(&self, index: usize) -> f32 {
        self.times.map_or(0.0, |times| times[index])
    }

    /// Goes one step, and asks for what the next one needs; `Break` when the answer is final.
    #[inline(always)]
    fn take_turn<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        counters: &mut C,
        flight: &mut Flight<'a, Q>,
        (stack, local, moved): (&mut Stack<W>, &mut Ray, &mut [Moved]),
    ) -> ControlFlow<()> {
        let limit = key_limit(flight.query.t_max());
        while flight.key > limit {
            (flight.key, flight.link) = stack.pop(&mut flight.top);
        }
        if flight.key == 0 {
            flight.leave()?;
        } else if flight.link.is_leaf() {
            let moved = &mut moved[flight.own];
            self.visit(simd, counters, flight, (stack, local, moved))?;
        } else {
            let Flight { slab, t_min, query, link, top, .. } = flight;
            counters.count(Event::InnerNode);
            counters.count(Event::BoxTest);
            let (planes, links) = self.stripes.node(*link);
            let ray = (&*slab, *t_min);
            let (keys, hits) = node::intersect_children(simd, planes, ray, query.t_max());
            stack.push(simd, sorting::<Q>(), keys, hits, links, top);
        }
        (flight.key, flight.link) = stack.pop(&mut flight.top);
        if !(MOVES && self.levels.prefetch_moving(flight.link, self.time(flight.world.index))) {
            self.stripes.prefetch(flight.link);
        }
        ControlFlow::Continue(())
    }

    /// Does what is to be done at what is no node.
    #[inline(always)]
    fn visit<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        counters: &mut C,
        flight: &mut Flight<'a, Q>,
        (stack, local, moved): (&mut Stack<W>, &mut Ray, &mut Moved),
    ) -> ControlFlow<()> {
        let (place, places) = (flight.link.place(), &self.levels.places);
        if let Some(inside) = flight.inside {
            if MOVES && inside.moves {
                return self.test_moving_leaf(simd, counters, flight, (local, moved));
            }
            self.test_leaf(simd, counters, flight, local)
        } else if place < places.part {
            self.open_leaf(simd, counters, flight, stack)
        } else if !MOVES || place < places.whole {
            counters.count(Event::Restart);
            self.enter(place, flight, (stack, local))
        } else if place < places.block {
            counters.count(Event::Restart);
            self.enter_moving(place - places.whole, flight, (stack, local, moved))
        } else {
            self.test_moving_block(simd, counters, flight, (place - places.block, moved))
        }
    }

    /// Tests the triangles of a leaf of an upper tree, and puts those of its boxes on the stack
    /// that the ray enters: their ids are links.
    #[inline(always)]
    fn open_leaf<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        counters: &mut C,
        flight: &mut Flight<'_, Q>,
        stack: &mut Stack<W>,
    ) -> ControlFlow<()> {
        counters.count(Event::Leaf);
        let block = self.stripes.block(flight.link);
        let links = self.stripes.links(flight.link);
        let ids = u32x8::load_array_ref(simd, links);
        let are_triangles = (ids & Link::LEAF).simd_eq(0);
        let triangles = are_triangles.to_bitmask() as u32;
        if triangles != 0 {
            test_flat(simd, counters, flight, (&block, triangles), &self.levels.flat)?;
        }
        // Lanes that are not used repeat a primitive, without its id.
        let are_boxes = !(are_triangles | ids.simd_eq(PrimId::NONE.0));
        let boxes = are_boxes.to_bitmask() as u32;
        if boxes == 0 {
            return ControlFlow::Continue(());
        }
        counters.count(Event::BoxTest);
        let (ray, t_max) = ((&flight.slab, flight.t_min), flight.query.t_max());
        let (keys, hits) = node::intersect_boxes(simd, block.vertices, ray, t_max);
        let keys = are_boxes.select(u32x8::load_array(simd, keys), u32x8::splat(simd, 0));
        stack.push(simd, sorting::<Q>(), keys.to_array(), hits & boxes, links, &mut flight.top);
        ControlFlow::Continue(())
    }

    /// Takes a ray into a part of a placement that stands still, if it meets its box.
    #[inline(always)]
    fn enter<Q: Query>(
        &self,
        place: usize,
        flight: &mut Flight<'a, Q>,
        (stack, local): (&mut Stack<W>, &mut Ray),
    ) -> ControlFlow<()> {
        let levels = &*self.levels.levels;
        let Some(part) = self.levels.part(self.stripes, place) else {
            return ControlFlow::Continue(());
        };
        let Part { to_mesh, grown, placement, root, slack, .. } = &*part;
        let t_max = flight.query.nearest().t;
        let (ray, shift) = match to_mesh.enter(grown, &flight.world.ray, t_max) {
            Entered::Missed => return ControlFlow::Continue(()),
            Entered::Inside(LocalRay { ray, shift }) => (ray, shift),
            Entered::Far => return test_all(levels, flight, *placement, 0.0),
        };
        levels.placed.get().prefetch(*placement);
        flight.enter((Inside::new(*placement, *slack, shift), ray), *root, stack);
        *local = ray;
        ControlFlow::Continue(())
    }

    /// Tests the triangles of a leaf in a mesh.
    #[inline(always)]
    fn test_leaf<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        counters: &mut C,
        flight: &mut Flight<'_, Q>,
        local: &Ray,
    ) -> ControlFlow<()> {
        let Flight { world, query, link, inside, .. } = flight;
        let Some(inside) = inside else { return ControlFlow::Continue(()) };
        counters.count(Event::Leaf);
        counters.count(Event::TriangleTest);
        let block = self.stripes.block(*link);
        let mut lanes = block.find_near::<S, f32x8<S>>(simd, local, query.t_max(), inside.slack);
        if lanes == 0 {
            return ControlFlow::Continue(());
        }
        let to_world = self.levels.levels.placed.get().to_world(inside.placement);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % W;
            lanes &= lanes - 1;
            let prim = block.ids[lane];
            if prim == PrimId::NONE {
                continue;
            }
            counters.count(Event::ExactTest);
            let triangle = block.triangle(lane);
            let hit =
                inside.test(simd, (&to_world, world), (prim, &triangle), &query.nearest(), Q::ANY);
            if let Some(hit) = hit {
                query.take(hit, inside.limit(hit.t))?;
            }
        }
        ControlFlow::Continue(())
    }
}

impl<Q: Query> Flight<'_, Q> {
    /// Goes on in the space of a mesh, from a root.
    #[inline(always)]
    pub fn enter(&mut self, (inside, ray): (Inside, Ray), root: Link, stack: &mut Stack<W>) {
        self.inside = Some(inside);
        (self.slab, self.t_min) = (SlabRay::new(&ray), ray.t_min());
        self.query.set_limit(ray.t_max());
        stack.put(0, BACK, &mut self.top);
        stack.put(1, root, &mut self.top);
    }

    /// Goes back among placements; `Break` if it is there.
    #[inline(always)]
    fn leave(&mut self) -> ControlFlow<()> {
        if self.inside.is_none() {
            return ControlFlow::Break(());
        }
        self.inside = None;
        (self.slab, self.t_min) = (self.world.slab, self.world.ray.t_min());
        self.query.set_limit(self.query.nearest().t);
        ControlFlow::Continue(())
    }
}

#[inline(always)]
fn sorting<Q: Query>() -> Sorting {
    if Q::ANY { Sorting::None } else { Sorting::ByDistance }
}

/// Tests those triangles of a leaf that are flattened.
#[inline(always)]
fn test_flat<S: Simd, Q: Query, C: Counters>(
    simd: S,
    counters: &mut C,
    flight: &mut Flight<'_, Q>,
    (block, triangles): (&BlockRef<'_, W>, u32),
    flat: &FlatTriangles,
) -> ControlFlow<()> {
    let Flight { world, query, .. } = flight;
    counters.count(Event::TriangleTest);
    let mut lanes =
        block.find_candidates::<S, f32x8<S>>(simd, &world.ray, query.t_max()) & triangles;
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize % W;
        lanes &= lanes - 1;
        counters.count(Event::ExactTest);
        let found = intersect_triangle(simd, &world.slab, &world.shear, &block.lane(lane));
        let Some([t, u, v]) = found.filter(|[t, ..]| *t <= query.nearest().t) else { continue };
        let triangle = flat.locate(block.ids[lane]);
        query.offer(&world.criteria(), ClosestHit { t, u, v, triangle })?;
    }
    ControlFlow::Continue(())
}

/// Holds a ray that can't be placed against all triangles of a placement, as it stands at a time.
#[cold]
#[inline(never)]
pub fn test_all<Q: Query>(
    levels: &Levels,
    flight: &mut Flight<'_, Q>,
    placement: InstanceId,
    time: f32,
) -> ControlFlow<()> {
    let placements = levels.placed.get();
    let inside = Inside::new(placement, 0.0, 0.0);
    let nearest = flight.query.nearest();
    match nearest_of_all(placements, (&inside, time), &flight.world, &nearest, Q::ANY) {
        Some(hit) => flight.query.take(hit, hit.t),
        None => ControlFlow::Continue(()),
    }
}

impl Traverse for WideLevels {
    #[inline(always)]
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut Scratch,
    ) {
        let slice = &mut SliceContext::<_, Q, _> {
            simd: slice.simd,
            batch: slice.batch,
            answers: &mut *slice.answers,
            counters: &mut *slice.counters,
        };
        if self.places.are_moving() {
            self.fly::<_, _, _, true>(slice, scratch);
        } else {
            self.fly::<_, _, _, false>(slice, scratch);
        }
    }
}
