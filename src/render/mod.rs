//! Renders a world into a picture: tiles on threads, each a stream of paths.
//!
//! | file | what it does |
//! |---|---|
//! | `start` | random numbers and camera rays of a tile's paths |
//! | `stream` | advances some thousand paths together, bounce by bounce |
//! | `tile` | a rectangle of pixels and the sums of their samples |
//! | `frame` | hands tiles to threads, pass after pass |
//! | `breakdown` | where the time goes |
//! | `aov` | makes the layers of the picture |
//! | `replay` | one path alone, described step by step |

mod aov;
mod breakdown;
mod frame;
mod replay;
mod settings;
mod start;
mod stream;
mod tile;

pub use aov::film_bytes;
pub use breakdown::{Breakdown, Stage};
pub use frame::{Control, FilmAccumulator, Progress, Rendered, render};
pub use replay::replay;
pub use settings::{Aov, Settings};
pub use stream::RayCounts;
pub use tile::LostSample;
