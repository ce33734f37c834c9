//! From stored numbers to linear values.

use std::sync::LazyLock;

use super::pack;
use super::texels::{Depth, Texels, Value};
use crate::math::{Vec3, Vec4};

/// What the numbers in an image mean. Alpha is linear in both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorSpace {
    /// Colours by the transfer function of IEC 61966-2-1.
    Srgb,
    /// Proportional to light, or no light at all: normals, roughness.
    Linear,
}

/// Linear values of stored integers; as long as there are such, empty for floats.
#[derive(Clone, Copy)]
pub(super) struct Tables {
    /// Of red, green, blue or grey.
    pub color: &'static [f32],
    /// Of alpha.
    pub alpha: &'static [f32],
}

impl Tables {
    /// Those for values of a kind. Floats hold linear colours always.
    pub fn new(depth: Depth, color_space: ColorSpace) -> Self {
        let (linear, srgb): (&'static LazyLock<Vec<f32>>, _) = match depth {
            Depth::U8 => (&LINEAR_8, &SRGB_8),
            Depth::U16 => (&LINEAR_16, &SRGB_16),
            Depth::F32 => return Self { color: &[], alpha: &[] },
        };
        let color = if color_space == ColorSpace::Srgb { srgb } else { linear };
        Self { color, alpha: linear }
    }

    /// Linear red, green, blue and alpha of the texels numbered `at`, which have so many channels.
    #[inline]
    pub fn gather<const K: usize>(
        self,
        texels: &Texels,
        channels: u8,
        at: [usize; K],
    ) -> [Vec4; K] {
        match texels {
            Texels::U8(values) => self.gather_values(values, channels, at),
            Texels::U16(values) => self.gather_values(values, channels, at),
            Texels::F32(values) => self.gather_values(values, channels, at),
        }
    }

    #[inline]
    fn gather_values<T: Value, const K: usize>(
        self,
        values: &[T],
        channels: u8,
        at: [usize; K],
    ) -> [Vec4; K] {
        match channels {
            1 => at.map(|at| self.linear::<T, 1>(values, at)),
            2 => at.map(|at| self.linear::<T, 2>(values, at)),
            3 => at.map(|at| self.linear::<T, 3>(values, at)),
            _ => at.map(|at| self.linear::<T, 4>(values, at)),
        }
    }

    /// The same of texels in columns and rows of a packed tile.
    #[inline]
    pub fn gather_packed<const K: usize>(
        self,
        tile: &[u8],
        depth: Depth,
        channels: u8,
        at: [[u32; 2]; K],
    ) -> [Vec4; K] {
        match depth {
            Depth::U8 => self.unpack::<u8, K>(tile, channels, at),
            Depth::U16 => self.unpack::<u16, K>(tile, channels, at),
            Depth::F32 => self.unpack::<f32, K>(tile, channels, at),
        }
    }

    #[inline]
    fn unpack<T: Value, const K: usize>(
        self,
        tile: &[u8],
        channels: u8,
        at: [[u32; 2]; K],
    ) -> [Vec4; K] {
        match channels {
            1 => at.map(|at| self.linear_packed::<T, 1>(tile, at)),
            2 => at.map(|at| self.linear_packed::<T, 2>(tile, at)),
            3 => at.map(|at| self.linear_packed::<T, 3>(tile, at)),
            _ => at.map(|at| self.linear_packed::<T, 4>(tile, at)),
        }
    }

    #[inline(always)]
    fn linear_packed<T: Value, const N: usize>(self, tile: &[u8], at: [u32; 2]) -> Vec4 {
        let mut values = [T::zeroed(); N];
        pack::texel(tile, at, bytemuck::cast_slice_mut(&mut values));
        self.linear::<T, N>(&values, 0)
    }

    #[inline(always)]
    fn linear<T: Value, const N: usize>(self, values: &[T], at: usize) -> Vec4 {
        let texel = &values[at * N..][..N];
        let color = |channel: usize| texel[channel].linear(self.color);
        let alpha = |channel: usize| texel[channel].linear(self.alpha);
        match N {
            1 => Vec3::splat(color(0)).extend(1.0),
            2 => Vec3::splat(color(0)).extend(alpha(1)),
            3 => Vec4::new(color(0), color(1), color(2), 1.0),
            _ => Vec4::new(color(0), color(1), color(2), alpha(3)),
        }
    }
}

/// The transfer function of sRGB (IEC 61966-2-1), encoded 0..=1 to linear.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { libm::powf((encoded + 0.055) / 1.055, 2.4) }
}

static LINEAR_8: LazyLock<Vec<f32>> = LazyLock::new(|| table(u8::MAX.into(), |x| x));
static SRGB_8: LazyLock<Vec<f32>> = LazyLock::new(|| table(u8::MAX.into(), srgb_to_linear));
static LINEAR_16: LazyLock<Vec<f32>> = LazyLock::new(|| table(u16::MAX, |x| x));
static SRGB_16: LazyLock<Vec<f32>> = LazyLock::new(|| table(u16::MAX, srgb_to_linear));

fn table(last: u16, decode: fn(f32) -> f32) -> Vec<f32> {
    (0..=last).map(|i| decode(f32::from(i) / f32::from(last))).collect()
}
