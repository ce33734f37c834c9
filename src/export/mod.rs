//! Scenes written as plain binary glTF 2.0: what was understood of any file, with no compression,
//! quantisation or copies by extension left.
//!
//! | file | what is in it |
//! |---|---|
//! | `scene` | meshes and where they are placed, lights |
//! | `camera` | cameras and their planes |
//! | `material` | materials, with the extensions that tell how they answer to light |
//! | `image` | textures and their images, as PNG |
//! | `baked` | images that are made for what glTF has no texture for |
//! | `object` | what objects have in common |
//! | `binary` | the document and what lies behind it |

mod baked;
mod binary;
mod camera;
mod image;
mod material;
mod object;
mod scene;

pub use scene::{Exported, write};
