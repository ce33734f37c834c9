//! Trees narrowed to the region of a slice, a packet or a view.

use fearless_simd::Simd;

use super::compress::Compression;
use super::entry::entry_point;
use super::hierarchy::{Branch, Hierarchy, Step};
use crate::accel::{Batch, Counters, NotCounted};
use crate::geom::Shaft;
use crate::math::Ray;

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

/// Where the packets of a slice start.
pub struct Started<'a, P> {
    /// `None` if they meet no leaf.
    pub from: Option<Step<P>>,
    /// The branches of the view, if that holds the slice.
    pub view: &'a [Branch<P>],
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

    /// Where the packets of a slice start. Its branches are put behind those of the thread.
    pub fn of_slice<S: Simd, C: Counters>(
        &self,
        simd: S,
        batch: &Batch<'_>,
        knows: impl Fn(&Ray) -> bool,
        own: &mut Vec<Branch<H::Place>>,
        counters: &mut C,
    ) -> Started<'a, H::Place> {
        if self.start == Start::Root {
            return Started { from: Some(Step::to(self.root)), view: &[] };
        }
        let shaft = of_slice(simd, batch, &knows);
        let view = self.view.filter(|view| {
            let contained = shaft.as_ref().is_some_and(|shaft| view.shaft.contains(shaft));
            contained || batch.rays().iter().all(|ray| knows(ray) && view.shaft.holds(ray))
        });
        let branches = view.map_or(&[][..], |view| &view.branches);
        let mut from = view.map_or(Some(Step::to(self.root)), |view| view.step);
        if let (Some(step), Some(shaft)) = (from, &shaft) {
            from = self.narrow(step, Trees { view: branches, own }, shaft, counters);
        }
        Started { from, view: branches }
    }
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
