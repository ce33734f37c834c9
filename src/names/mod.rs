//! Things that users name: choices by name, and the near names for who slips.

mod choice;
mod near;

pub use choice::UnknownName;
pub(crate) use choice::choices;
pub use near::near;
