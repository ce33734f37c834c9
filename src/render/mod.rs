//! Renders a world into a picture: tiles on threads, each a stream of paths.
//!
//! | file | what it does |
//! |---|---|
//! | `start` | random numbers and camera rays of a tile's paths |
//! | `trace` | what rays hit |
//! | `stream` | advances some thousand paths together, bounce by bounce |
//! | `pixel`, `tile` | the sums of a pixel's samples; a square of pixels |
//! | `passes` | the order of work |
//! | `noise`, `noise_target` | when the noise of a tile is low enough |
//! | `earlier` | what a tile remembers for that |
//! | `film`, `fair_mutex` | hands tiles to threads, pass after pass |
//! | `frame` | a whole picture in one call |
//! | `progress`, `ticks` | how far a render is, and who looks after it |
//! | `breakdown` | where the time goes |
//! | `aov`, `preview` | make the layers of the picture, and a first look at it |
//! | `rendered` | what a render gives |
//! | `look_ahead` | how much of a frame shows something, and how much of that is lit |
//! | `replay` | one path alone, described step by step |

mod aov;
mod breakdown;
mod earlier;
mod fair_mutex;
mod film;
mod frame;
mod look_ahead;
mod noise;
mod noise_target;
mod passes;
mod pixel;
mod preview;
mod progress;
mod rendered;
mod replay;
mod settings;
mod start;
mod stream;
mod ticks;
mod tile;
mod trace;

pub(crate) use aov::Layers;
pub use aov::film_bytes;
pub use breakdown::{Breakdown, Stage};
pub(crate) use earlier::Earlier;
pub use film::Film;
pub use frame::{Control, render};
pub use look_ahead::{Sight, look_ahead};
pub use noise_target::{NoiseReached, NoiseTarget};
pub use progress::Progress;
pub use rendered::Rendered;
pub use replay::replay;
pub use settings::{Aov, Settings};
pub use stream::RayCounts;
pub use ticks::with_ticks;
pub use tile::LostSample;
pub(crate) use tile::{SIDE, Tile, tile_windows};
