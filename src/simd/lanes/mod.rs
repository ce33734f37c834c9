//! Numbers side by side: code that is written once for one number, eight or sixteen.
//!
//! Such code is generic over [`Lanes`] and gives the same bits at every width, since it rounds each
//! operation alike: nothing is fused, no reciprocal is approximate, and the lesser of two is told
//! by a comparison ([`Float::least`]), which is the same everywhere where NaN or zeros of both
//! signs meet. [`Scalar`] is the form for a single number. Functions between the choice of the
//! instruction set and an operation must be `#[inline(always)]`, or each operation becomes a call.
//!
//! Data comes as rows of four numbers, since a row is one load: [`fetch`] loads one a lane from a
//! table, and [`Lanes::columns`] turns the rows of all lanes into four columns, one number a lane
//! each.

mod exponential;
mod fetch;
mod frame;
#[cfg(test)]
mod function_tests;
mod scalar;
#[cfg(test)]
mod tests;
mod traits;
mod trigonometry;
mod vec3f;
mod wide;

pub use exponential::pow;
#[cfg(test)]
use exponential::{exp, ln};
pub use fetch::fetch;
pub use frame::FrameLanes;
pub use scalar::Scalar;
pub use traits::{Float, Lanes, MAX_LANES, Mask, Rows, SIGN, Uint};
pub use trigonometry::{atan2, sin_cos_eighth, unit_circle};
pub use vec3f::Vec3f;
pub use wide::{Lanes8, Lanes16};
