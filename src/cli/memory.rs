//! How much memory there is, and what would need more.

use std::fs;

use super::CliError;

/// Bytes that this process may have: the machine's memory, or less where the system says so
/// (`ulimit -v`, a control group); 16 GB where it says nothing.
pub fn limit() -> u64 {
    let read = |path: &str| fs::read_to_string(path).ok();
    let machine = read("/proc/meminfo").and_then(|text| total(&text));
    let process = read("/proc/self/limits").and_then(|text| address_space(&text));
    let group = read("/sys/fs/cgroup/memory.max").and_then(|text| text.trim().parse().ok());
    [machine, process, group].into_iter().flatten().min().unwrap_or(16_000_000_000)
}

/// Refuses what would need more than there is; `what` is for the message, as in `a frame of 8x8`.
///
/// # Errors
/// [`CliError::Limit`] with both figures.
pub fn require(what: &str, needed: u64) -> Result<(), CliError> {
    let limit = limit();
    if needed <= limit {
        return Ok(());
    }
    let giga = |bytes: u64| bytes as f64 * 1e-9;
    let (needed, limit) = (giga(needed), giga(limit));
    Err(CliError::Limit(format!("{what} needs {needed:.1} GB of memory, there are {limit:.1} GB")))
}

/// The most memory that the process has had, where the system tells.
pub fn peak() -> Option<u64> {
    kilobytes(&fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

fn total(meminfo: &str) -> Option<u64> {
    kilobytes(meminfo, "MemTotal:")
}

/// Bytes of a line as `MemTotal:  24682496 kB`.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// The soft limit of a line as `Max address space  3072000000  unlimited  bytes`.
fn address_space(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_systems_words_are_understood() {
        assert_eq!(total("MemFree: 1 kB\nMemTotal:       24682496 kB\n"), Some(24_682_496 << 10));
        assert_eq!(total("MemTotal: much\n"), None);
        let limits = "Max file locks            unlimited            unlimited            locks\n\
                      Max address space         3145728000           unlimited            bytes\n";
        assert_eq!(address_space(limits), Some(3_145_728_000));
        assert_eq!(address_space(&limits.replace("3145728000", "unlimited")), None);
    }

    #[test]
    fn what_does_not_fit_is_refused_with_the_figure() {
        assert!(require("a pixel", 400).is_ok());
        let error = require("a frame of 9x9", 1 << 60).expect_err("there is no such machine");
        assert_eq!(error.exit_code(), 5);
        let start = "a frame of 9x9 needs 1152921504.6 GB of memory, there are ";
        assert!(error.to_string().starts_with(start), "{error}");
    }
}
