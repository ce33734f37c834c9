//! `dapple bench`: structures measured side by side.
//!
//! | file | what |
//! |---|---|
//! | `accels`, `coherent`, `kd`, `mbvh`, `render` | a command each: its flags, and `run` |
//! | `results` | a command that reads, checks and shows what they wrote |
//! | `scenes` | their scenes: files, or scenes made on the spot |
//! | `options` | values that several of them have |
//! | `output` | where the tables, plots and figures go |
//! | `provenance` | program, commit and processor that figures come from |

mod accels;
mod coherent;
mod kd;
mod mbvh;
mod options;
mod output;
mod provenance;
mod render;
mod results;
mod scenes;

use std::process::ExitCode;

use clap::Subcommand;

use crate::cli::error::CliError;

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
    Results(results::BenchResultsArgs),
}

/// Runs the command; exit 1 if structures disagree, or committed figures with today's.
pub fn run(args: &BenchArgs) -> Result<ExitCode, CliError> {
    match &args.what {
        What::Accels(args) => accels::run(args)?,
        What::Coherent(args) => coherent::run(args)?,
        What::Kd(args) => kd::run(args)?,
        What::Mbvh(args) => mbvh::run(args)?,
        What::Render(args) => render::run(args)?,
        What::Results(args) => return results::run(args),
    }
    Ok(ExitCode::SUCCESS)
}
