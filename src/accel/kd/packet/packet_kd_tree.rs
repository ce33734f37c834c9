//! A kd-tree for many rays at a time.

use fearless_simd::Level;

use super::cells::{Cell, Cells};
use super::leaf::Tested;
use super::spans::Spans;
use super::{front_to_back, mixed, rope_walk};
use crate::accel::kd::layout::{Compact, Nodes};
use crate::accel::kd::ropes::PacketRopes;
use crate::accel::kd::tree::KdTree;
use crate::accel::kd::walk::Walked;
use crate::accel::kd::walk::front_to_back::{ByDirection, FrontToBack};
use crate::accel::kd::walk::todo::Full;
use crate::accel::narrowing::{BranchPool, Narrowing, Start};
use crate::accel::packet::RayLists;
use crate::accel::{BuildError, Built, MemoryReport, Structure};
use crate::math::Ray;

/// The walk of a single ray.
pub type Single = Walked<FrontToBack<Compact, ByDirection, Full>>;

/// Algorithm packets walk.
pub enum Algorithm {
    /// Together from the root.
    Packet,
    /// By ropes.
    Ropes(PacketRopes),
    /// Whichever way their rays go.
    Mixed {
        /// Whether near children are told by the origin.
        by_origin: bool,
    },
    /// Behind their corners.
    Sequence {
        /// Whether triangles are culled by them.
        culls: bool,
    },
    /// From entry points of tiles.
    EntryPoint {
        /// Whether tiles are divided.
        adaptive: bool,
    },
    /// In a compressed tree.
    Compressed {
        /// Built by recursion.
        recursive: bool,
    },
}

/// A kd-tree for many rays.
pub struct PacketKdTree {
    /// The tree, and the walk of a single ray through it.
    pub single: Single,
    /// How packets walk.
    pub algorithm: Algorithm,
    /// Rays of a packet at most.
    pub size: usize,
}

/// Scratch of one thread.
pub struct Scratch {
    /// For rays that walk one by one.
    pub single: <Single as Structure>::Scratch,
    /// Lists of rays.
    pub lists: RayLists,
    /// For the packet at hand.
    pub walks: Walks,
    /// Trees of the regions that were entered and of the slice at hand.
    pub pool: BranchPool<Cell>,
}

/// What walks of packets need.
#[derive(Default)]
pub struct Walks {
    /// Where the rays are.
    pub spans: Spans,
    /// For walks front to back.
    pub todo: front_to_back::Todo,
    /// For walks of rays that go any way.
    pub mixed: mixed::Todo,
    /// For walks by ropes.
    pub waiting: rope_walk::Waiting,
    /// Which triangles were tested lately.
    pub tested: Tested,
}

impl PacketKdTree {
    /// Packets of so many rays along a side through a tree.
    ///
    /// # Errors
    /// If the tree is too deep.
    pub fn new(
        tree: &KdTree,
        algorithm: Algorithm,
        side: u64,
        level: Level,
    ) -> Result<Self, BuildError> {
        let single = Walked::new(tree, FrontToBack::new(tree, 0)?, level);
        Ok(Self { single, algorithm, size: (side * side) as usize })
    }

    /// The nodes.
    pub fn nodes(&self) -> &Compact {
        self.single.way().layout()
    }

    /// How the tree is narrowed.
    pub fn narrowing(&self) -> Narrowing<Cells<'_>> {
        let start = match self.algorithm {
            Algorithm::EntryPoint { .. } => Start::EntryPoint,
            Algorithm::Compressed { recursive } => {
                Start::Compressed { recursive, per_packet: false }
            }
            _ => Start::Root,
        };
        let nodes = self.nodes();
        let root = Cell { node: nodes.root(), bounds: self.single.base().bounds };
        Narrowing { tree: Cells(nodes), root, start }
    }

    /// Whether a ray may be walked with others.
    #[inline(always)]
    pub fn accepts(&self, ray: &Ray) -> bool {
        self.single.base().slack.is_tame(ray)
    }
}

impl Structure for PacketKdTree {
    type Scratch = Scratch;

    fn scratch(&self) -> Scratch {
        Scratch {
            single: self.single.scratch(),
            lists: RayLists::default(),
            walks: Walks::default(),
            pool: BranchPool::default(),
        }
    }

    fn built(&self) -> &Built {
        self.single.built()
    }

    fn memory(&self) -> MemoryReport {
        let mut memory = Structure::memory(&self.single);
        if let Algorithm::Ropes(ropes) = &self.algorithm {
            memory.parts.extend(ropes.memory());
        }
        memory
    }
}
