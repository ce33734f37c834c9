//! Values that several benches have.

use crate::accel::bvh::BUILD;
use crate::accel::{ClosestHit, Values};
use crate::math::Ray;

/// Reads a value of the option `build`.
pub fn parse_builder(text: &str) -> Result<&'static str, String> {
    let Values::Choice(words) = BUILD.values else { return Err("not a choice".to_owned()) };
    let found = words.iter().find(|&&word| word == text);
    found.copied().ok_or_else(|| format!("expected one of {}", words.join(", ")))
}

/// Bytes that `--memory` allows: so many megabytes, or three quarters of the machine's memory.
pub fn memory_limit(megabytes: u64) -> u64 {
    match megabytes {
        0 => crate::files::memory::limit() / 4 * 3,
        megabytes => megabytes.saturating_mul(1_000_000),
    }
}

/// Bytes of some sets of rays and their answers.
pub fn ray_bytes(rays: u64, sets: u64) -> u64 {
    rays * sets * (size_of::<Ray>() + size_of::<ClosestHit>()) as u64
}
