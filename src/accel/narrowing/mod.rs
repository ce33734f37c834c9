//! Trees narrowed to a region: entry points and path compression, whatever the tree.
//!
//! A tree is seen as a hierarchy of boxes ([`hierarchy`]). For a shaft, the deepest node that holds
//! all that the shaft meets is found ([`entry_point`]), or a tree of the few nodes that matter to
//! it is made ([`compress`]). Both are done for a slice of rays, and before that for the regions
//! that a thread has entered ([`narrow`]), which are kept in a pool ([`pool`]).

mod compress;
mod entry_point;
mod hierarchy;
mod narrow;
mod options;
mod pool;
mod within;

#[cfg(test)]
pub use compress::Compression;
pub use entry_point::find_entry_point;
pub use hierarchy::{Branches, Hierarchy, Step};
pub use narrow::{EnteredRegions, Narrowing, Start, Started};
pub use options::PC;
pub use pool::BranchPool;
pub use within::Within;
