//! Counting a traversal's work, at no cost where it is not counted.

use std::fmt;
use std::ops::{Add, Index};

/// What is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Event {
    /// An inner node was visited.
    InnerNode,
    /// A leaf was visited.
    Leaf,
    /// Boxes were tested; a test of W boxes at once counts as one.
    BoxTest,
    /// Triangles were tested; a test of W triangles at once counts as one.
    TriangleTest,
    /// Lanes of the triangle tests that held a triangle.
    TriangleLane,
    /// Triangles, after all filters, that the exact test was asked about.
    ExactTest,
    /// A node was put aside for later.
    Push,
    /// The walk began again at the root, or below it, or at the root of a placed mesh.
    Restart,
    /// A node was looked at before rays were traced: to find an entry point, or to compress paths.
    Search,
    /// Triangles were found in a cache.
    CacheHit,
    /// Triangles were fetched into a cache.
    CacheMiss,
}

impl Event {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::InnerNode,
        Self::Leaf,
        Self::BoxTest,
        Self::TriangleTest,
        Self::TriangleLane,
        Self::ExactTest,
        Self::Push,
        Self::Restart,
        Self::Search,
        Self::CacheHit,
        Self::CacheMiss,
    ];

    /// As JSON and tables name it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::InnerNode => "inner_nodes",
            Self::Leaf => "leaves",
            Self::BoxTest => "box_tests",
            Self::TriangleTest => "triangle_tests",
            Self::TriangleLane => "triangle_lanes",
            Self::ExactTest => "exact_tests",
            Self::Push => "pushes",
            Self::Restart => "restarts",
            Self::Search => "searched_nodes",
            Self::CacheHit => "cache_hits",
            Self::CacheMiss => "cache_misses",
        }
    }
}

/// Counts events, or compiles to nothing.
pub trait Counters: Default + Send {
    /// Whether it counts at all, for counts that take work to find.
    const COUNTS: bool;

    /// Counts `n` events at once.
    fn add(&mut self, event: Event, n: u64);

    /// Counts an event.
    #[inline(always)]
    fn count(&mut self, event: Event) {
        self.add(event, 1);
    }

    /// What was counted.
    fn counts(&self) -> Counts;
}

/// Counts nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NotCounted;

impl Counters for NotCounted {
    const COUNTS: bool = false;

    #[inline(always)]
    fn add(&mut self, _: Event, _: u64) {}

    fn counts(&self) -> Counts {
        Counts::default()
    }
}

/// How often each event happened.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts([u64; Event::ALL.len()]);

impl Counters for Counts {
    const COUNTS: bool = true;

    #[inline(always)]
    fn add(&mut self, event: Event, n: u64) {
        self.0[event as usize] += n;
    }

    fn counts(&self) -> Counts {
        *self
    }
}

impl Index<Event> for Counts {
    type Output = u64;

    fn index(&self, event: Event) -> &u64 {
        &self.0[event as usize]
    }
}

impl Add for Counts {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        for (a, b) in self.0.iter_mut().zip(other.0) {
            *a += b;
        }
        self
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, event) in Event::ALL.into_iter().enumerate() {
            let separator = if i == 0 { "" } else { ", " };
            write!(f, "{separator}{} {}", self[event], event.name())?;
        }
        Ok(())
    }
}
