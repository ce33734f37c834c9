//! Which tiles of which parts make each tile of a picture, and which samples are missing.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::error::PartError;
use super::file::Part;
use crate::film::Window;
use crate::render::{SIDE, tile_windows};

/// What is to be added up.
#[derive(Debug)]
pub(super) struct Plan {
    /// The pixels.
    pub window: Window,
    /// For each of the window's tiles, row by row, those that make it.
    pub cells: Vec<Cell>,
    /// Parts whose samples are all in another part too, and that other.
    pub repeated: BTreeSet<(usize, usize)>,
    /// What is missing.
    pub gaps: Vec<Gap>,
}

/// A tile of the picture.
#[derive(Debug)]
pub(super) struct Cell {
    pub window: Window,
    /// One for each rectangle that the crops of the parts cut it into: usually a single one.
    pub chains: Vec<Chain>,
}

/// Tiles of the same pixels, in the order of their samples.
#[derive(Debug)]
pub(super) struct Chain {
    pub window: Window,
    pub links: Vec<Link>,
}

/// A tile of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Link {
    pub part: usize,
    pub tile: usize,
    /// Whether its samples are those of the link before.
    pub repeats: bool,
}

/// Samples that are in no part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gap {
    /// The samples.
    pub samples: Range<u64>,
    /// The pixels that lack them: all, or some that lie around.
    pub window: Window,
    /// The part that can go on by `--resume` and fills it, if one was stopped there.
    pub unfinished: Option<usize>,
}

impl Plan {
    /// Works out how parts add up to the samples `wanted` of each pixel.
    ///
    /// # Errors
    /// [`PartError::Overlap`].
    pub fn new(parts: &[Part], wanted: &Range<u64>) -> Result<Self, PartError> {
        let window = bound(parts.iter().map(|part| part.head.crop()));
        let mut links: BTreeMap<(i32, i32), Vec<(Window, Link)>> = BTreeMap::new();
        for (part, file) in parts.iter().enumerate() {
            for (tile, &window) in file.windows().iter().enumerate() {
                let link = Link { part, tile, repeats: false };
                links.entry(square(window)).or_default().push((window, link));
            }
        }
        let mut plan =
            Self { window, cells: Vec::new(), repeated: BTreeSet::new(), gaps: Vec::new() };
        for window in tile_windows(window) {
            let found = links.remove(&square(window)).unwrap_or_default();
            let chains = plan.chain(parts, found, wanted)?;
            let covered: usize = chains.iter().map(|chain| chain.window.area()).sum();
            if covered < window.area() {
                let samples = wanted.clone();
                plan.gaps.push(Gap { samples, window, unfinished: None });
            }
            plan.cells.push(Cell { window, chains });
        }
        plan.gaps = join(std::mem::take(&mut plan.gaps));
        Ok(plan)
    }

    /// Whether every pixel has the same samples.
    pub fn is_even(&self, parts: &[Part]) -> bool {
        let covered =
            |cell: &Cell| cell.chains.iter().map(|chain| chain.window.area()).sum::<usize>();
        let chains = || self.cells.iter().flat_map(|cell| &cell.chains);
        let ranges = |chain: &Chain| -> Vec<_> {
            let fresh = chain.links.iter().filter(|link| !link.repeats);
            fresh.map(|link| parts[link.part].range(link.tile)).collect()
        };
        let first = chains().next().map(&ranges);
        self.cells.iter().all(|cell| covered(cell) == cell.window.area())
            && chains().all(|chain| !chain.links.is_empty() && Some(ranges(chain)) == first)
    }

    /// The chains of a cell; notes repeats and gaps.
    fn chain(
        &mut self,
        parts: &[Part],
        links: Vec<(Window, Link)>,
        wanted: &Range<u64>,
    ) -> Result<Vec<Chain>, PartError> {
        let mut chains: Vec<Chain> = Vec::new();
        for (window, link) in links {
            if let Some(chain) = chains.iter_mut().find(|chain| chain.window == window) {
                chain.links.push(link);
                continue;
            }
            if let Some(other) = chains.iter().find(|chain| meet(chain.window, window)) {
                let other_link = other.links[0];
                let samples = &parts[link.part].range(link.tile);
                return Err(overlap(parts, (other_link, link), samples, window));
            }
            chains.push(Chain { window, links: vec![link] });
        }
        for chain in &mut chains {
            self.order(parts, chain, wanted)?;
        }
        Ok(chains)
    }

    /// Puts a chain in the order of its samples.
    fn order(
        &mut self,
        parts: &[Part],
        chain: &mut Chain,
        wanted: &Range<u64>,
    ) -> Result<(), PartError> {
        let range = |link: &Link| parts[link.part].range(link.tile);
        let stops = stops(parts, &chain.links);
        chain.links.retain(|link| !range(link).is_empty());
        chain.links.sort_by_key(|link| (range(link).start, range(link).end, link.part));
        let mut at = wanted.start;
        let mut last: Option<Link> = None;
        let mut missing = Vec::new();
        for link in &mut chain.links {
            let samples = range(link);
            if let Some(before) = last
                && range(&before) == samples
            {
                link.repeats = true;
                self.repeated.insert((before.part, link.part));
                continue;
            }
            if samples.start < at {
                let before = last.unwrap_or(*link);
                let common = samples.start..at.min(samples.end);
                return Err(overlap(parts, (before, *link), &common, chain.window));
            }
            if samples.start > at {
                missing.push(at..samples.start);
            }
            (at, last) = (samples.end, Some(*link));
        }
        let is_finished = last.is_some_and(|link| parts[link.part].is_finished(link.tile));
        if at < wanted.end && !is_finished {
            missing.push(at..wanted.end);
        }
        let window = chain.window;
        self.gaps.extend(missing.into_iter().flat_map(|samples| cut(&samples, window, &stops)));
        Ok(())
    }
}

/// The square of the grid that a tile lies in.
fn square(window: Window) -> (i32, i32) {
    let side = SIDE as i32;
    (window.y0 / side, window.x0 / side)
}

fn meet(a: Window, b: Window) -> bool {
    a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1
}

/// The smallest window around some windows.
fn bound(windows: impl Iterator<Item = Window>) -> Window {
    windows
        .reduce(|a, b| Window {
            x0: a.x0.min(b.x0),
            y0: a.y0.min(b.y0),
            x1: a.x1.max(b.x1),
            y1: a.y1.max(b.y1),
        })
        .unwrap_or(Window { x0: 0, y0: 0, x1: 0, y1: 0 })
}

fn overlap(
    parts: &[Part],
    (a, b): (Link, Link),
    samples: &Range<u64>,
    window: Window,
) -> PartError {
    PartError::Overlap {
        a: parts[a.part].path().to_owned(),
        b: parts[b.part].path().to_owned(),
        samples: format!("{}..{}", samples.start, samples.end),
        window,
    }
}

/// A part that was stopped in a tile: which one, and the samples that it still is to take there.
type Stop = (usize, Range<u64>);

/// The parts of a chain that were stopped, by the sample that comes next.
fn stops(parts: &[Part], links: &[Link]) -> Vec<Stop> {
    let rest =
        |link: &Link| parts[link.part].range(link.tile).end..parts[link.part].head.samples().end;
    let stopped = |link: &&Link| !rest(link).is_empty() && !parts[link.part].is_finished(link.tile);
    let mut stops: Vec<Stop> =
        links.iter().filter(stopped).map(|link| (link.part, rest(link))).collect();
    stops.sort_by_key(|(part, rest)| (rest.start, rest.end, *part));
    stops
}

/// The gaps that missing samples make: what parts take that go on, and what is between.
fn cut(missing: &Range<u64>, window: Window, stops: &[Stop]) -> Vec<Gap> {
    let mut gaps = Vec::new();
    let mut at = missing.start;
    let mut add = |samples: Range<u64>, unfinished| {
        if !samples.is_empty() {
            gaps.push(Gap { samples, window, unfinished });
        }
    };
    for (part, rest) in stops {
        // It takes all of its samples, and must not meet those that are there.
        if rest.start >= at && rest.end <= missing.end {
            add(at..rest.start, None);
            add(rest.clone(), Some(*part));
            at = rest.end;
        }
    }
    add(at..missing.end, None);
    gaps
}

/// Gaps of the same samples, or of the same part, as one around all of them.
fn join(gaps: Vec<Gap>) -> Vec<Gap> {
    let mut joined: Vec<Gap> = Vec::new();
    for gap in gaps {
        let same = |it: &&mut Gap| match gap.unfinished {
            None => it.unfinished.is_none() && it.samples == gap.samples,
            part => it.unfinished == part,
        };
        match joined.iter_mut().find(same) {
            Some(found) => {
                found.window = bound([found.window, gap.window].into_iter());
                found.samples.start = found.samples.start.min(gap.samples.start);
                found.samples.end = found.samples.end.max(gap.samples.end);
            }
            None => joined.push(gap),
        }
    }
    joined.sort_by_key(|gap| (gap.samples.start, gap.window.y0, gap.window.x0));
    joined
}
