//! `mbvh4`, `mbvh8`, `mbvh16`: hierarchies of nodes with as many children as a vector has lanes.
//!
//! M. Ernst and G. Greiner, "Multi bounding volume hierarchies", 2008. A node's children are tested
//! by one stream of vector instructions, and so are a leaf's triangles. A binary tree is built
//! first and collapsed (`collapse`), or none (`direct`), and its `shape` written into one `arena`. A
//! ray walks by algorithm 2 of the paper, its children ordered by distance, or by the direction's
//! octant as in the paper (`octants`), and a slice of rays is walked with sixteen of them in flight
//! (`flight`). There, where any hit will do, they are taken as they come: sorting them costs up to
//! 15 % and gains 4 at most.

mod arena;
mod collapse;
mod direct;
mod flight;
mod node;
mod octants;
mod shape;
mod stack;

use std::ops::ControlFlow;

use fearless_simd::{Level, Simd};

use self::arena::{Arena, BLOCK, Rows};
use self::shape::{Shape, Source};
use self::stack::{Sorting, Stack};
use super::leaves::{CACHE, Fetch, Fetched, TRIANGLES};
use super::link::Link;
use super::prims::prims;
use super::sah::{self, Cost, Fill, TRAVERSAL};
use super::{BUILD, Parts, REFINE, build_tree_by};
use crate::accel::{
    Accel, Batch, BuildError, BuildInput, BuildReport, Counters, Event, MemoryReport, OptionSpec,
    Options, Phases, PreparedRay, Query, Traverse, Value, Values, Variant, test_block, test_each,
};
use crate::geom::BlockRef;
use crate::simd::order::key_limit;
use crate::simd::{Lanes, Vectors, is_wide};

/// Four lanes, as in the paper.
pub const MBVH4: Variant =
    row("mbvh4", "four children a node, leaves of four triangles", |input| {
        Ok(Box::new(Wide::<4>::build(input)?))
    });

/// Eight lanes.
pub const MBVH8: Variant =
    row("mbvh8", "eight children a node, leaves of eight triangles", |input| {
        Ok(Box::new(Wide::<8>::build(input)?))
    });

/// Sixteen lanes.
pub const MBVH16: Variant =
    row("mbvh16", "sixteen children a node, leaves of sixteen triangles", |input| {
        Ok(Box::new(Wide::<16>::build(input)?))
    });

/// What measures best: eight lanes, triangles in the leaves, and a tree that is refined, its leaves
/// as full as the heuristic likes them.
///
/// On an AVX2 machine, by slices of random rays, this is 2.5 to 5 times as fast as `bvh2`. Eight
/// lanes beat four by 10 to 40 % and sixteen, which are two vectors there, by 30 %. Leaves that
/// need not be full are worth 20 % in scenes of long thin triangles and nothing in scans;
/// refinement 20 % in the same, for up to a fifth of the build's time. Spatial splits after that add
/// 10 % in some scenes and take as much in others, for twice the build's time, and are left to
/// `build=sbvh`. Whole renders are faster than with `bvh2` even where there are but a few dozen
/// triangles, by 10 %.
///
/// Beside Embree 4 in its default mode, whose hits may leak where ours may not, on a machine with
/// AVX-512 (Zen 4, one thread, geometric mean over scans, a kitchen and two robot cells of 69 to
/// 871 thousand triangles): 1.6 times its rate for slices of random, shadow and bounce rays, 1.05
/// for primary rays; ray by ray `mbvh8` has 0.84 and `mbvh4` 0.68.
///
/// Measured and left out: boxes of eight bits (7 to 18 % slower), children by octant in place of
/// distance (`order=octant`: as fast in flight, 5 to 15 % slower ray by ray), any other order in
/// memory (nothing). Packets for primary rays, as of `bvh-packet`: by themselves they are half as fast
/// again among large triangles, but pictures that end at the first hit gain 8 to 10 %, by which whole ones
/// would 1 to 3: less than a second tree is worth.
pub const AUTO: Variant = Variant {
    id: "auto",
    summary: "what measures best: mbvh8 of a refined tree, leaves as the heuristic likes them",
    paper: "see mbvh8",
    options: &[],
    build: |input| {
        let options = Options::parse(MBVH8.id, MBVH8.options, "leaves=any");
        let options = &options.expect("declared by its row");
        Ok(Box::new(Wide::<8>::build(&BuildInput {
            options,
            source: input.source.clone(),
            ..*input
        })?))
    },
};

const fn row(
    id: &'static str,
    summary: &'static str,
    build: fn(&BuildInput<'_>) -> Result<Box<dyn Accel>, BuildError>,
) -> Variant {
    const OPTIONS: &[OptionSpec] = &[BUILDS, REFINED, LEAVES, ORDER, TRIANGLES, CACHE];
    let paper = "Ernst and Greiner, Multi Bounding Volume Hierarchies, 2008";
    Variant { id, summary, paper, options: OPTIONS, build }
}

/// A binary tree's, or none in between.
const BUILDS: OptionSpec = OptionSpec {
    summary: "as for bvh2; or direct: binned in one pass without a binary tree, nor refinement",
    values: Values::Choice(&["binned", "sweep", "esc", "sbvh", "direct"]),
    ..BUILD
};

/// Refined unless said otherwise.
const REFINED: OptionSpec = OptionSpec { default: Value::Choice("on"), ..REFINE };

/// The option that says how full leaves are.
const LEAVES: OptionSpec = OptionSpec {
    name: "leaves",
    summary: "all full but one, as in the paper, or as the surface area heuristic likes them",
    values: Values::Choice(&["full", "any"]),
    default: Value::Choice("full"),
};

/// The option that says how a node's children are ordered.
const ORDER: OptionSpec = OptionSpec {
    name: "order",
    summary: "children by distance, or by octants as in the paper; in flight, for nearest hits only",
    values: Values::Choice(&["distance", "octant"]),
    default: Value::Choice("distance"),
};

/// A hierarchy of width `W`.
pub struct Wide<const W: usize> {
    root: Option<Link>,
    arena: Arena<W>,
    /// `None` if the leaves store their triangles.
    fetch: Option<Fetch>,
    /// Whether children are taken in the order of the direction's octant.
    by_octant: bool,
    /// If leaves hold parts of triangles: the rays that the boxes are good for.
    parts: Option<Parts>,
    /// Row of the first leaf.
    first_leaf: usize,
    level: Level,
    report: BuildReport,
}

/// A thread's own.
pub struct Scratch<const W: usize> {
    stacks: Box<[Stack<W>]>,
    fetched: Fetched<W>,
}

impl<const W: usize> Wide<W>
where
    Lanes: Vectors<W>,
{
    /// Builds the tree, binary first or in one pass, and says how long each phase took.
    fn build(input: &BuildInput<'_>) -> Result<Self, BuildError> {
        let fill = if input.options.choice("leaves") == "full" { Fill::Full } else { Fill::Any };
        let cost = Cost { traversal: TRAVERSAL, width: W, fill };
        let mut phases = Phases::start();
        if input.options.choice("build") == "direct" {
            let prims = prims(&*input.source);
            phases.end("boxes");
            let shape = direct::build::<W>(prims, cost);
            phases.end("tree");
            return Self::lay_out(input, &shape, phases);
        }
        let tree = build_tree_by(input, cost, &mut phases);
        let shape = collapse::collapse::<W>(tree);
        phases.end("collapse");
        Self::lay_out(input, &shape, phases)
    }

    /// Writes a tree's nodes and leaves.
    fn lay_out(
        input: &BuildInput<'_>,
        shape: &Shape<W, impl Source<W>>,
        mut phases: Phases,
    ) -> Result<Self, BuildError> {
        if shape.report.max_depth > sah::MAX_DEPTH {
            let (depth, limit) = (shape.report.max_depth, sah::MAX_DEPTH);
            return Err(BuildError::TooDeep { depth, limit });
        }
        let fetch = Fetch::new(input);
        let (inline, by_octant) = (fetch.is_none(), input.options.choice("order") == "octant");
        let rows = shape.rows(inline);
        if rows >= Link::LIMIT {
            let count = input.source.len();
            let limit = (count as u64 * Link::LIMIT as u64 / rows as u64) as usize;
            return Err(BuildError::TooManyTriangles { count, limit });
        }
        let mut arena = Arena::new(rows)
            .map_err(|_| BuildError::NoMemory { needed: (rows * size_of::<[f32; W]>()) as u64 })?;
        shape.write_nodes(&mut arena, inline, by_octant);
        phases.end("nodes");
        shape.write_leaves(&mut arena, &*input.source, inline);
        phases.end("leaves");
        Ok(Self {
            root: shape.root(),
            arena,
            fetch,
            by_octant,
            parts: shape.parts,
            first_leaf: shape.first_leaf(),
            level: input.level,
            report: BuildReport {
                phases: phases.ended(),
                triangles: input.source.len(),
                ..shape.report.clone()
            },
        })
    }

    /// In which order the children of a node go on the stack.
    #[inline(always)]
    fn sorting(&self, rows: Rows<'_, W>, node: Link, prepared: &PreparedRay<'_>) -> Sorting {
        if self.by_octant {
            Sorting::Listed(octants::list(rows.orders(node), octants::octant(&prepared.slab)))
        } else {
            Sorting::ByDistance
        }
    }

    /// A leaf's triangles.
    #[inline(always)]
    fn block<'a, C: Counters>(
        &self,
        rows: Rows<'a, W>,
        link: Link,
        fetched: &'a mut Fetched<W>,
        counters: &mut C,
    ) -> BlockRef<'a, W> {
        counters.count(Event::Leaf);
        match &self.fetch {
            None => rows.block(link),
            Some(fetch) => {
                let leaf = link.place() - self.first_leaf;
                fetched.block(fetch, leaf, rows.ids(link), counters)
            }
        }
    }

    /// Tests a leaf's triangles.
    #[inline(always)]
    fn test_leaf<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        rows: Rows<'_, W>,
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        link: Link,
        fetched: &mut Fetched<W>,
        counters: &mut C,
    ) -> ControlFlow<()> {
        let block = self.block(rows, link, fetched, counters);
        test_block::<S, <Lanes as Vectors<W>>::Floats<S>, Q, C, W>(
            simd, prepared, block, query, counters,
        )
    }

    /// Tests all leaves: for the few rays that boxes of parts are not good for.
    #[inline(never)]
    fn walk_all<Q: Query, C: Counters>(
        &self,
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        fetched: &mut Fetched<W>,
        counters: &mut C,
    ) {
        let (rows, of_leaf) = (self.arena.rows(), if self.fetch.is_some() { 1 } else { BLOCK });
        for leaf in 0..self.report.leaves {
            let link = Link::to_leaf(self.first_leaf + leaf * of_leaf);
            let block = self.block(rows, link, fetched, counters);
            if test_each(prepared, block, query, counters).is_break() {
                return;
            }
        }
    }
}

impl<const W: usize> Traverse for Wide<W>
where
    Lanes: Vectors<W>,
{
    type Scratch = Scratch<W>;

    fn scratch(&self) -> Scratch<W> {
        let stacks = (0..flight::RAYS).map(|_| Stack::new()).collect();
        let fetched = self.fetch.as_ref().map(|fetch| fetch.table(self.report.leaves));
        Scratch { stacks, fetched: fetched.unwrap_or_else(Fetched::none) }
    }

    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        scratch: &mut Scratch<W>,
        counters: &mut C,
    ) {
        let Some(mut link) = self.root else { return };
        let rows = self.arena.rows();
        let Scratch { stacks, fetched } = scratch;
        if self.parts.is_some_and(|parts| !parts.covers(&prepared.ray)) {
            return self.walk_all(prepared, query, fetched, counters);
        }
        let (stack, mut top) = (&mut stacks[0], 1);
        loop {
            if link.is_leaf() {
                if self.test_leaf(simd, rows, prepared, query, link, fetched, counters).is_break() {
                    return;
                }
            } else {
                counters.count(Event::InnerNode);
                counters.count(Event::BoxTest);
                let (planes, links) = rows.node(link);
                let (keys, hits) = node::enter(simd, planes, prepared, query.t_max());
                let sorting = self.sorting(rows, link, prepared);
                let below = stack.descend(simd, sorting, &keys, hits, links, &mut top);
                if let Some(nearest) = below {
                    counters.add(Event::Push, u64::from(hits.count_ones()) - 1);
                    if hits & (hits - 1) != 0 {
                        // Where it will turn to when it comes back from below `nearest`.
                        rows.prefetch(stack.peek(top));
                    }
                    link = nearest;
                    continue;
                }
            }
            match stack.next(&mut top, key_limit(query.t_max())) {
                Some(next) => link = next,
                None => return,
            }
        }
    }

    #[inline(always)]
    fn shoot<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        scratch: &mut Scratch<W>,
        counters: &mut C,
    ) {
        let covered = |ray| self.parts.is_none_or(|parts| parts.covers(ray));
        let in_flight = is_wide(simd) && !C::COUNTS && flight::pays(batch.rays());
        if in_flight && batch.rays().iter().all(covered) {
            self.fly::<S, Q, C>(simd, batch, answers, scratch, counters);
        } else {
            self.walk_each::<S, Q, C>(simd, batch, answers, scratch, counters);
        }
    }

    fn level(&self) -> Level {
        self.level
    }

    fn memory(&self) -> MemoryReport {
        let nodes = self.first_leaf * size_of::<[f32; W]>();
        let leaves = if self.fetch.is_some() { "references" } else { "leaves" };
        MemoryReport::new([("nodes", nodes), (leaves, self.arena.bytes() - nodes)])
    }

    fn report(&self) -> &BuildReport {
        &self.report
    }
}
