//! Rays.

use glam::Vec3;

/// A segment or half-line: the points `origin + t * direction` for `t_min < t <= t_max`.
///
/// The direction need not have unit length; `t` counts in multiples of it. Made by [`Ray::new`]
/// only, which keeps NaN out, so that no comparison in a traversal ever meets one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Ray {
    origin: Vec3,
    t_min: f32,
    direction: Vec3,
    t_max: f32,
}

impl Ray {
    /// Longest and shortest (as its reciprocal) component of largest magnitude that a direction
    /// may have: in between, no distance to a plane overflows or loses bits to denormals.
    const DIRECTION_LIMIT: f32 = 1.2676506e30; // 2^100

    /// Least and greatest component of largest magnitude that a direction may have.
    pub const DIRECTION_RANGE: [f32; 2] = [1.0 / Self::DIRECTION_LIMIT, Self::DIRECTION_LIMIT];

    /// The ray that hits nothing.
    pub const MISS: Self =
        Self { origin: Vec3::ZERO, t_min: 0.0, direction: Vec3::Z, t_max: f32::NEG_INFINITY };

    /// A ray; a negative `t_min` counts as zero.
    ///
    /// With a NaN or infinite origin or direction, a NaN limit, or a direction whose largest
    /// component is not within 2^-100 to 2^100, it is [`Ray::MISS`].
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3, t_min: f32, t_max: f32) -> Self {
        let longest = direction.abs().max_element();
        // Written so that NaN fails every comparison.
        let valid = origin.is_finite()
            && direction.is_finite()
            && (Self::DIRECTION_RANGE[0]..=Self::DIRECTION_RANGE[1]).contains(&longest)
            && !t_min.is_nan()
            && !t_max.is_nan();
        // A comparison, not `max`: that may return either of two zeros, and this one has no sign.
        let t_min = if t_min > 0.0 { t_min } else { 0.0 };
        if valid { Self { origin, t_min, direction, t_max } } else { Self::MISS }
    }

    /// A ray from its origin on that [`Ray::new`] would take as it is: who makes many of them
    /// checks them many at once.
    #[inline(always)]
    pub(crate) fn usable(origin: Vec3, direction: Vec3, t_max: f32) -> Self {
        let ray = Self { origin, t_min: 0.0, direction, t_max };
        debug_assert_eq!(ray, Self::new(origin, direction, 0.0, t_max));
        ray
    }

    /// The same up to `t`, if it ends later.
    #[inline(always)]
    pub(crate) fn up_to(self, t: f32) -> Self {
        Self { t_max: if t < self.t_max { t } else { self.t_max }, ..self }
    }

    /// Where it starts.
    #[inline(always)]
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    /// Where it goes; of any length.
    #[inline(always)]
    pub fn direction(&self) -> Vec3 {
        self.direction
    }

    /// Hits lie strictly behind this distance; at least zero.
    #[inline(always)]
    pub fn t_min(&self) -> f32 {
        self.t_min
    }

    /// Hits lie at or before this distance.
    #[inline(always)]
    pub fn t_max(&self) -> f32 {
        self.t_max
    }

    /// The point at `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_traced_misses() {
        let inf = f32::INFINITY;
        for (origin, direction) in [
            (Vec3::splat(f32::NAN), Vec3::X),
            (Vec3::splat(inf), Vec3::X),
            (Vec3::ZERO, Vec3::ZERO),
            (Vec3::ZERO, Vec3::new(-0.0, 0.0, 0.0)),
            (Vec3::ZERO, Vec3::new(1.0, f32::NAN, 0.0)),
            (Vec3::ZERO, Vec3::splat(1e-42)),
        ] {
            assert_eq!(Ray::new(origin, direction, 0.0, inf), Ray::MISS);
        }
        assert_eq!(Ray::new(Vec3::ZERO, Vec3::X, f32::NAN, inf), Ray::MISS);
        for t_min in [-1.0, -0.0] {
            assert_eq!(Ray::new(Vec3::ZERO, Vec3::X, t_min, inf).t_min().to_bits(), 0);
        }
    }
}
