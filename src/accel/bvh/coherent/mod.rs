//! `bvh-packet`, `bvh-partition`, `bvh-entry-point`, `bvh-path-compression`: the binary hierarchy,
//! many rays at a time.
//!
//! A slice is cut into packets of up to 256 rays: blocks of its raster where it is one, runs of rays
//! where it is not (`accel::coherent`, which packets through kd-trees share). A packet walks the tree
//! of `bvh2` together (`packet`), so that a node is fetched once for all of its rays and most
//! decisions are made once.
//!
//! `bvh-packet`: I. Wald, S. Boulos and P. Shirley, "Ray tracing deformable scenes using dynamic
//! bounding volume hierarchies", 2007. A box is entered if the first ray that was under way enters
//! it, passed by if the shaft around all does, and else asked ray by ray until one enters. All rays
//! behind that one are carried along. Take it for primary rays and others that run side by side
//! among triangles that are not much smaller than the packet.
//!
//! `bvh-partition`: R. Overbeck, R. Ramamoorthi and W. R. Mark, "Large ray packets for real-time
//! Whitted ray tracing", 2008. All rays are asked at each node, and those that do not enter stay
//! behind: more work near the root, less near the leaves. Take it where the triangles are small.
//!
//! `bvh-entry-point` (`entry`) and `bvh-path-compression` (`compress`): A. Reshetov, A. Soupikov and
//! J. Hurley, "Multi-level ray tracing algorithm", 2005; J. Barczak, "An improved multi-level
//! raytracing algorithm". A slice's own shaft is taken through the tree first, and packets then
//! start at the node that holds all that it meets, or walk a tree of those nodes alone where
//! something is met on either side. What this trades: a walk of the shaft per slice for every
//! packet's way down to where the slice is. An entry point seldom lies deep; a compressed tree
//! spares nodes below it too, the more the larger the scene is beside the slice. Take them for
//! slices of many packets (`per-packet=on` with `with=partition`, as the paper's table 4 did). The
//! tracer that has entered a region, a screen or what a light reaches, or that of a `view`, starts
//! from what is met there: screen, tile, packet. The shaft of a raster of rays from one point is
//! taken from its corners, and a packet that does not lie in it is walked from the root; that of
//! other slices is found by all their rays. A slice that has none is given that of its batch if it
//! holds it, and is else walked from the root.
//!
//! Where we differ from all: rays are asked about boxes and triangles eight at a time, a *bundle*,
//! so that the first bundle decides, and bundles are what is partitioned; boxes are held against
//! planes around the packet (Reshetov et al. 2005, as Barczak does for path compression) and not by
//! interval arithmetic, and once all rays have hit something the planes are closed behind the last
//! hit; packets whose rays head different ways are split.
//!
//! What is not coherent is walked ray by ray, as by `bvh2`: packets whose slopes differ by more than
//! a half, runs of fewer than four rays. Why the answers are brute force's: each ray is asked by
//! the slab test about the box of every leaf whose triangles it is tested against, by a filter and
//! by the verdict; and a box is passed by only if the slab test of each ray says so, or the shaft,
//! which never says so of a box that one would enter ([`crate::geom::shaft`]).

mod packet;
mod place;
mod single;
mod slice;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use fearless_simd::{Level, Simd};

use self::packet::Packet;
use self::place::{Place, Places};
use super::binary::{self, Bvh2};
use super::leaves::{CACHE, TRIANGLES};
use super::{BUILD, REFINE};
use crate::accel::coherent::{Branch, Narrowing, PC, Pool, Regions, SIZE, Start, Step, View};
use crate::accel::{
    Accel, Batch, BuildError, BuildInput, BuildReport, Counters, MemoryReport, OptionSpec, PoolUse,
    PreparedRay, Query, Traverse, Value, Values, Variant,
};
use crate::geom::Shaft;

/// The row of packets.
pub const PACKET: Variant = Variant {
    id: "bvh-packet",
    summary: "bvh2's tree by packets of 16 by 16 rays: first active, early descent, shaft culling",
    paper: "Wald, Boulos and Shirley, Ray Tracing Deformable Scenes using Dynamic BVHs, 2007",
    options: &[BUILD, REFINE, TRIANGLES, CACHE, SIZE],
    build: |input| Ok(Box::new(Coherent::build(input, Start::Root, With::Packet)?)),
};

/// The row of partitioned packets.
pub const PARTITION: Variant = Variant {
    id: "bvh-partition",
    summary: "bvh2's tree by packets of 16 by 16 rays, partitioned at each node",
    paper: "Overbeck, Ramamoorthi and Mark, Large Ray Packets for Real-time Whitted Ray Tracing, 2008",
    options: &[BUILD, REFINE, TRIANGLES, CACHE, SIZE],
    build: |input| Ok(Box::new(Coherent::build(input, Start::Root, With::Partition)?)),
};

/// The row of entry points.
pub const ENTRY_POINT: Variant = Variant {
    id: "bvh-entry-point",
    summary: "bvh-packet from the deepest node that holds all that a slice's shaft meets",
    paper: "Reshetov, Soupikov and Hurley, Multi-Level Ray Tracing Algorithm, 2005; Fowler 2009",
    options: &[BUILD, REFINE, TRIANGLES, CACHE, SIZE, WITH],
    build: |input| Ok(Box::new(Coherent::build(input, Start::EntryPoint, With::chosen(input))?)),
};

/// The row of path compression.
pub const PATH_COMPRESSION: Variant = Variant {
    id: "bvh-path-compression",
    summary: "packets over a tree of those nodes alone that a slice's shaft meets both sides of",
    paper: "Barczak, An Improved Multi-Level Raytracing Algorithm",
    options: &[BUILD, REFINE, TRIANGLES, CACHE, SIZE, WITH, PC, PER_PACKET],
    build: |input| {
        let chosen = |name: &str, word: &str| input.options.choice(name) == word;
        let start = Start::Compressed {
            recursive: chosen("pc", "recursive"),
            per_packet: chosen("per-packet", "on"),
        };
        Ok(Box::new(Coherent::build(input, start, With::chosen(input))?))
    },
};

/// What walks below the entry point or the compressed tree.
const WITH: OptionSpec = OptionSpec {
    name: "with",
    summary: "packets that go down early, as bvh-packet's, or are partitioned, as bvh-partition's, \
              or rays one by one",
    values: Values::Choice(&["packet", "partition", "single"]),
    default: Value::Choice("packet"),
};

/// Whether packets have trees of their own.
const PER_PACKET: OptionSpec = OptionSpec {
    name: "per-packet",
    summary: "whether paths are compressed for each packet once more, which then asks no shaft",
    values: Values::Choice(&["off", "on"]),
    default: Value::Choice("off"),
};

/// A binary hierarchy for many rays.
pub struct Coherent {
    bvh: Arc<Bvh2>,
    /// Rays of a packet at most.
    size: usize,
    with: With,
    start: Start,
    /// What it was narrowed to.
    view: Option<View<Place>>,
}

/// What walks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum With {
    /// Packets that go down early.
    Packet,
    /// Packets that are partitioned at each node.
    Partition,
    /// Rays one by one.
    Single,
}

impl With {
    fn chosen(input: &BuildInput<'_>) -> Self {
        match input.options.choice("with") {
            "partition" => Self::Partition,
            "single" => Self::Single,
            _ => Self::Packet,
        }
    }
}

/// A thread's own.
pub struct Scratch {
    single: binary::Scratch,
    packet: Packet,
    pool: Pool,
    /// Trees of the regions that were entered, of the slice and of the packet at hand.
    branches: Vec<Branch<Place>>,
    regions: Regions<Place>,
    /// Steps put aside by a ray that walks alone, and where it enters them.
    steps: Vec<(Step<Place>, f32)>,
}

impl Coherent {
    fn build(input: &BuildInput<'_>, start: Start, with: With) -> Result<Self, BuildError> {
        let side = input.options.integer("size") as usize;
        let bvh = Arc::new(Bvh2::build(input)?);
        Ok(Self { bvh, size: side * side, with, start, view: None })
    }

    fn narrowing(&self) -> Option<Narrowing<'_, Places<'_>>> {
        let tree = self.bvh.root.map(|root| Places { bvh: &self.bvh, root })?;
        Some(Narrowing { tree, root: Place::ROOT, start: self.start, view: self.view.as_ref() })
    }
}

impl Traverse for Coherent {
    type Scratch = Scratch;

    fn scratch(&self) -> Scratch {
        Scratch {
            single: self.bvh.scratch(),
            packet: Packet::new(),
            pool: Pool::default(),
            branches: Vec::new(),
            regions: Regions::new(),
            steps: Vec::new(),
        }
    }

    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        scratch: &mut Scratch,
        counters: &mut C,
    ) {
        self.bvh.walk(simd, prepared, query, &mut scratch.single, counters);
    }

    #[inline(always)]
    fn shoot<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        scratch: &mut Scratch,
        counters: &mut C,
    ) {
        self.shoot_slice::<S, Q, C>(simd, batch, answers, scratch, counters);
    }

    fn enter<C: Counters>(&self, shaft: &Shaft, scratch: &mut Scratch, counters: &mut C) {
        if let Some(narrowing) = self.narrowing().filter(|_| self.start != Start::Root) {
            let Scratch { branches, regions, .. } = scratch;
            narrowing.enter(shaft, regions, branches, counters);
        }
    }

    fn leave(&self, scratch: &mut Scratch) {
        scratch.regions.leave(&mut scratch.branches);
    }

    fn pool(&self, scratch: &mut Scratch) -> PoolUse {
        scratch.regions.pool_use(&scratch.branches)
    }

    fn view(&self, shaft: &Shaft) -> Option<Box<dyn Accel + '_>> {
        let narrowing = self.narrowing().filter(|_| self.start != Start::Root)?;
        let (bvh, view) = (Arc::clone(&self.bvh), Some(narrowing.to(shaft)));
        Some(Box::new(Self { bvh, view, ..*self }))
    }

    fn level(&self) -> Level {
        Traverse::level(&*self.bvh)
    }

    fn memory(&self) -> MemoryReport {
        let mut memory = Traverse::memory(&*self.bvh);
        if let Some(view) = &self.view {
            memory.parts.push(("branches", view.bytes()));
        }
        memory
    }

    fn report(&self) -> &BuildReport {
        Traverse::report(&*self.bvh)
    }
}
