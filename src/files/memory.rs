//! How much memory there is, and whether files may claim more of it in few bytes.

use std::fs;

/// Claims of up to this many bytes are always granted.
const FREE_BYTES: u64 = 64 << 20;

/// What is kept for all else when a claim is granted: stacks, threads, what the allocator rounds
/// up.
const SPARE_BYTES: u64 = 128 << 20;

/// Bytes that this process may have: the machine's memory, or less where the system says so
/// (`ulimit -v`, a control group); 16 GB where it says nothing.
pub fn limit() -> u64 {
    let machine = read_text("/proc/meminfo").and_then(|text| parse_kilobytes(&text, "MemTotal:"));
    let process = read_text("/proc/self/limits").and_then(|text| parse_address_space(&text));
    [machine, process, read_group("memory.max")]
        .into_iter()
        .flatten()
        .min()
        .unwrap_or(16_000_000_000)
}

/// The most memory that the process has had, where the system tells.
pub fn peak() -> Option<u64> {
    parse_kilobytes(&read_text("/proc/self/status")?, "VmHWM:")
}

/// A claim for more memory than is left.
#[derive(Clone, Copy, Debug, thiserror::Error, PartialEq, Eq)]
#[error("takes {:.1} GB of memory, {:.1} GB are left", giga(*.needed), giga(*.left))]
pub struct TooMuch {
    /// Bytes claimed.
    pub needed: u64,
    /// Bytes left.
    pub left: u64,
}

fn giga(bytes: u64) -> f64 {
    bytes as f64 * 1e-9
}

/// Asks whether so many bytes more can be had; nothing is set aside. For what a file's header
/// claims, before it is allocated: an allocation that fails ends the process.
///
/// # Errors
/// [`TooMuch`], where the system tells what is left, and it is less.
pub fn claim(bytes: u64) -> Result<(), TooMuch> {
    if bytes <= FREE_BYTES {
        return Ok(());
    }
    let left = left().saturating_sub(SPARE_BYTES);
    if bytes <= left { Ok(()) } else { Err(TooMuch { needed: bytes, left }) }
}

/// Bytes that the process may still have, by the strictest limit.
fn left() -> u64 {
    let machine =
        read_text("/proc/meminfo").and_then(|text| parse_kilobytes(&text, "MemAvailable:"));
    let process = || {
        let most = parse_address_space(&read_text("/proc/self/limits")?)?;
        Some(most.saturating_sub(parse_kilobytes(&read_text("/proc/self/status")?, "VmSize:")?))
    };
    let group = || Some(read_group("memory.max")?.saturating_sub(read_group_use()?));
    [machine, process(), group()].into_iter().flatten().min().unwrap_or(u64::MAX)
}

fn read_text(path: &str) -> Option<String> {
    fs::read_to_string(path).ok()
}

/// What the control group holds, less the files that it keeps for as long as there is room.
fn read_group_use() -> Option<u64> {
    let cached = read_text("/sys/fs/cgroup/memory.stat")?;
    let cached = cached.lines().find_map(|line| line.strip_prefix("inactive_file "))?;
    Some(read_group("memory.current")?.saturating_sub(cached.trim().parse().ok()?))
}

/// A figure of the control group that the process is in.
fn read_group(name: &str) -> Option<u64> {
    read_text(&format!("/sys/fs/cgroup/{name}"))?.trim().parse().ok()
}

/// Bytes of a line as `MemTotal:  24682496 kB`.
fn parse_kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// The soft limit of a line as `Max address space  3072000000  unlimited  bytes`.
fn parse_address_space(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_systems_words_are_understood() {
        let of = |text: &str| parse_kilobytes(text, "MemTotal:");
        assert_eq!(of("MemFree: 1 kB\nMemTotal:       24682496 kB\n"), Some(24_682_496 << 10));
        assert_eq!(of("MemTotal: much\n"), None);
        let limits = "Max file locks            unlimited            unlimited            locks\n\
                      Max address space         3145728000           unlimited            bytes\n";
        assert_eq!(parse_address_space(limits), Some(3_145_728_000));
        assert_eq!(parse_address_space(&limits.replace("3145728000", "unlimited")), None);
    }

    #[test]
    fn a_claim_beyond_what_is_left_is_refused() {
        assert_eq!(claim(FREE_BYTES), Ok(()));
        if cfg!(target_os = "linux") {
            let refused = claim(1 << 60).expect_err("there is no such machine");
            assert!(refused.left < refused.needed && refused.left <= limit());
            let start = "takes 1152921504.6 GB of memory, ";
            assert!(refused.to_string().starts_with(start), "{refused}");
        }
    }
}
