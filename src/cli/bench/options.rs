//! Flags and values that several benches have.

use crate::accel::bvh::BUILD;
use crate::accel::{BuildError, ClosestHit, Values};
use crate::cli::settings::parse_size::size;
use crate::files;
use crate::math::Ray;
use crate::simd::Isa;

/// What a bench uses of the machine.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct MachineArgs {
    /// The instruction set
    #[arg(long, default_value_t)]
    isa: Isa,
    /// What rays and structures may take: 4GB, 512MiB, or a number of megabytes [default: three
    /// quarters of the machine's memory]
    #[arg(long, value_name = "SIZE", value_parser = memory)]
    memory: Option<u64>,
}

impl MachineArgs {
    /// The instruction set.
    ///
    /// # Errors
    /// If the machine lacks it.
    pub fn isa(self) -> Result<Isa, BuildError> {
        let found = self.isa.level().map(|_| self.isa);
        found.ok_or(BuildError::NoSuchIsa { isa: self.isa.name() })
    }

    /// The most bytes that rays and structures may take.
    pub fn memory_limit(self) -> u64 {
        match self.memory {
            None | Some(0) => files::memory::limit() / 4 * 3,
            Some(bytes) => bytes,
        }
    }
}

/// A size in bytes; a number alone is megabytes, and 0 as if nothing was said.
fn memory(text: &str) -> Result<u64, String> {
    match text.parse::<u64>() {
        Ok(megabytes) => Ok(megabytes.saturating_mul(1_000_000)),
        Err(_) => size(text).map_err(|error| format!("{error}, or a number of megabytes")),
    }
}

/// Reads a value of the option `build`.
pub fn parse_builder(text: &str) -> Result<&'static str, String> {
    let Values::Choice(words) = BUILD.values else { return Err("not a choice".to_owned()) };
    let found = words.iter().find(|&&word| word == text);
    found.copied().ok_or_else(|| format!("expected one of {}", words.join(", ")))
}

/// Bytes of some sets of rays and their answers.
pub fn ray_bytes(rays: u64, sets: u64) -> u64 {
    rays * sets * (size_of::<Ray>() + size_of::<ClosestHit>()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_has_a_unit_or_is_megabytes() {
        let sizes = [("4GB", 4_000_000_000), ("512MiB", 512 << 20), ("300", 300_000_000), ("0", 0)];
        for (text, bytes) in sizes {
            assert_eq!(memory(text), Ok(bytes), "{text}");
        }
        for wrong in ["4 apples", "", "-1"] {
            let error = memory(wrong).expect_err(wrong);
            assert!(error.ends_with("2GB or 2G, or a number of megabytes"), "{error}");
        }
    }
}
