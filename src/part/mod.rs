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
//! | `planes` | numbers as bytes |
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
mod planes;
#[cfg(test)]
mod tests;
mod tile_codec;

pub use error::{Difference, PartError, list as list_differences};
pub use file::{EncodedTile, Part, PartWriter, is_part};
pub use head::Head;
pub use merge::Merge;
pub use plan::Gap;

/// Reads the bytes of a part, or else of one tile of it, whatever they are: for `cargo fuzz`.
#[doc(hidden)]
pub fn read_any(bytes: &[u8]) {
    let (path, length) = (std::path::Path::new("a.part"), bytes.len() as u64);
    if let Ok(part) = Part::read_from(path, std::io::Cursor::new(bytes.to_vec()), length) {
        let _ = part.verify();
    }
    let window = crate::film::Window::of_size(3, 2);
    let _ = tile_codec::decode(window, bytes);
}
