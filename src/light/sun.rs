//! A sun: an even disc infinitely far away.

use std::f32::consts::PI;

use crate::math::{Frame, Vec2, Vec3};
use crate::simd::lanes::{Float, Lanes, Scalar, Vec3f, unit_circle};

/// An even disc in the sky, sampled by its solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Its centre as third axis.
    frame: Frame,
    radiance: Vec3,
    /// One minus the cosine of its angular radius, which an f32 of that cosine would not know.
    height: f32,
}

impl Sun {
    /// The sun's mean angular diameter seen from the Earth, degrees.
    pub const DIAMETER: f32 = 0.533;

    /// A disc about a unit `direction` that is `diameter` degrees across, above 0 and at most 180,
    /// and puts `irradiance` onto a surface that faces it.
    pub fn new(direction: Vec3, diameter: f32, irradiance: Vec3) -> Self {
        let half_sine = libm::sinf(0.25 * diameter.to_radians());
        let height = 2.0 * half_sine * half_sine;
        // The cosine integrated over a cap is pi times the square of the sine of its radius.
        let radiance = irradiance / (PI * height * (2.0 - height));
        Self { frame: Frame::from_normal(direction), radiance, height }
    }

    /// Unit direction to its centre.
    pub fn direction(&self) -> Vec3 {
        self.frame.normal
    }

    /// Radiance of each point of it.
    pub fn radiance(&self) -> Vec3 {
        self.radiance
    }

    /// Steradians.
    pub fn solid_angle(&self) -> f32 {
        2.0 * PI * self.height
    }

    /// Density over solid angle of [`Sun::sample`], inside the disc.
    pub fn pdf(&self) -> f32 {
        1.0 / self.solid_angle()
    }

    /// Whether a unit direction meets it.
    #[inline]
    pub fn covers(&self, direction: Vec3) -> bool {
        self.covers_in_lanes(Scalar, direction.into())
    }

    /// Samples a direction to it by a uniform `u` in the unit square.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        self.sample_in_lanes(Scalar, u.to_array()).into()
    }

    /// [`Sun::covers`] in lanes: by the chord to its centre, since the cosine of so small an
    /// angle has no digits left.
    #[inline(always)]
    pub fn covers_in_lanes<L: Lanes>(&self, lanes: L, direction: Vec3f<L>) -> L::Mask {
        let centre = self.frame.normal;
        let x = direction.x - centre.x;
        let y = direction.y - centre.y;
        let z = direction.z - centre.z;
        (x * x + y * y + z * z).le(lanes.float(2.0 * self.height))
    }

    /// [`Sun::sample`] in lanes.
    #[inline(always)]
    pub fn sample_in_lanes<L: Lanes>(&self, lanes: L, [x, y]: [L::Float; 2]) -> Vec3f<L> {
        let below = x * self.height;
        let sine = (below * (lanes.float(2.0) - below)).most(lanes.float(0.0)).sqrt();
        let (c, s) = unit_circle::<L>(y);
        let (x, y, z) = (sine * c, sine * s, lanes.float(1.0) - below);
        let Frame { tangent: a, bitangent: b, normal: n } = self.frame;
        Vec3f::<L>::new(
            x * a.x + y * b.x + z * n.x,
            x * a.y + y * b.y + z * n.y,
            x * a.z + y * b.z + z * n.z,
        )
        .normalize(lanes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_gets_the_irradiance_times_the_cosine() {
        for (elevation, diameter) in
            [(90.0_f32, Sun::DIAMETER), (30.0, Sun::DIAMETER), (60.0, 40.0)]
        {
            let (s, c) = libm::sincosf(elevation.to_radians());
            let irradiance = Vec3::new(3.0, 2.0, 1.0);
            let sun = Sun::new(Vec3::new(c, s, 0.0), diameter, irradiance);
            let mut sum = 0.0_f64;
            for i in 0..64 {
                for j in 0..64 {
                    let u = Vec2::new((i as f32 + 0.5) / 64.0, (j as f32 + 0.5) / 64.0);
                    let direction = sun.sample(u);
                    assert!(sun.covers(direction));
                    sum += f64::from(sun.radiance().x * direction.y / sun.pdf());
                }
            }
            let found = sum / 4096.0;
            let expected = f64::from(3.0 * s);
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        }
    }

    #[test]
    fn the_disc_ends_at_its_radius() {
        let sun = Sun::new(Vec3::Y, 2.0, Vec3::ONE);
        let at = |degrees: f32| {
            let (s, c) = libm::sincosf(degrees.to_radians());
            sun.covers(Vec3::new(s, c, 0.0))
        };
        assert!(at(0.999) && !at(1.001));
        // 6.79e-5 sr: the sun, as every table has it.
        let real = Sun::new(Vec3::Y, Sun::DIAMETER, Vec3::ONE).solid_angle();
        assert!((real / 6.796e-5 - 1.0).abs() < 1e-3, "{real}");
    }
}
