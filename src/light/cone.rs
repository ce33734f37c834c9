//! Cones of directions, to bound the normals of many lights.

use std::f32::consts::{FRAC_PI_2, PI};

use crate::math::Vec3;

/// All directions within some angle of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Unit vector.
    pub axis: Vec3,
    /// The cosine of the angle.
    pub cos: f32,
}

impl Cone {
    /// All directions.
    pub const ALL: Self = Self { axis: Vec3::Z, cos: -1.0 };

    /// A single direction.
    pub fn of(axis: Vec3) -> Self {
        Self { axis, cos: 1.0 }
    }

    /// A cone that holds both, the smallest but for rounding.
    pub fn union(&self, other: &Self) -> Self {
        let (wide, narrow) = if self.cos <= other.cos { (self, other) } else { (other, self) };
        let angle = |cos: f32| libm::acosf(cos.clamp(-1.0, 1.0));
        let (wide_angle, narrow_angle) = (angle(wide.cos), angle(narrow.cos));
        let between = angle(wide.axis.dot(narrow.axis));
        if (between + narrow_angle).min(PI) <= wide_angle {
            return *wide;
        }
        let half = 0.5 * (wide_angle + between + narrow_angle);
        let across = (narrow.axis - wide.axis * wide.axis.dot(narrow.axis)).try_normalize();
        let Some(across) = across.filter(|_| half < PI) else { return Self::ALL };
        let turn = half - wide_angle;
        let axis = (wide.axis * libm::cosf(turn) + across * libm::sinf(turn)).normalize();
        // Outwards by more than the sums above have rounded.
        Self { axis, cos: (libm::cosf(half) - 1e-5).max(-1.0) }
    }

    /// The measure of the directions into which flat lights shine whose normals the cone holds, up
    /// to an angle off each: Conty and Kulla's, in which one that shines up to a right angle is π.
    pub fn solid_angle_measure(&self, cos_emission: f32) -> f32 {
        let spread = libm::acosf(self.cos.clamp(-1.0, 1.0));
        let reach = (spread + libm::acosf(cos_emission.clamp(-1.0, 1.0))).min(PI);
        let (sin, cos) = (libm::sinf(spread), libm::cosf(spread));
        let rest = 2.0 * reach * sin - libm::cosf(spread - 2.0 * reach) - 2.0 * spread * sin + cos;
        2.0 * PI * (1.0 - cos) + FRAC_PI_2 * rest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Sampler, warp};

    #[test]
    fn unions_hold_both() {
        for i in 0..500 {
            let mut sampler = Sampler::independent(i, 0, 3);
            let mut cone = || {
                let axis = warp::sphere(sampler.next_2d());
                Cone { axis, cos: 1.0 - 2.0 * sampler.next_1d() * sampler.next_1d() }
            };
            let (a, b) = (cone(), cone());
            let both = a.union(&b);
            assert!((both.axis.length() - 1.0).abs() < 1e-5);
            for part in [a, b] {
                let spread = libm::acosf(part.cos);
                let between = libm::acosf(part.axis.dot(both.axis).clamp(-1.0, 1.0));
                let reach = libm::acosf(both.cos.max(-1.0));
                assert!((spread + between).min(PI) <= reach + 2e-3, "{part:?} in {both:?}");
            }
        }
        assert_eq!(Cone::of(Vec3::X).union(&Cone::of(Vec3::NEG_X)), Cone::ALL);
        assert_eq!(Cone::ALL.union(&Cone::of(Vec3::X)), Cone::ALL);
    }

    #[test]
    fn measures_of_known_cones() {
        assert!((Cone::of(Vec3::Z).solid_angle_measure(0.0) - PI).abs() < 1e-5);
        assert!((Cone::ALL.solid_angle_measure(0.0) - 4.0 * PI).abs() < 1e-4);
    }
}
