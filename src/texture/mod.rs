//! Textures: pictures, how they are decoded from files and how they are looked up.

mod decode;
mod image;
mod ktx2;
mod range;
#[allow(clippy::module_inception)] // what a reader looks for
mod texture;
mod zstandard;

pub use decode::ImageError;
pub use image::{Image, Texels};
pub use range::TextureRange;
pub use texture::{ColorSpace, Filter, Texture, Wrap, srgb_to_linear};
