//! `dapple bench`: structures measured side by side.
//!
//! | file | what |
//! |---|---|
//! | [`kd`], [`mbvh`], [`render`] | a command each: its flags, and `run` |
//! | [`scenes`] | the scenes of the latter two: files, or machines made on the spot |
//! | [`output`] | where the tables, plots and figures go |

mod kd;
mod mbvh;
mod output;
mod render;
mod scenes;

use std::fs;
use std::process::ExitCode;

use clap::Subcommand;

use super::CliError;
use super::progress::say;
use crate::accel::BuildError;
use crate::bench::measure::BenchError;

/// Measure structures side by side; all answers are compared first.
#[derive(clap::Args, Debug)]
pub struct BenchArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand, Debug)]
enum What {
    Kd(kd::KdArgs),
    Mbvh(mbvh::MbvhArgs),
    Render(render::BenchRenderArgs),
}

/// Why there are no figures.
#[derive(Debug, thiserror::Error)]
enum Failed {
    #[error(transparent)]
    Command(#[from] CliError),
    #[error(transparent)]
    Bench(#[from] BenchError),
}

impl From<BuildError> for Failed {
    fn from(error: BuildError) -> Self {
        Self::Command(error.into())
    }
}

/// Runs the command; exit 1 if structures disagree.
pub fn run(args: &BenchArgs) -> Result<ExitCode, CliError> {
    let done = match &args.what {
        What::Kd(args) => kd::run(args),
        What::Mbvh(args) => mbvh::run(args),
        What::Render(args) => render::run(args),
    };
    match done {
        Ok(()) => Ok(ExitCode::SUCCESS),
        Err(Failed::Command(error)) => Err(error),
        Err(Failed::Bench(BenchError::Build(error))) => Err(error.into()),
        Err(Failed::Bench(wrong)) => {
            say(&format!("error: {wrong}"));
            Ok(ExitCode::from(1))
        }
    }
}

/// Bytes that `--memory` allows: so many megabytes, or three quarters of the machine's memory.
fn memory_limit(megabytes: u64) -> u64 {
    match megabytes {
        0 => machine_memory() / 4 * 3,
        megabytes => megabytes.saturating_mul(1_000_000),
    }
}

/// Bytes of memory, or 16 GB where the system does not say.
fn machine_memory() -> u64 {
    let total = fs::read_to_string("/proc/meminfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("MemTotal:"))?;
        line.split_whitespace().nth(1)?.parse::<u64>().ok()
    });
    total.map_or(16_000_000_000, |kilobytes| kilobytes * 1024)
}
