//! Farms for real: the bytes of many machines are those of one.
//!
//! Tests by a shell run everywhere. Those that bring up Slurm (`slurm`) or need the command
//! `openjd` (`openjd`) are run by `.ci/run`, or by hand:
//!
//! ```sh
//! DAPPLE_TEST_SLURM=1 cargo test --release --test farm -- --ignored slurm
//! DAPPLE_TEST_OPENJD=1 cargo test --release --test farm -- --ignored openjd
//! ```
#![cfg(unix)]

mod openjd;
mod place;
mod shell;
mod slurm;
mod slurm_up;
