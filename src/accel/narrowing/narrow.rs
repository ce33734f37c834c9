//! Where the rays of a region or a slice start in a tree.

use fearless_simd::Simd;

use super::compress::Compression;
use super::entry_point::find_entry_point;
use super::hierarchy::{Hierarchy, Step};
use super::pool::{BranchPool, Region};
use super::within::Within;
use crate::accel::{Batch, Counters, PoolUse, Query, Regions, SliceContext};
use crate::geom::Shaft;
use crate::math::{Aabb, Ray};

/// Where packets start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// The root.
    Root,
    /// The entry point of the slice.
    EntryPoint,
    /// The slice's tree of branches.
    Compressed {
        /// By recursion rather than by a loop.
        recursive: bool,
        /// One more for each packet.
        per_packet: bool,
    },
}

/// A tree, and how it is narrowed.
#[derive(Clone, Copy)]
pub struct Narrowing<H: Hierarchy> {
    /// The tree.
    pub tree: H,
    /// Its root.
    pub root: H::Place,
    pub start: Start,
}

/// Where the rays of a slice start.
pub struct Started<P> {
    /// `None` if they meet no leaf.
    pub from: Option<Step<P>>,
    /// For which rays: for those that lie in all of these regions.
    pub within: Within,
}

/// The regions that a tracer has entered, see [`Regions`].
pub struct EnteredRegions<'a, H: Hierarchy, C> {
    /// How the tree is narrowed.
    pub narrowing: Narrowing<H>,
    /// What was derived for them.
    pub pool: &'a mut BranchPool<H::Place>,
    /// What is counted.
    pub counters: &'a mut C,
}

impl<H: Hierarchy, C: Counters> Regions for EnteredRegions<'_, H, C> {
    fn enter(&mut self, shaft: &Shaft) {
        let Self { narrowing, pool, counters } = self;
        let before = pool.len();
        let around = find_around(pool.regions(), |wider| wider.contains(shaft));
        let from = around.map_or(Some(narrowing.at_root()), |region| region.from);
        let from = from.and_then(|from| narrowing.narrow(from, pool, shaft, *counters));
        pool.enter(shaft.clone(), from, before);
    }

    fn leave(&mut self) {
        self.pool.leave();
    }

    fn take_pool_use(&mut self) -> PoolUse {
        self.pool.take_pool_use()
    }
}

impl<H: Hierarchy> Narrowing<H> {
    /// Finds where rays of a shaft start below a step; `None` if they meet no leaf.
    pub fn narrow<C: Counters>(
        &self,
        from: Step<H::Place>,
        pool: &mut BranchPool<H::Place>,
        shaft: &Shaft,
        counters: &mut C,
    ) -> Option<Step<H::Place>> {
        let branches = pool.branches_mut();
        let mut compression = Compression { tree: self.tree, branches, shaft };
        match self.start {
            Start::Root => Some(from),
            Start::EntryPoint => {
                let entry = find_entry_point(self.tree, from.place, shaft, counters);
                entry.map(|(place, _)| Step::to(place))
            }
            Start::Compressed { recursive: true, .. } => {
                compression.compress_recursively(from, counters)
            }
            Start::Compressed { .. } => compression.compress_iteratively(from, counters),
        }
    }

    /// Where all rays start.
    pub fn at_root(&self) -> Step<H::Place> {
        Step::to(self.root)
    }

    /// Finds where the rays of a slice start, within the regions that were entered. Its branches
    /// are put on top of the pool.
    ///
    /// What a camera sees through a tile is told by the rays at its corners; packets and bundles
    /// are then asked whether they lie there. (To ask each ray of a slice first takes about as long
    /// as to trace it.) The region of other slices is found by all their rays.
    pub fn start_slice<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        accepts: impl Fn(&Ray) -> bool,
        pool: &mut BranchPool<H::Place>,
    ) -> Started<H::Place> {
        let Some((corners, tile)) = find_tile(&slice.batch).filter(|_| self.start != Start::Root)
        else {
            return self.start_by_all_rays(slice, accepts, pool);
        };
        let holds = |region: &Shaft| corners.iter().all(|corner| region.holds(corner));
        let around = find_around(pool.regions(), holds);
        let from = around.map_or(Some(self.at_root()), |region| region.from);
        let around = around.map(|region| region.shaft.clone());
        let from = from.and_then(|from| self.narrow(from, pool, &tile, slice.counters));
        Started { from, within: Within::new(around, tile) }
    }

    /// Finds where all rays of a slice start, which are asked about one by one.
    fn start_by_all_rays<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        accepts: impl Fn(&Ray) -> bool,
        pool: &mut BranchPool<H::Place>,
    ) -> Started<H::Place> {
        let within = Within::default();
        if self.start == Start::Root {
            return Started { from: Some(self.at_root()), within };
        }
        let shaft = find_shaft(slice.simd, &slice.batch, &accepts);
        let holds = |region: &Shaft| {
            let contained = shaft.as_ref().is_some_and(|shaft| region.contains(shaft));
            contained || slice.batch.rays().iter().all(|ray| accepts(ray) && region.holds(ray))
        };
        let around = find_around(pool.regions(), holds);
        let mut from = around.map_or(Some(self.at_root()), |region| region.from);
        if let (Some(step), Some(shaft)) = (from, &shaft) {
            from = self.narrow(step, pool, shaft, slice.counters);
        }
        Started { from, within }
    }
}

/// Finds the innermost of the regions that holds what is asked about; `None` if none does, and rays
/// start at the root.
fn find_around<P>(regions: &[Region<P>], holds: impl Fn(&Shaft) -> bool) -> Option<&Region<P>> {
    regions.iter().rev().find(|region| holds(&region.shaft))
}

/// Finds the rays at the corners of a slice that is a raster of rays from one point, in order
/// around it, and the pyramid through them, a cell wider on each side.
fn find_tile(batch: &Batch<'_>) -> Option<([Ray; 4], Shaft)> {
    let (width, height, each) = batch.grid()?;
    if width < 2 || height < 2 || each == 0 {
        return None;
    }
    let cell = |x: usize, y: usize| batch.rays()[(y * width + x) * each];
    let corners = [(0, 0), (width - 1, 0), (width - 1, height - 1), (0, height - 1)];
    let corners = corners.map(|(x, y)| cell(x, y));
    if corners.iter().any(|corner| corner.origin() != corners[0].origin()) {
        return None;
    }
    // Of equal lengths, or a cell's width could not be told from the corners.
    let directions = corners.map(|corner| corner.direction().normalize_or_zero());
    let cells = [width - 1, height - 1].map(|cells| 1.0 / cells as f32);
    let wider = std::array::from_fn(|corner| {
        let here = directions[corner];
        let [beside, beyond] = [directions[corner ^ 1], directions[3 - corner]];
        here + (here - beside) * cells[0] + (here - beyond) * cells[1]
    });
    let tile = Shaft::tile(Aabb::of_points([corners[0].origin()]), wider)?;
    Some((corners, tile))
}

/// Finds a region that holds a whole slice.
fn find_shaft<S: Simd>(
    simd: S,
    batch: &Batch<'_>,
    accepts: impl Fn(&Ray) -> bool,
) -> Option<Shaft> {
    let rays = batch.rays();
    if !rays.iter().all(accepts) {
        return None;
    }
    let width = batch.grid().map_or(rays.len(), |(width, _, each)| width * each);
    let given = || {
        let given = batch.shaft().filter(|shaft| rays.iter().all(|ray| shaft.holds(ray)));
        given.cloned()
    };
    Shaft::of_rays(simd, rays, width).or_else(given)
}
