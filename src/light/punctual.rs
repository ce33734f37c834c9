//! Lights without extent, as the glTF extension KHR_lights_punctual defines them.

use crate::math::Vec3;

/// The shape of a punctual light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PunctualKind {
    /// Shines from a position in all directions.
    Point,
    /// Shines from a position into a cone.
    Spot {
        /// Half-angle up to which it has its full strength, radians.
        inner: f32,
        /// Half-angle from which it is dark, radians; more than `inner`.
        outer: f32,
    },
    /// Shines from infinitely far away.
    Directional,
}

/// A light without extent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Punctual {
    /// Its shape.
    pub kind: PunctualKind,
    /// Where it stands; without meaning for a directional light.
    pub position: Vec3,
    /// The unit direction that it shines in; without meaning for a point light.
    pub direction: Vec3,
    /// Colour times strength: candela (lumen per steradian), or lux for a directional light.
    pub intensity: Vec3,
    /// The distance in metres at which it ends, for point and spot lights.
    pub range: Option<f32>,
}

/// What a punctual light sends to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Illumination {
    /// Unit direction towards the light.
    pub direction: Vec3,
    /// Where the light stands; `None`: infinitely far along `direction`.
    pub origin: Option<Vec3>,
    /// Irradiance on a surface that faces the light.
    pub irradiance: Vec3,
}

impl Punctual {
    /// The light that arrives at `point` unless something is in between; `None` where none does.
    pub fn illuminate(&self, point: Vec3) -> Option<Illumination> {
        if self.kind == PunctualKind::Directional {
            let (direction, irradiance) = (-self.direction, self.intensity);
            return Some(Illumination { direction, origin: None, irradiance });
        }
        let towards = self.position - point;
        let distance2 = towards.length_squared();
        if !distance2.is_normal() {
            return self.illuminate_extreme(point);
        }
        let direction = towards.try_normalize()?;
        let strength = self.cone(-direction) * self.window(distance2) / distance2;
        (strength > 0.0).then(|| Illumination {
            direction,
            origin: Some(self.position),
            irradiance: self.intensity * strength,
        })
    }

    /// The same where the square of the distance is beyond the range of f32.
    #[cold]
    fn illuminate_extreme(&self, point: Vec3) -> Option<Illumination> {
        let towards = self.position.as_dvec3() - point.as_dvec3();
        let distance2 = towards.length_squared();
        let direction = towards.try_normalize()?.as_vec3();
        let window = match self.range {
            Some(range) => {
                let ratio2 = distance2 / (f64::from(range) * f64::from(range));
                (1.0 - ratio2 * ratio2).clamp(0.0, 1.0)
            }
            None => 1.0,
        };
        let strength = f64::from(self.cone(-direction)) * window / distance2;
        let irradiance = (self.intensity.as_dvec3() * strength).as_vec3().min(Vec3::MAX);
        (strength > 0.0).then_some(Illumination {
            direction,
            origin: Some(self.position),
            irradiance,
        })
    }

    /// The flux that it sends into a scene of the given bounding radius (metres), by which lights
    /// are sampled. Scenes are as small and as large as f32 holds, their squares are not.
    pub fn power(&self, scene_radius: f32) -> f64 {
        let power = f64::from(self.narrow_power(scene_radius));
        if power.is_finite() && power >= f64::from(f32::MIN_POSITIVE) {
            return power;
        }
        let shape = Self { intensity: Vec3::ONE, ..*self };
        let mean = self.intensity.as_dvec3().element_sum() / 3.0;
        mean * match self.kind {
            PunctualKind::Directional => {
                std::f64::consts::PI * f64::from(scene_radius) * f64::from(scene_radius)
            }
            PunctualKind::Point | PunctualKind::Spot { .. } => {
                f64::from(shape.narrow_power(scene_radius))
            }
        }
    }

    fn narrow_power(&self, scene_radius: f32) -> f32 {
        use std::f32::consts::PI;
        let mean = (self.intensity.x + self.intensity.y + self.intensity.z) / 3.0;
        mean * match self.kind {
            PunctualKind::Point => 4.0 * PI,
            // The solid angle of a sharp cone halfway between both angles.
            PunctualKind::Spot { inner, outer } => {
                2.0 * PI * (1.0 - 0.5 * (libm::cosf(inner) + libm::cosf(outer)))
            }
            PunctualKind::Directional => PI * scene_radius * scene_radius,
        }
    }

    /// Share of the full strength in a unit direction away from the light, as the extension
    /// recommends it.
    fn cone(&self, direction: Vec3) -> f32 {
        let PunctualKind::Spot { inner, outer } = self.kind else { return 1.0 };
        let (cos_inner, cos_outer) = (libm::cosf(inner), libm::cosf(outer));
        let scale = 1.0 / (cos_inner - cos_outer).max(0.001);
        let share = ((self.direction.dot(direction) - cos_outer) * scale).clamp(0.0, 1.0);
        share * share
    }

    /// The extension's window that brings the light smoothly to nothing at its range.
    fn window(&self, distance2: f32) -> f32 {
        let Some(range) = self.range else { return 1.0 };
        let ratio2 = distance2 / (range * range);
        (1.0 - ratio2 * ratio2).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINT: Punctual = Punctual {
        kind: PunctualKind::Point,
        position: Vec3::new(0.0, 2.0, 0.0),
        direction: Vec3::NEG_Y,
        intensity: Vec3::new(8.0, 4.0, 2.0),
        range: None,
    };

    #[test]
    fn a_point_light_falls_off_with_the_square_of_the_distance() {
        let lit = POINT.illuminate(Vec3::ZERO).expect("nothing dims it");
        assert_eq!(lit.direction, Vec3::Y);
        assert_eq!(lit.irradiance, Vec3::new(2.0, 1.0, 0.5));
        assert!(POINT.illuminate(POINT.position).is_none());
    }

    /// Where squares of distances and sums of strengths leave the range of f32.
    #[test]
    fn lights_of_extreme_scenes_shine() {
        for scale in [1e-25_f32, 1e-20, 1e20, 1e30] {
            // Eight candela at two metres, all scaled.
            let intensity = Vec3::new(8.0, 4.0, 2.0) * (scale * 1e-6);
            let position = Vec3::new(0.0, 2.0 * scale, 0.0);
            let light = Punctual { position, intensity, ..POINT };
            let lit = light.illuminate(Vec3::ZERO).expect("it shines");
            assert_eq!(lit.direction, Vec3::Y);
            let expected = 2e-6 / f64::from(scale);
            assert!((f64::from(lit.irradiance.x) / expected - 1.0).abs() < 1e-5, "{scale}");
            let range = Some(scale);
            assert_eq!(Punctual { range, ..light }.illuminate(Vec3::ZERO), None);
        }
        let sun = Punctual { kind: PunctualKind::Directional, ..POINT };
        for radius in [1e-25_f32, 1e-10, 1.0, 1e25] {
            let expected =
                14.0 / 3.0 * std::f64::consts::PI * f64::from(radius) * f64::from(radius);
            assert!((sun.power(radius) / expected - 1.0).abs() < 1e-5, "{radius}");
        }
        let strong = Punctual { intensity: Vec3::splat(3e38), ..POINT };
        assert!((strong.power(1.0) / (12e38 * std::f64::consts::PI) - 1.0).abs() < 1e-5);
        assert_eq!(Punctual { intensity: Vec3::ZERO, ..POINT }.power(1.0), 0.0);
    }

    #[test]
    fn a_range_ends_the_light() {
        let light = Punctual { range: Some(2.0), ..POINT };
        assert_eq!(light.illuminate(Vec3::ZERO), None);
        let half = light.illuminate(Vec3::Y).expect("within range");
        // Distance 1 of 2: 1 - (1/2)^4.
        assert!((half.irradiance.x - 8.0 * 15.0 / 16.0).abs() < 1e-5);
    }

    #[test]
    fn a_spot_is_full_inside_and_dark_outside() {
        let kind = PunctualKind::Spot { inner: 0.2, outer: 0.5 };
        let spot = Punctual { kind, ..POINT };
        assert_eq!(spot.illuminate(Vec3::ZERO), POINT.illuminate(Vec3::ZERO));
        assert_eq!(spot.illuminate(Vec3::new(2.0, 0.0, 0.0)), None); // at 45 degrees
        let between = spot.illuminate(Vec3::new(2.0 * libm::tanf(0.35), 0.0, 0.0));
        let lit = between.expect("inside the cone").irradiance.x;
        let open = POINT.illuminate(Vec3::new(2.0 * libm::tanf(0.35), 0.0, 0.0));
        assert!(lit > 0.0 && lit < open.expect("a point light").irradiance.x);
    }
}
