//! A packet: rays side by side, and the walk of all of them through the hierarchy.

use fearless_simd::Simd;

use super::place::{Place, Places};
use crate::accel::bvh::binary::WIDTH;
use crate::accel::bvh::leaves::Fetched;
use crate::accel::bvh::link::Link;
use crate::accel::bvh::sah;
use crate::accel::narrowing::{Branches, Hierarchy, Step};
use crate::accel::packet::{BUNDLES, EnteredRays, PacketContext};
use crate::accel::{Counters, Event, Query};
use crate::geom::{Shaft, TriangleBlock};
use crate::math::{Aabb, PrimId};

/// What waits: two children at most for each node on the way, of which one is taken up.
const STACK: usize = sah::MAX_DEPTH + 2;

/// Which of a packet's bundles are active: from one place of its order up to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Active {
    first: u8,
    end: u8,
}

/// A packet under way; all of its rays head the same way.
pub struct PacketWalk {
    /// Bundles in the order in which they are asked; only partitions change it.
    order: [u8; BUNDLES],
    /// Of each bundle the rays that enter the leaf at hand.
    entered: [u8; BUNDLES],
    stack: Box<[(Step<Place>, Active); STACK]>,
}

/// What a walk is in.
pub struct Within<'a, S, Q, C> {
    /// The rays.
    pub context: PacketContext<'a, S, Q, C>,
    /// The hierarchy.
    pub places: Places<'a>,
    /// Trees of branches in it.
    pub branches: Branches<'a, Place>,
    /// Leaves that were fetched.
    pub fetched: &'a mut Fetched<WIDTH>,
    /// Whether the rays are partitioned at each node.
    pub partitions: bool,
    /// Whether boxes are held against the shaft.
    pub culls: bool,
}

impl PacketWalk {
    /// Makes room for one.
    pub fn new() -> Self {
        Self {
            order: [0; BUNDLES],
            entered: [0; BUNDLES],
            stack: Box::new([(Step::to(Place::ROOT), Active { first: 0, end: 0 }); STACK]),
        }
    }

    /// Walks from a place down. The answers are left in the queries.
    #[inline(always)]
    pub fn walk<S: Simd, Q: Query, C: Counters>(
        &mut self,
        within: &mut Within<'_, S, Q, C>,
        start: Step<Place>,
        shaft: &mut Shaft,
    ) {
        self.order = std::array::from_fn(|i| i as u8);
        let mut waiting = within.context.rays.lanes();
        let mut nearer = false;
        self.stack[0] = (start, Active { first: 0, end: within.context.rays.count() as u8 });
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (step, active) = self.stack[top];
            let bounds = within.places.bounds(step.place);
            if nearer && active.end > active.first + 1 {
                within.context.rays.end_shaft(within.context.simd, shaft);
                nearer = false;
            }
            let Some(active) = self.enter(within, &bounds, active, shaft) else {
                continue;
            };
            let Some([first, second]) = within.branches.children(within.places, step) else {
                self.find_entered(within, &bounds, active);
                let found = self.test_leaf(within, within.places.link(step.place), active);
                nearer |= found > 0;
                if Q::ANY {
                    waiting -= found;
                    if waiting == 0 {
                        return;
                    }
                }
                continue;
            };
            within.context.counters.count(Event::InnerNode);
            within.context.counters.count(Event::Push);
            // The nearer one on top: that whose middle comes first along the rays. Of a branch,
            // too, the node's own children are compared: what is left of them in a compressed tree
            // are boxes of all sizes, whose middles say less (1.5 times the triangles in a city).
            let apart = within.places.apart(step.place);
            let second_is_nearer = usize::from(apart.dot(shaft.axis()) < 0.0);
            self.stack[top + 1 - second_is_nearer] = (first, active);
            self.stack[top + second_is_nearer] = (second, active);
            top += 2;
        }
    }

    /// Those bundles of which a ray enters a box.
    ///
    /// I. Wald, S. Boulos and P. Shirley, "Ray tracing deformable scenes using dynamic bounding
    /// volume hierarchies", 2007: the first that was active in the parent is asked first, and if it
    /// enters, all go down with it; then the shaft is; and only then the others, until one enters.
    /// R. Overbeck, R. Ramamoorthy and W. R. Mark, "Large ray packets for real-time Whitted ray
    /// tracing", 2008: those that enter are moved to the front, and the others stay behind.
    #[inline(always)]
    fn enter<S: Simd, Q: Query, C: Counters>(
        &mut self,
        within: &mut Within<'_, S, Q, C>,
        bounds: &Aabb,
        active: Active,
        shaft: &Shaft,
    ) -> Option<Active> {
        let Active { first, end } = active;
        let mut kept = first;
        let negative = within.context.rays.heading(0).negative;
        for at in first..end {
            let bundle = self.order[usize::from(at)];
            within.context.counters.count(Event::BoxTest);
            let bundle = within.context.rays.bundle(usize::from(bundle));
            let enters = bundle.enter(within.context.simd, bounds, negative) != 0;
            if enters {
                if !within.partitions {
                    return Some(Active { first: at, end });
                }
                self.order.swap(usize::from(at), usize::from(kept));
                kept += 1;
            } else if at == first && within.culls && shaft.misses(within.context.simd, bounds) {
                return None;
            }
        }
        (kept > first).then_some(Active { first, end: kept })
    }

    /// Finds the rays that enter a leaf's box.
    #[inline(always)]
    fn find_entered<S: Simd, Q: Query, C: Counters>(
        &mut self,
        within: &mut Within<'_, S, Q, C>,
        bounds: &Aabb,
        Active { first, end }: Active,
    ) {
        within.context.counters.add(Event::BoxTest, u64::from(end - first));
        let negative = within.context.rays.heading(0).negative;
        for &bundle in &self.order[usize::from(first)..usize::from(end)] {
            let bundle = usize::from(bundle);
            let enters =
                within.context.rays.bundle(bundle).enter(within.context.simd, bounds, negative);
            self.entered[bundle] = enters as u8;
        }
    }

    /// Tests a leaf's triangles; how many rays ended, or came nearer.
    #[inline(always)]
    fn test_leaf<S: Simd, Q: Query, C: Counters>(
        &mut self,
        within: &mut Within<'_, S, Q, C>,
        link: Link,
        Active { first, end }: Active,
    ) -> usize {
        let mut found = 0;
        let Within { context, places, fetched, .. } = within;
        let block = places.bvh.visit_leaf(link.place(), fetched, context.counters);
        let block = TriangleBlock { vertices: *block.vertices, ids: *block.ids };
        let block = block.parts();
        let bundles = &self.order[usize::from(first)..usize::from(end)];
        let mut entered = EnteredRays { bundles, lanes: &mut self.entered };
        for (lane, &id) in block.ids.iter().enumerate() {
            if id == PrimId::NONE {
                break;
            }
            found += context.test_triangle((id, &block.triangle(lane)), &mut entered);
        }
        found
    }
}
