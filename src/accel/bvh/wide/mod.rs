//! `mbvh4`, `mbvh8`, `mbvh16`: hierarchies of nodes with as many children as a vector has lanes.
//!
//! M. Ernst and G. Greiner, "Multi bounding volume hierarchies", 2008. A node's children are tested
//! by one stream of vector instructions, and so are a leaf's triangles. A binary tree is built
//! first and collapsed ([`collapse`]); a ray walks by algorithm 2 of the paper, its children
//! ordered by distance rather than by octant, and a slice of rays is walked with sixteen of them in
//! flight ([`flight`]).

mod arena;
mod collapse;
mod flight;
mod node;

use std::ops::ControlFlow;
use std::time::Instant;

use fearless_simd::{Level, Simd};

use self::arena::{Arena, Link, Rows};
use self::collapse::Collapsed;
use super::leaves::{CACHE, Fetch, Fetched, TRIANGLES};
use super::{build_tree, sah};
use crate::accel::{
    Accel, Batch, BuildError, BuildInput, BuildReport, Counters, Event, MemoryReport, OptionSpec,
    Query, Shot, Traverse, Value, Values, Variant, test_block,
};
use crate::simd::order::{key_limit, store_sorted};
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

const fn row(
    id: &'static str,
    summary: &'static str,
    build: fn(&BuildInput<'_>) -> Result<Box<dyn Accel>, BuildError>,
) -> Variant {
    const OPTIONS: &[OptionSpec] = &[
        OptionSpec {
            name: "build",
            summary: "the binary tree to collapse: binned SAH, or a full SAH sweep",
            values: Values::Choice(&["binned", "sweep"]),
            default: Value::Choice("binned"),
        },
        TRIANGLES,
        CACHE,
    ];
    let paper = "Ernst and Greiner, Multi Bounding Volume Hierarchies, 2008";
    Variant { id, summary, paper, options: OPTIONS, build }
}

/// A hierarchy of width `W`.
pub struct Wide<const W: usize> {
    root: Option<Link>,
    arena: Arena<W>,
    /// `None` if the leaves store their triangles.
    fetch: Option<Fetch>,
    /// Row of the first leaf.
    first_leaf: usize,
    /// Entries that a walk may need, the sentinel included.
    stack: usize,
    level: Level,
    report: BuildReport,
}

/// What waits: keys and links of the same places. At the bottom lies a key of zero.
pub struct Stack {
    keys: Box<[u32]>,
    links: Box<[u32]>,
}

impl Stack {
    fn new(size: usize) -> Self {
        Self { keys: vec![0; size].into(), links: vec![0; size].into() }
    }

    /// Takes what is on top.
    #[inline(always)]
    fn pop(&self, top: &mut usize) -> (u32, Link) {
        *top -= 1;
        (self.keys[*top], Link(self.links[*top]))
    }
}

/// A thread's own.
pub struct Scratch<const W: usize> {
    stacks: Vec<Stack>,
    fetched: Fetched<W>,
}

impl<const W: usize> Wide<W>
where
    Lanes: Vectors<W>,
{
    fn build(input: &BuildInput<'_>) -> Result<Self, BuildError> {
        let cost = sah::Cost { traversal: 0.4, width: W };
        let (tree, mut phases) = build_tree(&*input.source, input.options.choice("build"), cost);
        let start = Instant::now();
        let wide = Collapsed::<W>::new(&tree);
        phases.push(("collapse", start.elapsed().as_secs_f64()));
        let start = Instant::now();
        let fetch = Fetch::new(input);
        let rows = wide.rows(fetch.is_none());
        if rows >= Link::LIMIT {
            let (count, limit) = (tree.order.len(), tree.order.len() * Link::LIMIT / rows);
            return Err(BuildError::TooManyTriangles { count, limit });
        }
        let arena = wide.write(&tree, &*input.source, fetch.is_none()).map_err(|_| {
            let needed = (rows * size_of::<[f32; W]>()) as u64;
            BuildError::TooLarge { needed, limit: 0 }
        })?;
        phases.push(("layout", start.elapsed().as_secs_f64()));
        Ok(Self {
            root: wide.root(),
            arena,
            fetch,
            first_leaf: wide.first_leaf(),
            // A level puts W aside and takes one of them; the last store is a whole vector.
            stack: 1 + (wide.report.max_depth + 1) * W,
            level: input.level,
            report: BuildReport { phases, ..wide.report },
        })
    }

    /// Goes one step from `link`: tests a leaf's triangles, or puts the children that the ray
    /// enters on the stack, the nearest on top.
    #[inline(always)]
    fn step<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        rows: Rows<'_, W>,
        shot: &Shot<'_>,
        query: &mut Q,
        link: Link,
        (stack, top): (&mut Stack, &mut usize),
        fetched: &mut Fetched<W>,
        counters: &mut C,
    ) -> ControlFlow<()> {
        if link.is_leaf() {
            counters.count(Event::Leaf);
            let block = match &self.fetch {
                None => rows.block(link),
                Some(fetch) => {
                    let leaf = link.row() - self.first_leaf;
                    fetched.block(fetch, leaf, rows.ids(link), counters)
                }
            };
            return test_block::<S, <Lanes as Vectors<W>>::Floats<S>, Q, C, W>(
                simd, shot, block, query, counters,
            );
        }
        counters.count(Event::InnerNode);
        counters.count(Event::BoxTest);
        let (planes, links) = rows.node(link);
        let (keys, hits) = node::enter(simd, planes, shot, query.t_max());
        let to_keys = (&mut stack.keys[*top..*top + W]).try_into().expect("W keys");
        let to_links = (&mut stack.links[*top..*top + W]).try_into().expect("W links");
        store_sorted(simd, keys, hits, links, to_keys, to_links);
        *top += hits.count_ones() as usize;
        counters.add(Event::Push, u64::from(hits.count_ones()));
        ControlFlow::Continue(())
    }
}

impl<const W: usize> Traverse for Wide<W>
where
    Lanes: Vectors<W>,
{
    type Scratch = Scratch<W>;

    fn scratch(&self) -> Scratch<W> {
        let stacks = (0..flight::RAYS).map(|_| Stack::new(self.stack)).collect();
        let fetched = self.fetch.as_ref().map(|fetch| fetch.table(self.report.leaves));
        Scratch { stacks, fetched: fetched.unwrap_or_else(Fetched::none) }
    }

    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        shot: &Shot<'_>,
        query: &mut Q,
        scratch: &mut Scratch<W>,
        counters: &mut C,
    ) {
        let Some(mut link) = self.root else { return };
        let rows = self.arena.rows();
        let Scratch { stacks, fetched } = scratch;
        let (stack, mut top) = (&mut stacks[0], 1);
        loop {
            if self
                .step(simd, rows, shot, query, link, (stack, &mut top), fetched, counters)
                .is_break()
            {
                return;
            }
            let limit = key_limit(query.t_max());
            let mut key;
            loop {
                (key, link) = stack.pop(&mut top);
                // The sentinel at the bottom is below any limit.
                if key <= limit {
                    break;
                }
            }
            if key == 0 {
                return;
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
        if is_wide(simd) && !C::COUNTS && flight::pays(batch.rays()) {
            self.fly::<S, Q, C>(simd, batch, answers, scratch, counters);
            return;
        }
        for (index, (ray, answer)) in batch.rays().iter().zip(answers).enumerate() {
            let mut query = Q::new(ray);
            let shot = Shot::new(ray, index, batch.filter());
            self.walk(simd, &shot, &mut query, scratch, counters);
            *answer = query.answer();
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
