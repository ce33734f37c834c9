//! Pixel filters, pictures of named channels, their files, and how two pictures are compared.
//!
//! | file | what it holds |
//! |---|---|
//! | [`filter`] | where in and around its pixel a sample falls |
//! | [`picture`] | frame, crop and float channels by name |
//! | [`exr`], [`png`] | the two file formats that are written |
//! | [`radiance`] | one that is only read |
//! | [`primaries`] | what red, green and blue stand for in a file |
//! | [`tonemap`] | linear light to display values: AgX or clamped sRGB |
//! | [`compare`] | all figures about two pictures; built of [`metrics`], [`flip`] and [`ztest`] |
//! | [`golden`] | a folder of pictures that renders are held against |

pub mod compare;
mod error;
pub mod exr;
mod files;
pub mod filter;
pub mod flip;
pub mod golden;
pub mod metrics;
pub mod picture;
pub mod png;
pub mod png_label;
pub mod primaries;
pub mod radiance;
pub mod tonemap;
pub mod ztest;

pub use compare::Comparison;
pub use error::FilmError;
pub use exr::read_rgb;
pub use files::diff;
pub use filter::PixelFilter;
pub use picture::{Channel, Picture, Window};
pub use tonemap::Tonemap;
