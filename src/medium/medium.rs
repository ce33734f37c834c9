//! Even media.

use super::phase::HenyeyGreenstein;
use crate::math::Vec3;

/// What scatters and absorbs light alike at all of its points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    extinction: Vec3,
    albedo: Vec3,
    anisotropy: f32,
}

impl Medium {
    /// The most that an extinction may be, per metre: products with distances stay finite.
    pub const MOST_EXTINCTION: f32 = 1e12;

    /// A medium that takes away `extinction` per metre of light, of which it scatters the share
    /// `albedo` and absorbs the rest, by colour. `anisotropy` is the mean cosine of the angle by
    /// which it scatters, -1 to 1. All are clamped to what they may be; NaN counts as 0.
    pub fn new(extinction: Vec3, albedo: Vec3, anisotropy: f32) -> Self {
        let within = |value: f32, most: f32| if value > 0.0 { value.min(most) } else { 0.0 };
        Self {
            extinction: extinction.map(|value| within(value, Self::MOST_EXTINCTION)),
            albedo: albedo.map(|value| within(value, 1.0)),
            anisotropy: if anisotropy.is_nan() { 0.0 } else { anisotropy.clamp(-1.0, 1.0) },
        }
    }

    /// What it takes away of light, per metre.
    pub fn extinction(&self) -> Vec3 {
        self.extinction
    }

    /// The share of what it takes away that is scattered.
    pub fn albedo(&self) -> Vec3 {
        self.albedo
    }

    /// Where it scatters to.
    pub fn phase(&self) -> HenyeyGreenstein {
        HenyeyGreenstein::new(self.anisotropy)
    }

    /// Whether it scatters at all.
    pub fn scatters(&self) -> bool {
        (self.extinction * self.albedo).max_element() > 0.0
    }

    /// What is left of white light after `distance` metres, which may be infinite.
    #[inline]
    pub fn transmittance(&self, distance: f32) -> Vec3 {
        // Zero times infinity is no number, and what takes away nothing leaves all.
        let of = |extinction: f32| {
            if extinction > 0.0 { libm::expf(-extinction * distance) } else { 1.0 }
        };
        self.extinction.map(of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_is_clamped() {
        let odd = Medium::new(
            Vec3::new(f32::NAN, f32::INFINITY, -1.0),
            Vec3::new(2.0, f32::NAN, -0.5),
            f32::NAN,
        );
        assert_eq!(odd.extinction(), Vec3::new(0.0, Medium::MOST_EXTINCTION, 0.0));
        assert_eq!(odd.albedo(), Vec3::X);
        assert!(!odd.scatters());
        assert_eq!(odd.transmittance(f32::INFINITY), Vec3::new(1.0, 0.0, 1.0));
    }

    #[test]
    fn what_is_left_after_two_legs_is_what_is_left_after_both() {
        let medium = Medium::new(Vec3::new(0.5, 2.0, 0.0), Vec3::ONE, 0.0);
        let both = medium.transmittance(1.25);
        let product = medium.transmittance(0.5) * medium.transmittance(0.75);
        assert!((both - product).length() < 1e-6);
        assert!((both.x - libm::expf(-0.625)).abs() < 1e-7 && both.z == 1.0);
    }
}
