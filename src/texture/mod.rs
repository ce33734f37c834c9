//! Textures: pictures, how they are decoded from files, kept and looked up.
//!
//! | file | what it holds |
//! |---|---|
//! | `texture` | an image, its colour space, wraps and filter: the look-up |
//! | `texels`, `transfer` | values of one to four channels and three depths; what they stand for |
//! | `image` | an image, whole or in tiles |
//! | `decode`, `ktx2`, `zstandard` | images from the bytes of their files |
//! | `store` | each file decoded once, within the memory that textures may take |
//! | `tiles`, `pack`, `cache`, `ring` | images that do not fit: cut, kept, brought back by tiles |
//! | `levels` | smaller versions of images, for what is seen from afar |
//! | `range` | floats taken to what a material can do |

mod cache;
mod decode;
mod image;
mod ktx2;
mod ktx2_keys;
mod levels;
mod pack;
mod range;
mod ring;
mod store;
mod texels;
#[allow(clippy::module_inception)] // what a reader looks for
mod texture;
mod tiles;
mod transfer;
mod zstandard;

pub use cache::{CacheFigures, TileCache};
pub use decode::ImageError;
pub use image::{FileLevels, Image};
pub use levels::add_levels;
pub use range::TextureRange;
pub use store::{Decoded, ImageId, ImagePart, ImageSource, TextureFigures, TextureStore};
pub use texels::{Depth, Texels, Value, spread};
pub use texture::{Filter, Texture, Wrap};
pub use transfer::{ColorSpace, srgb_to_linear};
