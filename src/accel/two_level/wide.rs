//! Wide hierarchies on both levels, a slice of rays with sixteen of them in flight.
//!
//! As in [`crate::accel::bvh::wide`] each ray takes one step in turn and asks for what its next one
//! needs. A step may lead into a placement: then the ray goes on below, in the mesh's space and
//! nodes, on the same stack, where a key of zero marks the way back. So the memory of both levels
//! is waited for together, and nothing is called through a table.

use std::ops::ControlFlow;
use std::sync::Arc;

use fearless_simd::{Simd, f32x8};

use super::levels::{Apart, Levels};
use super::placement::{Entered, LocalRay, enter};
use super::verdict::{Inside, nearest_of_all};
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::arena::Stripes;
use crate::accel::bvh::wide::node;
use crate::accel::bvh::wide::stack::{DEEPEST, Sorting, Stack};
use crate::accel::bvh::wide::wide_bvh::{RAYS, WideBvh};
use crate::accel::{
    Built, Counters, Event, MemoryReport, PreparedRay, Query, SliceContext, Structure, Traverse,
};
use crate::geom::SlabRay;
use crate::math::{InstanceId, PrimId};
use crate::simd::order::key_limit;

/// Lanes of a vector, children of a node.
const W: usize = 8;

/// A hierarchy of placements, and one of each mesh.
pub struct WideLevels {
    levels: Arc<Levels>,
    above: WideBvh<W>,
    below: Vec<Option<WideBvh<W>>>,
    /// Places of leaves from here on are placements.
    first_placement: usize,
    built: Built,
}

impl WideLevels {
    /// Both levels of trees that store what is in their leaves; hands them back if they can't be
    /// walked together.
    pub fn new(
        levels: Arc<Levels>,
        mut above: WideBvh<W>,
        below: Vec<Option<WideBvh<W>>>,
    ) -> Result<Self, (WideBvh<W>, Vec<Option<WideBvh<W>>>)> {
        let deepest = below.iter().flatten().map(|tree| tree.report().max_depth).max();
        // A level of its own each: the leaf of placements, and the way back.
        let depth = above.report().max_depth + deepest.unwrap_or(0) + 2;
        let first_placement = above.arena.stripes().len();
        let placements = levels.placements.last().map_or(0, |last| last.index() + 1);
        let in_place = below.iter().flatten().chain([&above]).all(WideBvh::stores_triangles);
        if depth > DEEPEST || first_placement + placements >= Link::LIMIT || !in_place {
            return Err((above, below));
        }
        above.renumber(|prim| PrimId(levels.placements[prim.index()].0));
        let mut report = above.report().clone();
        for tree in below.iter().flatten() {
            report.nodes += tree.report().nodes;
            report.leaves += tree.report().leaves;
        }
        let built = Built { level: above.level(), report };
        Ok(Self { levels, above, below, first_placement, built })
    }

}

/// Where a ray is below.
struct Visit<'a> {
    placement: Inside,
    /// The ray in the mesh's space.
    ray: PreparedRay<'a>,
    stripes: Stripes<'a, W>,
}

/// A ray under way.
struct Flight<'a, Q> {
    world: PreparedRay<'a>,
    query: Q,
    /// Taken off the stack for its next turn.
    key: u32,
    link: Link,
    top: usize,
    /// Which of the tracer's stacks is its own.
    stack: usize,
    /// While it is below.
    visit: Option<Visit<'a>>,
}

/// What a ray's turn came to.
enum Turn {
    /// There is more to do.
    Goes,
    /// Its answer is final.
    Ended,
}

impl WideLevels {
    #[inline(always)]
    fn start<'a, Q: Query>(
        &self,
        slice: &SliceContext<'a, impl Simd, Q, impl Counters>,
        root: Link,
        (index, stack): (usize, usize),
    ) -> Flight<'a, Q> {
        let world = PreparedRay::of_batch(&slice.batch, index);
        Flight { query: world.ask(), world, key: 1, link: root, top: 1, stack, visit: None }
    }

    /// Traces a slice.
    #[inline(always)]
    fn fly<'a, S: Simd, Q: Query, C: Counters>(
        &'a self,
        slice: &mut SliceContext<'a, S, Q, C>,
        stacks: &mut [Stack<W>],
    ) {
        let Some(root) = self.above.root else { return slice.answer_nothing() };
        let count = slice.batch.rays().len();
        let mut next = count.min(RAYS);
        let mut flights: Vec<Flight<'_, Q>> =
            (0..next).map(|index| self.start(slice, root, (index, index))).collect();
        while !flights.is_empty() {
            let mut turn = 0;
            while turn < flights.len() {
                let own = flights[turn].stack;
                match self.take_turn(slice, &mut flights[turn], &mut stacks[own]) {
                    Turn::Goes => turn += 1,
                    Turn::Ended => {
                        let flight = &flights[turn];
                        slice.answers[flight.world.index] = flight.query.answer();
                        if next < count {
                            flights[turn] = self.start(slice, root, (next, own));
                            next += 1;
                            turn += 1;
                        } else {
                            flights.swap_remove(turn);
                        }
                    }
                }
            }
        }
    }

    /// Goes one step, and asks for what the next one needs.
    #[inline(always)]
    fn take_turn<'a, S: Simd, Q: Query, C: Counters>(
        &'a self,
        slice: &mut SliceContext<'a, S, Q, C>,
        flight: &mut Flight<'a, Q>,
        stack: &mut Stack<W>,
    ) -> Turn {
        let limit = key_limit(flight.query.t_max());
        while flight.key > limit {
            (flight.key, flight.link) = stack.pop(&mut flight.top);
        }
        if flight.key == 0 {
            if flight.visit.take().is_none() {
                return Turn::Ended;
            }
            flight.query.set_limit(flight.query.nearest().t);
        } else {
            let simd = slice.simd;
            let (counters, link) = (&mut *slice.counters, flight.link);
            let ends = if flight.visit.is_some() {
                step_below(simd, counters, flight, stack)
            } else if link.is_leaf() && link.place() >= self.first_placement {
                let placement = InstanceId::from_index(link.place() - self.first_placement);
                self.enter(flight, placement, stack)
            } else {
                self.step_above(simd, counters, flight, stack);
                ControlFlow::Continue(())
            };
            if ends.is_break() {
                return Turn::Ended;
            }
        }
        (flight.key, flight.link) = stack.pop(&mut flight.top);
        match &flight.visit {
            Some(visit) => visit.stripes.prefetch(flight.link),
            None => self.above.arena.stripes().prefetch(flight.link),
        }
        Turn::Goes
    }

    /// Goes one step among placements: puts those of a leaf, or the children of a node, that the
    /// ray enters on the stack.
    #[inline(always)]
    fn step_above<S: Simd, Q: Query>(
        &self,
        simd: S,
        counters: &mut impl Counters,
        flight: &mut Flight<'_, Q>,
        stack: &mut Stack<W>,
    ) {
        let (stripes, link) = (self.above.arena.stripes(), flight.link);
        let (ray, t_max) = (&flight.world, flight.query.t_max());
        let sorting = if Q::ANY { Sorting::None } else { Sorting::ByDistance };
        counters.count(Event::BoxTest);
        if link.is_leaf() {
            counters.count(Event::Leaf);
            let block = stripes.block(link);
            let (keys, hits) = node::intersect_boxes(simd, block.vertices, ray, t_max);
            // Lanes that are not used repeat a box.
            let hits = hits & ((1 << block.len()) - 1);
            let keys = std::array::from_fn(|lane| if hits >> lane & 1 == 1 { keys[lane] } else { 0 });
            let links = block.ids.map(|id| self.link_to(id).0);
            stack.push(simd, sorting, keys, hits, &links, &mut flight.top);
        } else {
            counters.count(Event::InnerNode);
            let (planes, links) = stripes.node(link);
            let (keys, hits) = node::intersect_children(simd, planes, ray, t_max);
            stack.push(simd, sorting, keys, hits, links, &mut flight.top);
        }
    }

    #[inline(always)]
    fn link_to(&self, placement: PrimId) -> Link {
        Link::to_leaf(self.first_placement.wrapping_add(placement.index()))
    }

    /// Takes a ray into a placement, if it meets its box.
    #[inline(always)]
    fn enter<'a, Q: Query>(
        &'a self,
        flight: &mut Flight<'a, Q>,
        placement: InstanceId,
        stack: &mut Stack<W>,
    ) -> ControlFlow<()> {
        let placements = self.levels.placed.get();
        let mesh = placements.mesh(placement).index();
        let (Some(apart), Some(tree)) = (&self.levels.meshes[mesh], &self.below[mesh]) else {
            return ControlFlow::Continue(());
        };
        let Some(root) = tree.root else { return ControlFlow::Continue(()) };
        let to_world = placements.to_world(placement);
        let nearest = flight.query.nearest();
        let (ray, shift) = match enter(&apart.grown, &to_world, &flight.world.ray, nearest.t) {
            Entered::Missed => return ControlFlow::Continue(()),
            Entered::Inside(LocalRay { ray, shift }) => (ray, shift),
            Entered::Far => return self.test_all(flight, placement, apart),
        };
        let inside = Inside::new((placement, to_world), apart, shift);
        let ray = PreparedRay { ray, slab: SlabRay::new(&ray), ..flight.world };
        let stripes = tree.arena.stripes();
        flight.query.set_limit(ray.ray.t_max());
        flight.visit = Some(Visit { placement: inside, ray, stripes });
        stack.put(0, root, &mut flight.top);
        stack.put(1, root, &mut flight.top);
        ControlFlow::Continue(())
    }

    /// Holds a ray that can't be placed against all triangles of a placement.
    #[cold]
    #[inline(never)]
    fn test_all<Q: Query>(
        &self,
        flight: &mut Flight<'_, Q>,
        placement: InstanceId,
        apart: &Apart,
    ) -> ControlFlow<()> {
        let placements = self.levels.placed.get();
        let inside = Inside::new((placement, placements.to_world(placement)), apart, 0.0);
        let nearest = flight.query.nearest();
        match nearest_of_all(placements, &inside, &flight.world, &nearest, Q::ANY) {
            Some(hit) => flight.query.take(hit, hit.t),
            None => ControlFlow::Continue(()),
        }
    }
}

/// Goes one step in a mesh: tests a leaf's triangles, or puts the children that the ray enters on
/// the stack.
#[inline(always)]
fn step_below<S: Simd, Q: Query, C: Counters>(
    simd: S,
    counters: &mut C,
    flight: &mut Flight<'_, Q>,
    stack: &mut Stack<W>,
) -> ControlFlow<()> {
    let Flight { world, query, link, top, visit, .. } = flight;
    let Some(Visit { placement, ray, stripes, .. }) = visit else {
        return ControlFlow::Continue(());
    };
    if !link.is_leaf() {
        counters.count(Event::InnerNode);
        counters.count(Event::BoxTest);
        let (planes, links) = stripes.node(*link);
        let (keys, hits) = node::intersect_children(simd, planes, ray, query.t_max());
        let sorting = if Q::ANY { Sorting::None } else { Sorting::ByDistance };
        stack.push(simd, sorting, keys, hits, links, top);
        return ControlFlow::Continue(());
    }
    counters.count(Event::Leaf);
    counters.count(Event::TriangleTest);
    let block = stripes.block(*link);
    let slack = placement.slack;
    let mut lanes = block.find_near::<S, f32x8<S>>(simd, &ray.ray, query.t_max(), slack);
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize % W;
        lanes &= lanes - 1;
        let prim = block.ids[lane];
        if prim == PrimId::NONE {
            continue;
        }
        counters.count(Event::ExactTest);
        let triangle = block.triangle(lane);
        let hit = placement.test(simd, world, (prim, &triangle), &query.nearest(), Q::ANY);
        if let Some(hit) = hit {
            query.take(hit, placement.limit(hit.t))?;
        }
    }
    ControlFlow::Continue(())
}

impl Structure for WideLevels {
    type Scratch = Box<[Stack<W>]>;

    fn scratch(&self) -> Box<[Stack<W>]> {
        (0..RAYS).map(|_| Stack::new()).collect()
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let below = self.below.iter().flatten().map(|tree| tree.arena.bytes()).sum();
        MemoryReport::new([("placements", self.above.arena.bytes()), ("meshes", below)])
    }
}

impl Traverse for WideLevels {
    #[inline(always)]
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        stacks: &mut Box<[Stack<W>]>,
    ) {
        let slice = &mut SliceContext::<_, Q, _> {
            simd: slice.simd,
            batch: slice.batch,
            answers: &mut *slice.answers,
            counters: &mut *slice.counters,
        };
        self.fly(slice, stacks);
    }
}
