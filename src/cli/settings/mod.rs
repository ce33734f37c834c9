//! The settings of `dapple render`: one table, from which everything about them follows.
//!
//! To add a setting, write an entry in the file of its group, give [`RenderArgs`] a field for its
//! value, and read the field where it acts. The flag, its help and its checks follow from the
//! entry. So do the key in TOML, `--print-config`, the line in a picture's header and `--from`,
//! unless its role is `Run`.
//!
//! | file | what it holds |
//! |---|---|
//! | `setting` | what an entry says |
//! | `output`, `watch`, `image`, `light`, `camera` | the entries |
//! | `long`, `input`, `speed`, `messages` | more of them |
//! | `args` | the values of all settings, typed |
//! | `parse`, `parse_long`, `parse_size`, `parse_watch` | values from words |
//! | `to_toml` | values as TOML |
//! | `table` | the entries together: defaults, rules, TOML |
//! | `command` | the entries as flags, and what was typed |
//! | `resolve`, `origin` | what was typed over what a file says: a scene, or `--from` a picture |
//! | `frames`, `pose` | frames of an animation: their numbers in names, and their times |
//! | `identity` | which settings make two pictures different ones |
//! | `markdown` | the entries as documentation |

mod args;
mod camera;
mod command;
pub mod frames;
mod identity;
mod image;
mod input;
mod light;
mod long;
mod markdown;
mod messages;
mod origin;
mod output;
pub mod parse;
pub mod parse_long;
pub mod parse_size;
pub mod parse_watch;
pub mod pose;
mod resolve;
mod setting;
mod speed;
mod table;
#[cfg(test)]
mod tests;
mod to_toml;
mod watch;

pub use args::RenderArgs;
pub use command::Typed;
pub use resolve::{Request, resolve, resolve_words};
pub use table::Table;
