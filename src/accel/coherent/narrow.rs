//! Trees narrowed to the region of a slice, a packet or a view.

use fearless_simd::Simd;

use super::compress::Compression;
use super::entry::entry_point;
use super::hierarchy::{Branch, Hierarchy, Step};
use super::rays::Rays;
use crate::accel::{Batch, Counters, NotCounted, PoolUse};
use crate::geom::{RayBundle, Shaft};
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

/// The part of a tree that a region meets.
pub struct View<P> {
    shaft: Shaft,
    branches: Vec<Branch<P>>,
    /// `None` if it meets no leaf.
    step: Option<Step<P>>,
}

/// A region that a thread has entered.
pub struct Region<P> {
    shaft: Shaft,
    /// `None` if it meets no leaf.
    step: Option<Step<P>>,
    /// So many branches were in the pool before.
    before: usize,
}

/// The regions that a thread has entered, from the outermost on, and the most branches in use.
pub struct Regions<P> {
    list: Vec<Region<P>>,
    peak: usize,
}

impl<P> Regions<P> {
    /// None.
    pub const fn new() -> Self {
        Self { list: Vec::new(), peak: 0 }
    }

    /// Leaves the innermost: its branches go.
    pub fn leave(&mut self, own: &mut Vec<Branch<P>>) {
        if let Some(region) = self.list.pop() {
            own.truncate(region.before);
        }
    }

    /// Notes how many branches are in use.
    pub fn note(&mut self, own: &[Branch<P>]) {
        self.peak = self.peak.max(own.len());
    }

    /// See [`crate::accel::Tracer::pool`].
    pub fn pool_use(&mut self, own: &Vec<Branch<P>>) -> PoolUse {
        let peak = std::mem::replace(&mut self.peak, own.len()).max(own.len());
        let bytes = size_of::<Branch<P>>();
        PoolUse { peak: peak * bytes, size: own.capacity() * bytes }
    }
}

/// A tree, what it was narrowed to already, and how it is narrowed further.
pub struct Narrowing<'a, H: Hierarchy> {
    /// The tree.
    pub tree: H,
    /// Its root.
    pub root: H::Place,
    /// How.
    pub start: Start,
    /// What it was narrowed to.
    pub view: Option<&'a View<H::Place>>,
}

/// Where branches come from and go to.
pub struct Trees<'a, P> {
    /// Those of a view.
    pub view: &'a [Branch<P>],
    /// Those of the thread; new ones are put behind them.
    pub own: &'a mut Vec<Branch<P>>,
}

/// Where the rays of a slice start.
pub struct Started<'a, P> {
    /// `None` if they meet no leaf.
    pub from: Option<Step<P>>,
    /// The branches of the view, if that holds the slice.
    pub view: &'a [Branch<P>],
    /// For which rays: for those that lie in all of these regions.
    pub within: Within,
}

/// Regions, up to two.
#[derive(Default)]
pub struct Within([Option<Shaft>; 2]);

impl Within {
    /// Whether no ray is to be asked about.
    pub fn is_all(&self) -> bool {
        self.0.iter().all(Option::is_none)
    }

    /// Whether they are seen to hold the rays of a bundle.
    #[inline(always)]
    pub fn holds_bundle<S: Simd>(&self, simd: S, bundle: &RayBundle) -> bool {
        for shaft in self.0.iter().flatten() {
            if !shaft.holds_bundle(simd, bundle) {
                return false;
            }
        }
        true
    }

    /// Whether they are seen to hold rays, of which `around` was made: by the four corners of that,
    /// or bundle by bundle.
    #[inline(always)]
    pub fn holds<S: Simd>(&self, simd: S, rays: &Rays, around: &Shaft) -> bool {
        for shaft in self.0.iter().flatten() {
            if !shaft.contains(around) && !rays.held_by(simd, shaft) {
                return false;
            }
        }
        true
    }
}

impl<P> View<P> {
    /// Bytes of its branches.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.branches)
    }
}

impl<'a, H: Hierarchy> Narrowing<'a, H> {
    /// Where rays of a shaft start below a step; `None` if they meet no leaf.
    pub fn narrow<C: Counters>(
        &self,
        from: Step<H::Place>,
        Trees { view, own }: Trees<'_, H::Place>,
        shaft: &Shaft,
        counters: &mut C,
    ) -> Option<Step<H::Place>> {
        let mut compression = Compression { tree: self.tree, view, own, shaft };
        match self.start {
            Start::Root => Some(from),
            Start::EntryPoint => {
                let entry = entry_point(self.tree, from.place, shaft, counters);
                entry.map(|(place, _)| Step::to(place))
            }
            Start::Compressed { recursive: true, .. } => compression.recursive(from, counters),
            Start::Compressed { .. } => compression.iterative(from, counters),
        }
    }

    /// The part that a region meets.
    pub fn to(&self, shaft: &Shaft) -> View<H::Place> {
        let wider = self.view.filter(|view| view.shaft.contains(shaft));
        let from = wider.map_or(Some(Step::to(self.root)), |view| view.step);
        let wider = wider.map_or(&[][..], |view| &view.branches);
        let mut branches = Vec::new();
        let step = from.and_then(|from| {
            self.narrow(from, Trees { view: wider, own: &mut branches }, shaft, &mut NotCounted)
        });
        branches.shrink_to_fit();
        let step = step.map(|step| step.without(wider.len()));
        View { shaft: shaft.clone(), branches, step }
    }

    /// The innermost of the regions around: those that a thread has entered, or the view's; with
    /// where rays start that lie in it. `None` if those start at the root.
    fn around<'b>(
        &self,
        regions: &'b [Region<H::Place>],
        holds: impl Fn(&Shaft) -> bool,
    ) -> Option<(&'b Shaft, Option<Step<H::Place>>)>
    where
        'a: 'b,
    {
        let view = self.view.map(|view| (&view.shaft, view.step));
        let entered = regions.iter().rev().map(|region| (&region.shaft, region.step));
        entered.chain(view).find(|(shaft, _)| holds(shaft))
    }

    /// The branches of the view.
    fn branches(&self) -> &'a [Branch<H::Place>] {
        self.view.map_or(&[][..], |view| &view.branches)
    }

    /// Where all rays start.
    pub fn at_root(&self) -> Step<H::Place> {
        Step::to(self.root)
    }

    /// Enters a region: what it meets is put behind the branches of the thread.
    pub fn enter<C: Counters>(
        &self,
        shaft: &Shaft,
        regions: &mut Regions<H::Place>,
        own: &mut Vec<Branch<H::Place>>,
        counters: &mut C,
    ) {
        let before = own.len();
        let around = self.around(&regions.list, |wider| wider.contains(shaft));
        let from = around.map_or(Some(self.at_root()), |(_, step)| step);
        let pool = Trees { view: self.branches(), own };
        let step = from.and_then(|from| self.narrow(from, pool, shaft, counters));
        regions.note(own);
        regions.list.push(Region { shaft: shaft.clone(), step, before });
    }

    /// Where the rays of a slice start, within the regions that were entered. Its branches are put
    /// behind those of the thread.
    ///
    /// What a camera sees through a tile is told by the rays at its corners; packets and bundles are
    /// then asked whether they lie there. (To ask each ray of a slice first takes about as long as to
    /// trace it.) The region of other slices is found by all their rays.
    pub fn of_slice<S: Simd, C: Counters>(
        &self,
        simd: S,
        (batch, regions): (&Batch<'_>, &Regions<H::Place>),
        knows: impl Fn(&Ray) -> bool,
        own: &mut Vec<Branch<H::Place>>,
        counters: &mut C,
    ) -> Started<'a, H::Place> {
        let Some((corners, tile)) = corners(batch).filter(|_| self.start != Start::Root) else {
            return self.of_all_rays(simd, (batch, regions), knows, own, counters);
        };
        let holds = |region: &Shaft| corners.iter().all(|corner| region.holds(corner));
        let around = self.around(&regions.list, holds);
        let from = around.map_or(Some(self.at_root()), |(_, step)| step);
        let view = self.branches();
        let from = from.and_then(|from| self.narrow(from, Trees { view, own }, &tile, counters));
        let within = Within([around.map(|(region, _)| region.clone()), Some(tile)]);
        Started { from, view, within }
    }

    /// Where all rays of a slice start, which are asked about one by one.
    fn of_all_rays<S: Simd, C: Counters>(
        &self,
        simd: S,
        (batch, regions): (&Batch<'_>, &Regions<H::Place>),
        knows: impl Fn(&Ray) -> bool,
        own: &mut Vec<Branch<H::Place>>,
        counters: &mut C,
    ) -> Started<'a, H::Place> {
        let within = Within::default();
        if self.start == Start::Root {
            return Started { from: Some(self.at_root()), view: &[], within };
        }
        let shaft = of_slice(simd, batch, &knows);
        let holds = |region: &Shaft| {
            let contained = shaft.as_ref().is_some_and(|shaft| region.contains(shaft));
            contained || batch.rays().iter().all(|ray| knows(ray) && region.holds(ray))
        };
        let around = self.around(&regions.list, holds);
        let (mut from, view) =
            (around.map_or(Some(self.at_root()), |(_, step)| step), self.branches());
        if let (Some(step), Some(shaft)) = (from, &shaft) {
            from = self.narrow(step, Trees { view, own }, shaft, counters);
        }
        Started { from, view, within }
    }
}

/// The rays at the corners of a slice that is a raster of rays from one point, in order around it,
/// and the pyramid through them, a cell wider on each side.
fn corners(batch: &Batch<'_>) -> Option<([Ray; 4], Shaft)> {
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

/// A region that holds a whole slice.
fn of_slice<S: Simd>(simd: S, batch: &Batch<'_>, knows: impl Fn(&Ray) -> bool) -> Option<Shaft> {
    let rays = batch.rays();
    if !rays.iter().all(knows) {
        return None;
    }
    let row = batch.grid().map_or(rays.len(), |(width, _, each)| width * each);
    let given = || {
        let given = batch.shaft().filter(|shaft| rays.iter().all(|ray| shaft.holds(ray)));
        given.cloned()
    };
    Shaft::of_rays(simd, rays, row).or_else(given)
}
