//! The viewer tev, to which pictures go over the network.
//!
//! | file | what it holds |
//! |---|---|
//! | `packet` | the packets of its protocol |
//! | `link` | the connection, and what goes over it |

mod link;
mod packet;

pub use link::Link;
