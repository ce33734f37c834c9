//! A binary hierarchy for many rays at a time.

use super::place::{Place, Places};
use super::walk::PacketWalk;
use crate::accel::bvh::binary::{self, Bvh2};
use crate::accel::narrowing::{BranchPool, Narrowing, Start, Step};
use crate::accel::packet::RayLists;
use crate::accel::{
    BuildError, BuildInput, Built, MemoryReport, OptionSpec, Structure, Value, Values,
};
use crate::math::Ray;

/// What walks below the entry point or the compressed tree.
pub const WITH: OptionSpec = OptionSpec {
    name: "with",
    summary: "packets that go down early, as bvh-packet's, or are partitioned, as bvh-partition's, \
              or rays one by one",
    values: Values::Choice(&["packet", "partition", "single"]),
    default: Value::Choice("packet"),
};

/// Whether packets have trees of their own.
pub const PER_PACKET: OptionSpec = OptionSpec {
    name: "per-packet",
    summary: "whether paths are compressed for each packet once more, which then asks no shaft",
    values: Values::Choice(&["off", "on"]),
    default: Value::Choice("off"),
};

/// A binary hierarchy for many rays.
pub struct PacketBvh {
    /// The hierarchy.
    pub bvh: Bvh2,
    /// Rays of a packet at most.
    pub size: usize,
    /// What walks.
    pub with: With,
    /// Where walks start.
    pub start: Start,
}

/// What walks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum With {
    /// Packets that go down early.
    Packet,
    /// Packets that are partitioned at each node.
    Partition,
    /// Rays one by one.
    Single,
}

impl With {
    /// Reads the option [`WITH`].
    pub fn new(input: &BuildInput<'_>) -> Self {
        match input.options.choice("with") {
            "partition" => Self::Partition,
            "single" => Self::Single,
            _ => Self::Packet,
        }
    }
}

/// Scratch of one thread.
pub struct Scratch {
    /// For rays that walk one by one.
    pub single: binary::Scratch,
    /// For the packet at hand.
    pub packet: PacketWalk,
    /// Lists of rays.
    pub lists: RayLists,
    /// Trees of the regions that were entered, of the slice and of the packet at hand.
    pub pool: BranchPool<Place>,
    /// Steps put aside by a ray that walks alone, and where it enters them.
    pub steps: Vec<(Step<Place>, f32)>,
}

impl PacketBvh {
    /// Builds the hierarchy of `bvh2`.
    pub fn build(input: &BuildInput<'_>, start: Start, with: With) -> Result<Self, BuildError> {
        let side = input.options.integer("size") as usize;
        Ok(Self { bvh: Bvh2::build(input)?, size: side * side, with, start })
    }

    /// How the hierarchy is narrowed; `None` without triangles.
    pub fn narrowing(&self) -> Option<Narrowing<Places<'_>>> {
        let tree = self.bvh.root.map(|root| Places { bvh: &self.bvh, root })?;
        Some(Narrowing { tree, root: Place::ROOT, start: self.start })
    }

    /// Whether packets have trees of their own.
    pub fn is_per_packet(&self) -> bool {
        matches!(self.start, Start::Compressed { per_packet: true, .. })
    }

    /// Whether the boxes are good for a ray.
    #[inline(always)]
    pub fn accepts(&self, ray: &Ray) -> bool {
        self.bvh.parts.is_none_or(|parts| parts.covers(ray))
    }
}

impl Structure for PacketBvh {
    type Scratch = Scratch;

    fn scratch(&self) -> Scratch {
        Scratch {
            single: self.bvh.scratch(),
            packet: PacketWalk::new(),
            lists: RayLists::default(),
            pool: BranchPool::default(),
            steps: Vec::new(),
        }
    }

    fn built(&self) -> &Built {
        self.bvh.built()
    }

    fn memory(&self) -> MemoryReport {
        Structure::memory(&self.bvh)
    }
}
