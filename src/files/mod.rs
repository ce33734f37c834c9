//! Files of the outside world: outputs that are whole or not there, inputs that end, and the
//! memory that they claim.
//!
//! | file | what it holds |
//! |---|---|
//! | `beside` | outputs are written beside their target and renamed |
//! | `guard` | decoders of others that may panic |
//! | `heap` | large pieces of memory go back to the system early |
//! | `meter` | how much of reading or building is done |
//! | `memory` | how much memory there is, and whether what a file claims is left |
//! | `regular` | inputs are regular files, of a size that is known; which paths are one file |
//! | `spool` | a temporary file for what memory has no room for |

mod beside;
pub mod guard;
pub mod heap;
pub mod memory;
mod meter;
mod regular;
mod spool;

pub use beside::{Flush, probe, remove_pending, write};
pub use meter::{Front, Meter};
pub use regular::{open, read, same, why_unread};
pub use spool::Spool;
