//! Files of the outside world: outputs that are whole or not there, and inputs that end.
//!
//! | file | what it holds |
//! |---|---|
//! | `beside` | outputs are written beside their target and renamed |
//! | `regular` | inputs are regular files, of a size that is known; which paths are one file |

mod beside;
mod regular;

pub use beside::{Flush, probe, remove_pending, write};
pub use regular::{open, read, same};
