//! Flags and values that several benches have.

use crate::accel::bvh::BUILD;
use crate::accel::{BuildError, ClosestHit, Values};
use crate::files;
use crate::math::Ray;
use crate::simd::Isa;

/// What a bench uses of the machine.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct MachineArgs {
    /// The instruction set
    #[arg(long, default_value_t)]
    isa: Isa,
    /// Megabytes that rays and structures may take; 0: three quarters of the machine's memory
    #[arg(long, value_name = "MB", default_value_t = 0)]
    memory: u64,
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
            0 => files::memory::limit() / 4 * 3,
            megabytes => megabytes.saturating_mul(1_000_000),
        }
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
