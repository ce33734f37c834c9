//! The `dapple` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    dapple::run_command()
}
