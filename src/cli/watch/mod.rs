//! Who watches a render while it grows, and hears of its end.
//!
//! | file | what it holds |
//! |---|---|
//! | `watcher` | all that watch a run, for those who run it |
//! | `due` | when what is done every so often is to be done again |
//! | `outlet` | who gets a picture now and then |
//! | `courier` | a thread that takes parcels, so that whoever gives them never waits |
//! | `preview` | a PNG of what there is so far |
//! | `show` | pictures in the terminal |
//! | `tev` | pictures in the viewer tev |
//! | `metrics` | figures for Prometheus |
//!
//! The log and the lines of progress are beside this folder: other commands print, too.

mod courier;
mod due;
mod metrics;
mod outlet;
mod preview;
mod show;
mod tev;
mod watcher;

pub use watcher::{Watch, outputs};
