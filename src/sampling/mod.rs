//! Random numbers and what is drawn with them: the sampler, warps, discrete and tabulated
//! distributions, and the sums that samples end up in.
//!
//! Everything here is a pure function of its arguments, made of additions, multiplications and
//! square roots alone, and so has the same bits on every CPU.

mod alias;
#[cfg(test)]
pub(crate) mod chi_squared;
mod distribution;
mod lattice;
mod sampler;
mod sampler_lanes;
mod scramble;
mod sobol;
mod sums;
pub mod warp;

pub use alias::{AliasError, AliasTable};
pub use distribution::{CellSample, Distribution2d, DistributionError};
pub use sampler::{ONE_MINUS_EPSILON, SamplePattern, Sampler, StreamId};
pub use sampler_lanes::SamplerLanes;
pub use scramble::mix_uniforms;
pub use sums::{BLOCK, BlockSums, NotAdjacent};
