//! The command line.
//!
//! A command is a file: its flags, and `run`. It is registered in `Command` and in `dispatch`.

mod accels;
mod bench;
mod completions;
mod diff;
mod error;
mod generate;
mod golden;
mod golden_page;
mod info;
mod input;
mod job;
mod man;
mod memory;
mod outputs;
mod progress;
mod render;
mod settings;
mod shell;
mod table;
mod trace;
mod validate;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

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
    Render(settings::Typed),
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

/// What every command's `--help` ends with.
const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 a comparison found a difference, 2 usage, 3 input missing or invalid,
4 output not written, 5 a limit such as memory, 70 a fault of dapple's, 130 and 143 interrupted,
after saving.";

/// All commands, each with the exit codes at the end of its help.
fn all_commands() -> clap::Command {
    with_exit_codes(Cli::command())
}

fn with_exit_codes(command: clap::Command) -> clap::Command {
    let help = match command.get_after_help() {
        Some(help) => format!("{help}\n\n{EXIT_CODES}"),
        None => EXIT_CODES.to_owned(),
    };
    command.after_long_help(help).mut_subcommands(with_exit_codes)
}

/// Runs the command that the process was started with.
pub fn main() -> ExitCode {
    own_up_to_panics();
    let parsed = Cli::from_arg_matches(&all_commands().get_matches());
    let parsed = parsed.unwrap_or_else(|error| error.exit());
    dispatch(parsed.command).unwrap_or_else(|error| {
        progress::say(&format!("error: {}", error::chain(&error)));
        ExitCode::from(error.exit_code())
    })
}

fn dispatch(command: Command) -> Result<ExitCode, CliError> {
    match command {
        Command::Render(typed) => render::run(&typed),
        Command::Info(args) => info::run(&args),
        Command::Diff(args) => diff::run(&args),
        Command::Golden(args) => {
            let picture = |scene: &GoldenScene| {
                render::render_picture(&scene.file, &scene.render)
                    .map_err(|error| RenderError::new(error.exit_code(), &error))
            };
            Ok(golden::run(&args, &picture)?)
        }
        Command::Accels(args) => accels::run(&args),
        Command::Trace(args) => trace::run(&args),
        Command::Validate(args) => validate::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Generate(args) => generate::run(&args),
        Command::Completions(args) => completions::run(&args, &mut all_commands()),
        Command::Man(args) => man::run(&args, all_commands()),
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

/// A flag of commands that have little to say beside their results.
#[derive(clap::Args, Clone, Copy, Debug, Default)]
struct Quiet {
    /// Says nothing but errors and results
    #[arg(short, long)]
    quiet: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Calls `check` for every command, with the words that lead to it.
    fn each(command: &clap::Command, words: &str, check: &mut dyn FnMut(&str, &clap::Command)) {
        for below in command.get_subcommands().filter(|it| it.get_name() != "help") {
            let words = format!("{words} {}", below.get_name());
            check(&words, below);
            each(below, &words, check);
        }
    }

    #[test]
    fn every_command_tells_its_exit_codes_once_and_can_be_quiet() {
        let mut all = all_commands();
        all.build();
        let mut count = 0;
        each(&all, "dapple", &mut |words, command| {
            let help = command.clone().render_long_help().to_string();
            assert_eq!(help.matches("Exit").count(), 1, "{words}: {help}");
            count += 1;
            if command.get_subcommands().next().is_none() {
                let quiet = command.get_arguments().any(|arg| arg.get_short() == Some('q'));
                assert!(quiet, "{words} has no -q");
            }
        });
        assert!(count >= 12, "{count}");
    }
}
