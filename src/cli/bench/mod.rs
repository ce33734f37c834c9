//! `dapple bench`: structures measured side by side.
//!
//! | file | what |
//! |---|---|
//! | [`accels`], [`coherent`], [`kd`], [`mbvh`], [`render`] | a command each: its flags, and `run` |
//! | [`scenes`] | their scenes: files, or scenes made on the spot |
//! | [`output`] | where the tables, plots and figures go |

mod accels;
mod coherent;
mod kd;
mod mbvh;
mod output;
mod render;
mod scenes;

use std::process::ExitCode;

use clap::Subcommand;

use super::CliError;
use crate::accel::bvh::BUILD;
use crate::accel::{ClosestHit, Values};
use crate::bench::measure::BenchError;
use crate::math::Ray;

/// Measure structures side by side; all answers are compared first.
#[derive(clap::Args, Debug)]
pub struct BenchArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand, Debug)]
enum What {
    Accels(accels::BenchAccelsArgs),
    Coherent(coherent::CoherentArgs),
    Kd(kd::KdArgs),
    Mbvh(mbvh::MbvhArgs),
    Render(render::BenchRenderArgs),
}

/// Runs the command; exit 1 if structures disagree.
pub fn run(args: &BenchArgs) -> Result<ExitCode, CliError> {
    match &args.what {
        What::Accels(args) => accels::run(args)?,
        What::Coherent(args) => coherent::run(args)?,
        What::Kd(args) => kd::run(args)?,
        What::Mbvh(args) => mbvh::run(args)?,
        What::Render(args) => render::run(args)?,
    }
    Ok(ExitCode::SUCCESS)
}

impl From<BenchError> for CliError {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Build(error) => Self::Build(error),
            wrong => Self::Differs(wrong.to_string()),
        }
    }
}

/// A value of the option `build`.
fn builder(text: &str) -> Result<&'static str, String> {
    let Values::Choice(words) = BUILD.values else { return Err("not a choice".to_owned()) };
    let found = words.iter().find(|&&word| word == text);
    found.copied().ok_or_else(|| format!("expected one of {}", words.join(", ")))
}

/// Bytes that `--memory` allows: so many megabytes, or three quarters of the machine's memory.
fn memory_limit(megabytes: u64) -> u64 {
    match megabytes {
        0 => crate::files::memory::limit() / 4 * 3,
        megabytes => megabytes.saturating_mul(1_000_000),
    }
}

/// Bytes of some sets of rays and their answers.
fn ray_bytes(rays: u64, sets: u64) -> u64 {
    rays * sets * (size_of::<Ray>() + size_of::<ClosestHit>()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disagreement_is_a_difference() {
        let wrong = BenchError::Disagrees {
            spec: "kd-ropes".to_owned(),
            first: "kd-stack-direction".to_owned(),
            rays: 1,
            count: 10,
            set: "random",
        };
        assert_eq!(CliError::from(wrong).exit_code(), 1);
    }
}
