//! The `dapple` command: see [`dapple::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    dapple::cli::main()
}
