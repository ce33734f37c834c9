//! Files to scenes: glTF, OBJ, PLY and TOML, the images that they name, and arrays of NumPy.

mod choice;
mod copies;
mod environment;
mod environment_image;
mod environment_repair;
mod error;
pub mod gltf;
mod load;
mod model;
pub mod npy;
pub mod obj;
mod options;
pub mod ply;
mod read;
mod repair;
mod texture_range;
pub mod toml;
mod triangulate;
mod uri;

pub use choice::find_by_name_or_number;
pub use environment::{EnvironmentSource, NeitherColorNorFile};
pub use environment_image::EnvironmentImage;
pub use environment_repair::NotFinite;
pub use error::{Broken, LoadError};
pub use load::load;
pub use options::{LoadOptions, MissingTexture, MtlTransparency};
pub use read::read_file;
