//! The command line.
//!
//! A command is a file: its flags, and `run`. It is registered in `Command` and in `dispatch`.

mod accels;
mod bench;
mod clock;
mod completions;
mod console;
mod convert;
mod denoise;
mod diff;
mod error;
mod exit_codes;
mod farm;
mod flags;
mod generate;
mod golden;
mod golden_page;
mod info;
mod input;
mod job;
mod log;
mod man;
mod memory;
mod merge;
mod outputs;
mod progress;
mod render;
mod settings;
mod shell;
mod status;
mod text;
mod trace;
mod validate;
mod watch;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

pub use error::CliError;

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
    Merge(merge::MergeArgs),
    Farm(farm::FarmArgs),
    Info(info::InfoArgs),
    Convert(convert::ConvertArgs),
    Denoise(denoise::DenoiseArgs),
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

fn dispatch(command: Command) -> Result<ExitCode, CliError> {
    match command {
        Command::Render(typed) => render::run(&typed),
        Command::Merge(args) => merge::run(&args),
        Command::Farm(args) => farm::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Convert(args) => convert::run(&args),
        Command::Denoise(args) => denoise::run(&args),
        Command::Diff(args) => diff::run(&args),
        Command::Golden(args) => golden::run(&args),
        Command::Accels(args) => accels::run(&args),
        Command::Trace(args) => trace::run(&args),
        Command::Validate(args) => validate::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Generate(args) => generate::run(&args),
        Command::Completions(args) => completions::run(&args, &mut all_commands()),
        Command::Man(args) => man::run(&args, all_commands()),
    }
}

/// Either a scene or a picture is needed, and something to write.
const RENDER_USAGE: &str = "dapple render [OPTIONS] -o <FILE> <SCENE>
       dapple render [OPTIONS] -o <FILE> --from <FILE.exr>";

/// All commands, each with the exit codes at the end of its help.
fn all_commands() -> clap::Command {
    let commands = Cli::command().mut_subcommand("render", |it| it.override_usage(RENDER_USAGE));
    exit_codes::add_to_help(commands)
}

/// Runs the command that the process was started with.
pub fn main() -> ExitCode {
    crate::files::heap::give_back_large_pieces();
    exit_codes::own_up_to_panics();
    let parsed = Cli::from_arg_matches(&all_commands().get_matches());
    let parsed = parsed.unwrap_or_else(|error| error.exit());
    dispatch(parsed.command).unwrap_or_else(|error| {
        progress::say(&format!("error: {}", error::format_chain(&error)));
        ExitCode::from(error.exit_code())
    })
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
    fn whoever_slips_in_a_number_is_told_what_is_expected() {
        let mut all = all_commands();
        all.build();
        each(&all, "dapple", &mut |words, command| {
            let with_values = command.get_arguments().filter(|it| it.get_action().takes_values());
            for flag in with_values.filter_map(clap::Arg::get_long) {
                let word = format!("--{flag}=1e5");
                let parsed = command.clone().no_binary_name(true).try_get_matches_from([word]);
                let said = parsed.err().map(|error| error.to_string()).unwrap_or_default();
                assert!(!said.contains("digit"), "{words}: --{flag}: {said}");
            }
        });
    }

    #[test]
    fn every_command_tells_its_exit_codes_once_and_can_be_quiet() {
        let mut all = all_commands();
        all.build();
        let mut count = 0;
        each(&all, "dapple", &mut |words, command| {
            let help = command.clone().render_long_help().to_string();
            assert_eq!(help.matches("Exit codes:").count(), 1, "{words}: {help}");
            count += 1;
            if command.get_subcommands().next().is_none() {
                let quiet = command.get_arguments().any(|arg| arg.get_short() == Some('q'));
                assert!(quiet, "{words} has no -q");
            }
        });
        assert!(count >= 12, "{count}");
    }
}
