//! What fills space and scatters light: even media, their phase function, and how far light flies
//! in them.
//!
//! | file | what it holds |
//! |---|---|
//! | `medium` | how much light an even medium takes away and scatters |
//! | `albedo` | the albedo of one scattering from that of all of them |
//! | `phase` | the directions that light is scattered to: Henyey and Greenstein's |
//! | `free_flight` | the distance to the next scattering, for three colours at once |

mod albedo;
mod free_flight;
#[allow(clippy::module_inception)] // what a reader looks for
mod medium;
mod phase;

pub use albedo::single_scattering_albedo;
pub use free_flight::{FreeFlight, Leg};
pub use medium::Medium;
pub use phase::HenyeyGreenstein;
