//! `dapple farm`: one picture, or the frames of an animation, by many machines.
//!
//! | file | what |
//! |---|---|
//! | `slurm`, `openjd`, `shell` | a system each: its flags, and what is written for it |
//! | `plan` | what is to be done: tasks by an index from 0, and merges |
//! | `commands` | the commands of a task and of a merge, for bash |

mod commands;
mod openjd;
mod plan;
mod shell;
mod slurm;

use std::process::ExitCode;

use clap::Subcommand;

use crate::cli::error::CliError;

/// Write what a farm needs to render a picture, or frames, by many machines.
///
/// The picture is cut into parts of its samples, each the task of one machine, and the parts are
/// merged: the bytes are those of one render. The flags of `dapple render` are taken, but for those
/// that cut, save and stop, which the farm sees to. Nothing is rendered here.
#[derive(clap::Args, Debug)]
pub struct FarmArgs {
    #[command(subcommand)]
    system: System,
}

#[derive(Subcommand, Debug)]
enum System {
    Slurm(slurm::SlurmArgs),
    Openjd(openjd::OpenjdArgs),
    Shell(shell::ShellArgs),
}

/// Runs the command.
pub fn run(args: &FarmArgs) -> Result<ExitCode, CliError> {
    match &args.system {
        System::Slurm(args) => slurm::run(args),
        System::Openjd(args) => openjd::run(args),
        System::Shell(args) => shell::run(args),
    }
}
