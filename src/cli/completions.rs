//! `dapple completions`: what the shell's tab key needs to know.

use std::process::ExitCode;

use clap_complete::Shell;

use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::text;

/// Print a script that completes dapple's commands and flags in a shell.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple completions bash > ~/.local/share/bash-completion/completions/dapple
  dapple completions fish > ~/.config/fish/completions/dapple.fish")]
pub struct CompletionsArgs {
    /// The shell
    shell: Shell,
    #[command(flatten)]
    quiet: Quiet,
}

/// Prints the script for `command`.
pub fn run(args: &CompletionsArgs, command: &mut clap::Command) -> Result<ExitCode, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, command, "dapple", &mut script);
    text::print(&String::from_utf8_lossy(&script))?;
    Ok(ExitCode::SUCCESS)
}
