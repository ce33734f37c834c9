//! Where a leaf's triangles come from.
//!
//! M. Ernst and G. Greiner, "Multi bounding volume hierarchies", 2008, section 3.3: leaves need not
//! hold triangles. With `triangles=indexed` a leaf holds ids alone, and its triangles are fetched
//! out of the scene, in world space, whenever a ray gets there; with `triangles=cache` what was
//! fetched is kept in a small table of the thread's own, a leaf's place in it given by its number.
//! `triangles=inline` stores all of them: faster, and bigger.

use std::sync::Arc;

use crate::accel::{BuildInput, Counters, Event, OptionSpec, Value, Values};
use crate::geom::{BlockRef, TriangleBlock, TriangleSource};
use crate::math::PrimId;

/// The option that chooses.
pub const TRIANGLES: OptionSpec = OptionSpec {
    name: "triangles",
    summary: "stored in the leaves, fetched by id each time, or fetched and kept in a cache",
    values: Values::Choice(&["inline", "indexed", "cache"]),
    default: Value::Choice("inline"),
};

/// How large the cache is. A thread has one entry at least; memory reports leave it out, since it
/// belongs to threads and not to the structure.
pub const CACHE: OptionSpec = OptionSpec {
    name: "cache",
    summary: "size of the cache of triangles, over all threads",
    values: Values::Bytes(1),
    default: Value::Bytes(100_000_000),
};

/// Where triangles are fetched that are not stored.
#[derive(Clone)]
pub struct Fetch {
    source: Arc<dyn TriangleSource>,
    /// Bytes of all threads' caches together; 0 if nothing is kept.
    cache: u64,
}

impl Fetch {
    /// As the options say; `None` if triangles are stored.
    pub fn new(input: &BuildInput<'_>) -> Option<Self> {
        let cache = match input.options.choice("triangles") {
            "inline" => return None,
            "cache" => input.options.bytes("cache"),
            _ => 0,
        };
        Some(Self { source: Arc::clone(&input.source), cache })
    }

    /// A thread's table, for so many leaves.
    pub fn make_table<const W: usize>(&self, leaves: usize) -> Fetched<W> {
        let share = self.cache / rayon::current_num_threads().max(1) as u64;
        let entries = share / size_of::<(u32, TriangleBlock<W>)>() as u64;
        let entries = entries.clamp(1, leaves.max(1) as u64) as usize;
        Fetched { entries: vec![(NO_LEAF, TriangleBlock::EMPTY); entries] }
    }
}

/// A thread's fetched leaves: direct-mapped, one entry at least.
pub struct Fetched<const W: usize> {
    /// Leaf and triangles of each entry.
    entries: Vec<(u32, TriangleBlock<W>)>,
}

/// No leaf has this number.
const NO_LEAF: u32 = u32::MAX;

impl<const W: usize> Fetched<W> {
    /// For a structure that stores its triangles.
    pub fn none() -> Self {
        Self { entries: Vec::new() }
    }

    /// The triangles of a leaf, whose ids are given.
    #[inline]
    pub fn block<C: Counters>(
        &mut self,
        fetch: &Fetch,
        leaf: usize,
        ids: &[PrimId; W],
        counters: &mut C,
    ) -> BlockRef<'_, W> {
        let place = leaf % self.entries.len();
        let entry = &mut self.entries[place];
        // Nothing is kept where nothing was to be: the one entry is for its use alone.
        if entry.0 == leaf as u32 && fetch.cache > 0 {
            counters.count(Event::CacheHit);
        } else {
            counters.count(Event::CacheMiss);
            *entry = (leaf as u32, fetch_block(&*fetch.source, ids));
        }
        entry.1.parts()
    }
}

/// The ids of a leaf that does not store its triangles; [`PrimId::NONE`] in places not used.
pub fn pad_ids<const W: usize>(ids: &[PrimId]) -> [PrimId; W] {
    let mut padded = [PrimId::NONE; W];
    padded[..ids.len()].copy_from_slice(ids);
    padded
}

/// The triangles of a leaf, of which there is at least one.
pub fn fetch_triangles<const W: usize>(
    ids: &[PrimId],
    source: &dyn TriangleSource,
) -> TriangleBlock<W> {
    TriangleBlock::fetch(ids.len(), |lane| (ids[lane], source.triangle(ids[lane])))
}

/// The same out of the scene, for a ray: [`PrimId::NONE`] stands in places not used.
#[cold]
fn fetch_block<const W: usize>(source: &dyn TriangleSource, ids: &[PrimId; W]) -> TriangleBlock<W> {
    let count = ids.iter().take_while(|&&id| id != PrimId::NONE).count();
    fetch_triangles(&ids[..count], source)
}
