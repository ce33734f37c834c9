//! What every command's help says of exit codes, and what a panic ends with.

use clap::Command;

use crate::cli::progress;

/// Exit code of a bug of ours (`EX_SOFTWARE` of sysexits.h).
const OUR_BUG: i32 = 70;

/// What every command's `--help` ends with.
const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 a comparison found a difference, 2 usage, 3 input missing or invalid,
4 output not written, 5 a limit such as memory, 70 a fault of dapple's, 75 stopped after saving:
start it again, 130 and 143 interrupted, after saving.";

/// Adds the exit codes to the end of a command's help, and of those below it.
pub fn add_to_help(command: Command) -> Command {
    let help = match command.get_after_help() {
        Some(help) => format!("{help}\n\n{EXIT_CODES}"),
        None => EXIT_CODES.to_owned(),
    };
    command.after_long_help(help).mut_subcommands(add_to_help)
}

/// Makes a panic, on whatever thread it happens, say that it is a bug of ours and end the process.
/// Files that are being written are not yet in their place, and go.
pub fn own_up_to_panics() {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if crate::files::guard::is_guarded() {
            return; // it becomes an error
        }
        report(panic);
        progress::say("error: this is a bug in dapple; please report it with the lines above");
        crate::files::remove_pending();
        std::process::exit(OUR_BUG);
    }));
}
