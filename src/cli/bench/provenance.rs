//! Where the figures of a bench come from: program, commit, processor, command.

use std::fs;
use std::num::NonZero;
use std::thread;

use serde_json::{Value, json};

use crate::cli::shell;

/// The commit that the program was built from, where its build was told:
/// `DAPPLE_COMMIT=$(git rev-parse --short HEAD) cargo build --release`.
pub const COMMIT: Option<&str> = option_env!("DAPPLE_COMMIT");

/// What the JSON of all benches says under `measured`.
pub fn to_json() -> Value {
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "commit": COMMIT,
        "processor": processor(),
        "cores": thread::available_parallelism().map_or(1, NonZero::get),
        "command": shell::join(std::iter::once("dapple".to_owned()).chain(shell::own_words())),
    })
}

/// A line for people.
pub fn to_text() -> String {
    let commit = COMMIT.map(|commit| format!(" ({commit})")).unwrap_or_default();
    let version = env!("CARGO_PKG_VERSION");
    format!("Measured by dapple {version}{commit} on {}.", processor())
}

/// The processor's name where the system tells it, else its architecture.
pub fn processor() -> String {
    let told = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    find_model(&told).unwrap_or(std::env::consts::ARCH).to_owned()
}

/// The first `model name` of Linux's list of processors.
fn find_model(cpuinfo: &str) -> Option<&str> {
    let named = cpuinfo.lines().filter_map(|line| line.split_once(':'));
    let mut models = named.filter(|(key, _)| key.trim() == "model name");
    models.next().map(|(_, model)| model.trim()).filter(|model| !model.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_model_is_the_processor() {
        let list = "processor\t: 0\nmodel name\t: Some CPU 9\n\nprocessor\t: 1\nmodel name\t: B\n";
        assert_eq!(find_model(list), Some("Some CPU 9"));
        assert_eq!(find_model("model name\t:\n"), None);
        assert_eq!(find_model(""), None);
    }
}
