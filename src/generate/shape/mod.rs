//! Shapes that can be tessellated as finely as there are triangles for them.
//!
//! Axes of symmetry are +Y. A shape is a description and nothing more; its triangles are made when
//! they are written, and made again to the same bits whenever they are asked for.

mod bolt;
mod detail;
mod honeycomb;
mod path;
mod plate;
mod profile;
mod quad;
mod revolve;
mod ribbon;
mod rock;
mod rounded_box;
#[allow(clippy::module_inception)] // what a reader looks for
mod shape;
mod shell;
mod terrain;
#[cfg(test)]
mod tests;
mod thread;
mod tube;

pub use bolt::Bolt;
pub use honeycomb::Honeycomb;
pub use path::Path;
pub use plate::{Bore, Plate};
pub use profile::Profile;
pub use quad::Quad;
pub use revolve::Revolve;
pub use ribbon::Ribbon;
pub use rock::{Foliage, Rock};
pub use rounded_box::RoundedBox;
pub use shape::Shape;
pub use shell::Shell;
pub use terrain::Terrain;
pub use thread::Thread;
pub use tube::Tube;
