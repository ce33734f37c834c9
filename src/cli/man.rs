//! `dapple man`: manual pages.

use std::process::ExitCode;

use clap_mangen::Man;

use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::settings::Table;
use crate::cli::text;

/// Print the manual page of dapple, or of one of its commands.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple man > dapple.1
  dapple man render > dapple-render.1
  dapple man bench kd | man -l -
  dapple man --settings > settings.md")]
pub struct ManArgs {
    /// The command, and the command of that
    #[arg(value_name = "COMMAND")]
    words: Vec<String>,
    /// Print the settings of `render` as Markdown tables instead
    #[arg(long, conflicts_with = "words")]
    settings: bool,
    #[command(flatten)]
    quiet: Quiet,
}

/// Prints the page of `command`, or of that below it which the words name.
pub fn run(args: &ManArgs, command: clap::Command) -> Result<ExitCode, CliError> {
    if args.settings {
        text::print(&Table::default().to_markdown())?;
        return Ok(ExitCode::SUCCESS);
    }
    let mut named = command;
    // Names the commands below by the words that lead there.
    named.build();
    for word in &args.words {
        named = named.find_subcommand(word).cloned().ok_or_else(|| {
            CliError::Usage(format!("there is no command `{}`", args.words.join(" ")))
        })?;
    }
    let mut page = Vec::new();
    // Writing to memory cannot fail.
    let source = concat!("dapple ", env!("CARGO_PKG_VERSION"));
    let _ = Man::new(named).source(source).render(&mut page);
    text::print(&String::from_utf8_lossy(&page))?;
    Ok(ExitCode::SUCCESS)
}
