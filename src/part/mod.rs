//! Parts of pictures: the sums of some samples of some pixels, as files, and how they add up.
//!
//! A part is what a render has summed up, bit by bit: whole subtrees of the tree of sums
//! ([`crate::sampling::BlockSums`]). Parts of one picture are added up as one render would have, so
//! the picture has the same bytes. A checkpoint is a part, too.
//!
//! | file | what it holds |
//! |---|---|
//! | `head` | what the samples belong to |
//! | `container` | chunks with checksums |
//! | `tile_codec` | a tile as bytes |
//! | `file` | writes a part, and reads it |
//! | `plan` | which tiles of which parts make each tile of a picture, and what is missing |
//! | `merge` | adds up tiles |
//! | `error` | what can be wrong |

mod container;
mod error;
mod file;
mod head;
mod merge;
mod plan;
mod tile_codec;

pub use error::{Difference, PartError};
pub use file::{Part, PartWriter, is_part};
pub use head::Head;
pub use merge::Merge;
pub use plan::Gap;
