//! `dapple render`: a scene in, a picture out.
//!
//! | file | what it does |
//! |---|---|
//! | `run` | the command, and the same without files for `dapple golden` |
//! | `expose` | builds and renders |
//! | `publish` | writes the outputs |
//! | `report` | says what a render took |
//! | `header` | writes into the picture how it was made |
//! | `dry_run` | estimates what a render would take |
//! | `checkpoint` | parts and checkpoints: sums to files and back |
//! | `signals`, `listen` | what a render is told from outside |
//! | `done` | whether all is there already |
//! | `frames` | the frames of an animation, a render each |

mod checkpoint;
mod done;
mod dry_run;
mod expose;
mod frames;
mod header;
mod listen;
mod publish;
mod report;
mod run;
mod signals;

pub use header::Header;
pub use run::{render_picture, run};
