//! Things that users name: choices by name, and the near names for who slips.

mod bytes;
mod choice;
mod near;

pub use bytes::parse_bytes;
pub use choice::UnknownName;
pub(crate) use choice::choices;
pub use near::near;
