//! Bounds of a light or of many lights, and how important they are to a point.

use std::f32::consts::PI;

use super::cone::Cone;
use crate::math::{Aabb, Vec3};

/// Bounds of a light or of many: where it is, and how much light it sends where.
#[derive(Clone, Copy, Debug)]
pub struct LightBounds {
    /// Holds all of the light.
    pub bounds: Aabb,
    /// Holds all normals, or the axis of a point light.
    pub normals: Cone,
    /// The cosine of the greatest angle off a normal at which it shines.
    pub cos_emission: f32,
    /// In any unit. Lights without power are never chosen.
    pub power: f32,
}

/// Where light is to arrive: what the choice of a light depends on (pbrt's light-sample context).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSampleContext {
    /// The point.
    pub position: Vec3,
    /// Unit normal of a surface that scatters light from that side alone; zero where it scatters
    /// light from both.
    pub normal: Vec3,
}

/// Which sides of a flat emitter shine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// The side that its normal points to.
    Front,
    /// Both sides.
    Both,
}

impl LightBounds {
    /// A light that is infinitely far away, which no tree chooses.
    pub const NOWHERE: Self = Self {
        bounds: Aabb { min: Vec3::ZERO, max: Vec3::ZERO },
        normals: Cone::ALL,
        cos_emission: -1.0,
        power: 0.0,
    };

    /// A triangle of a unit normal (zero where it is not known) that emits from `sides`.
    pub fn flat(corners: [Vec3; 3], normal: Vec3, sides: Sides, power: f32) -> Self {
        let normals = match sides {
            Sides::Front if normal != Vec3::ZERO => Cone::of(normal),
            _ => Cone::ALL,
        };
        Self { bounds: Aabb::of_points(corners), normals, cos_emission: 0.0, power }
    }

    /// A point light that shines up to `angle` (radians) off its axis; π means in all directions.
    pub fn point(position: Vec3, axis: Vec3, angle: f32, power: f32) -> Self {
        let bounds = Aabb { min: position, max: position };
        if angle >= PI {
            return Self { bounds, normals: Cone::ALL, cos_emission: 0.0, power };
        }
        // A little wider than the light, for rounding.
        let cos_emission = libm::cosf((angle + 1e-3).min(PI));
        Self { bounds, normals: Cone::of(axis), cos_emission, power }
    }

    /// The bounds of both together.
    pub(super) fn union(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            normals: self.normals.union(&other.normals),
            cos_emission: self.cos_emission.min(other.cos_emission),
            power: self.power + other.power,
        }
    }

    /// An estimate of how much of its light arrives; zero only where none does.
    pub(super) fn importance(&self, context: &LightSampleContext) -> f32 {
        let half = self.bounds.extent() * 0.5;
        let from_centre = context.position - (self.bounds.min + half);
        let (radius2, distance2) = (half.length_squared(), from_centre.length_squared());
        let way = from_centre / distance2.sqrt().max(f32::MIN_POSITIVE);
        // Half of the angle under which all of it is seen.
        let sin2 = if distance2 > radius2 { radius2 / distance2 } else { 1.0 };
        let seen = Angle {
            sin: sin2.sqrt(),
            cos: if distance2 > radius2 { (1.0 - sin2).sqrt() } else { -1.0 },
        };
        let seen = if seen.cos < 0.0 { Angle { sin: 0.0, cos: -1.0 } } else { seen };

        let off_normal = Angle::of_cos(self.normals.axis.dot(way))
            .saturating_sub(Angle::of_cos(self.normals.cos))
            .saturating_sub(seen);
        if off_normal.cos <= self.cos_emission {
            return 0.0;
        }
        // Never quite nothing, so that rounding hides no light at the edge of what it shines on.
        let mut importance = self.power * off_normal.cos.max(MIN_COS) / distance2.max(radius2);
        if context.normal != Vec3::ZERO {
            let cos = Angle::of_cos(-context.normal.dot(way)).saturating_sub(seen).cos;
            if cos < -1e-4 {
                return 0.0;
            }
            importance *= cos.max(MIN_COS);
        }
        if importance.is_finite() { importance } else { f32::MAX * 0.25 }
    }

    /// The cost of a node by the surface area orientation heuristic, but for the factor that makes
    /// long boxes dearer.
    pub(super) fn cost(&self) -> f32 {
        let extent = self.bounds.extent();
        // Lights in a plane or on a line have a size too.
        let extent = extent + extent.max_element() * 1e-2;
        let area = extent.x * extent.y + extent.y * extent.z + extent.z * extent.x;
        self.power * self.normals.solid_angle_measure(self.cos_emission) * area
    }
}

/// The least cosine that counts where light may arrive at all.
const MIN_COS: f32 = 1e-3;

/// An angle from 0 to π.
#[derive(Clone, Copy)]
struct Angle {
    sin: f32,
    cos: f32,
}

impl Angle {
    fn of_cos(cos: f32) -> Self {
        let cos = cos.clamp(-1.0, 1.0);
        Self { sin: (1.0 - cos * cos).max(0.0).sqrt(), cos }
    }

    /// The difference, at least 0.
    fn saturating_sub(self, other: Self) -> Self {
        if self.cos > other.cos {
            return Self { sin: 0.0, cos: 1.0 };
        }
        Self {
            sin: self.sin * other.cos - self.cos * other.sin,
            cos: self.cos * other.cos + self.sin * other.sin,
        }
    }
}
