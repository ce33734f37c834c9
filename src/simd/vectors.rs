//! Vectors by their width, for code that is generic over it.

use fearless_simd::{Simd, SimdFloat, SimdInt, f32x4, f32x8, f32x16};

/// What [`Vectors`] is implemented on.
pub struct Width;

/// The vector types of `W` lanes.
pub trait Vectors<const W: usize> {
    /// `W` floats.
    type Floats<S: Simd>: SimdFloat<
            S,
            Element = f32,
            Array = [f32; W],
            Bits: SimdInt<S, Element = u32, Array = [u32; W]>,
        >;
}

impl Vectors<4> for Width {
    type Floats<S: Simd> = f32x4<S>;
}

impl Vectors<8> for Width {
    type Floats<S: Simd> = f32x8<S>;
}

impl Vectors<16> for Width {
    type Floats<S: Simd> = f32x16<S>;
}
