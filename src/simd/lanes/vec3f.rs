//! Three-dimensional vectors, one a lane.

use std::ops::{Add, Mul, Neg, Sub};

use super::scalar::Scalar;
use super::traits::{Float, Lanes, Mask, Uint};

/// A vector in each lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec3f<L: Lanes> {
    /// First coordinates.
    pub x: L::Float,
    /// Second coordinates.
    pub y: L::Float,
    /// Third coordinates.
    pub z: L::Float,
}

impl<L: Lanes> Vec3f<L> {
    /// From its coordinates.
    #[inline(always)]
    pub fn new(x: L::Float, y: L::Float, z: L::Float) -> Self {
        Self { x, y, z }
    }

    /// All coordinates the same.
    #[inline(always)]
    pub fn splat(x: L::Float) -> Self {
        Self { x, y: x, z: x }
    }

    /// The same vector in all lanes.
    #[inline(always)]
    pub fn of_vector(lanes: L, v: glam::Vec3) -> Self {
        Self { x: lanes.float(v.x), y: lanes.float(v.y), z: lanes.float(v.z) }
    }

    /// The first three of four columns.
    #[inline(always)]
    pub fn of_columns([x, y, z, _]: [L::Float; 4]) -> Self {
        Self { x, y, z }
    }

    /// The three coordinates and a fourth column.
    #[inline(always)]
    pub fn columns(self, w: L::Float) -> [L::Float; 4] {
        [self.x, self.y, self.z, w]
    }

    /// Each coordinate by itself. The closure must be `#[inline(always)]` where it stands in the
    /// call.
    #[inline(always)]
    pub fn map(self, mut f: impl FnMut(L::Float) -> L::Float) -> Self {
        Self { x: f(self.x), y: f(self.y), z: f(self.z) }
    }

    /// Divided by a number a lane.
    #[inline(always)]
    pub fn divide(self, by: L::Float) -> Self {
        Self { x: self.x / by, y: self.y / by, z: self.z / by }
    }

    /// The coordinates of two vectors, pair by pair; see [`Vec3f::map`].
    #[inline(always)]
    pub fn zip(self, other: Self, mut f: impl FnMut(L::Float, L::Float) -> L::Float) -> Self {
        Self { x: f(self.x, other.x), y: f(self.y, other.y), z: f(self.z, other.z) }
    }

    /// Longer by a factor.
    #[inline(always)]
    pub fn scale(self, by: L::Float) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }

    /// The scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> L::Float {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// The vector product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - other.y * self.z,
            y: self.z * other.x - other.z * self.x,
            z: self.x * other.y - other.x * self.y,
        }
    }

    /// Without signs.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self { x: self.x.abs(), y: self.y.abs(), z: self.z.abs() }
    }

    /// The same direction of length one.
    #[inline(always)]
    pub fn normalize(self, lanes: L) -> Self {
        self.scale(lanes.float(1.0) / self.dot(self).sqrt())
    }

    /// With all signs turned where the highest bit of `sign` is set.
    #[inline(always)]
    pub fn flip(self, sign: L::Uint) -> Self {
        Self { x: self.x.flip(sign), y: self.y.flip(sign), z: self.z.flip(sign) }
    }

    /// `a` where the mask is true, else `b`.
    #[inline(always)]
    pub fn select(mask: L::Mask, a: Self, b: Self) -> Self {
        Self { x: mask.select(a.x, b.x), y: mask.select(a.y, b.y), z: mask.select(a.z, b.z) }
    }

    /// Whether all coordinates are finite.
    #[inline(always)]
    pub fn is_finite(self, lanes: L) -> L::Mask {
        let limit = lanes.float(f32::INFINITY);
        self.x.abs().lt(limit) & self.y.abs().lt(limit) & self.z.abs().lt(limit)
    }

    /// Whether all coordinates are zero, of either sign.
    #[inline(always)]
    pub fn is_zero(self) -> L::Mask {
        ((self.x.to_bits() | self.y.to_bits() | self.z.to_bits()) << 1).eq(0)
    }
}

impl<L: Lanes> Add for Vec3f<L> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<L: Lanes> Sub for Vec3f<L> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<L: Lanes> Mul for Vec3f<L> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }
}

impl<L: Lanes> Neg for Vec3f<L> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}

impl From<glam::Vec3> for Vec3f<Scalar> {
    #[inline(always)]
    fn from(v: glam::Vec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Vec3f<Scalar>> for glam::Vec3 {
    #[inline(always)]
    fn from(v: Vec3f<Scalar>) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}
