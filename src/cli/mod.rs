//! The command line.
//!
//! A command is a file: its flags, and `run`. It is registered in `Command` and in `dispatch`.

mod accels;
mod args;
mod bench;
mod completions;
mod diff;
mod error;
mod generate;
mod golden;
mod header;
mod info;
mod input;
mod man;
mod memory;
mod outputs;
mod prepare;
mod progress;
mod render;
mod shell;
mod table;
mod trace;
mod validate;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

pub use error::CliError;

use crate::film::golden::{GoldenScene, RenderError};

/// Exit code of a bug of ours (`EX_SOFTWARE` of sysexits.h).
const OUR_BUG: i32 = 70;

#[derive(Parser)]
#[command(version, about, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

// The order is that of the help.
#[derive(Subcommand)]
enum Command {
    Render(Box<args::RenderArgs>),
    Info(info::InfoArgs),
    Diff(diff::DiffArgs),
    Golden(golden::GoldenArgs),
    Accels(accels::AccelsArgs),
    Trace(trace::TraceArgs),
    Validate(validate::ValidateArgs),
    Bench(bench::BenchArgs),
    Generate(generate::GenerateArgs),
    Completions(completions::CompletionsArgs),
    Man(man::ManArgs),
}

/// Runs the command that the process was started with.
pub fn main() -> ExitCode {
    own_up_to_panics();
    dispatch(Cli::parse().command).unwrap_or_else(|error| {
        progress::say(&format!("error: {}", error::chain(&error)));
        ExitCode::from(error.exit_code())
    })
}

fn dispatch(command: Command) -> Result<ExitCode, CliError> {
    match command {
        Command::Render(args) => render::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Diff(args) => diff::run(&args),
        Command::Golden(args) => {
            let picture = |scene: &GoldenScene| {
                render::picture(&scene.file, &scene.render)
                    .map_err(|error| RenderError::new(error.exit_code(), &error))
            };
            Ok(golden::run(&args, &picture)?)
        }
        Command::Accels(args) => accels::run(&args),
        Command::Trace(args) => trace::run(&args),
        Command::Validate(args) => validate::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Generate(args) => generate::run(&args),
        Command::Completions(args) => completions::run(&args, &mut Cli::command()),
        Command::Man(args) => man::run(&args, Cli::command()),
    }
}

/// A panic is a bug of ours: it says so and ends the process, on whatever thread it happens.
/// Files that are being written are not yet in their place, and go.
fn own_up_to_panics() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        report(panic);
        progress::say("error: this is a bug in dapple; please report it with the lines above");
        crate::files::remove_pending();
        std::process::exit(OUR_BUG);
    }));
}
