//! Pictures in the terminal.
//!
//! | file | what it holds |
//! |---|---|
//! | `detect` | which way of showing pictures a terminal has |
//! | `thumbnail` | a picture at the size of the terminal |
//! | `kitty`, `iterm`, `sixel`, `blocks` | the ways, each a thumbnail as bytes for the terminal |
//! | `screen` | draws in place |

mod blocks;
mod detect;
mod iterm;
mod kitty;
mod screen;
mod sixel;
mod thumbnail;

pub use detect::{Found, detect};
pub use screen::Screen;
