//! The slack that triangles are grown by, and the rays for which it is enough.

use crate::geom::TriangleSource;
use crate::math::{Aabb, PrimId, Ray, Vec3};

/// How far triangles reach beyond themselves when a tree is built; see [`super`] for why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slack {
    /// Added to every triangle on each side, along each axis.
    pub delta: f32,
    /// What remains of it for sure once boxes and cells have been rounded.
    pub kept: f32,
    centre: Vec3,
    /// Largest distance of an origin from the centre, along an axis, of a tame ray.
    reach: f32,
    /// Bounds of the largest component of a direction of a tame ray.
    stride: f32,
    creep: f32,
}

impl Slack {
    /// Tame rays start no further than this many times the longest edge of the box from its
    /// centre; planes are then at most four edges away.
    const REACH: f32 = 3.0;
    /// 2^-17 of the longest edge, or 128 half-ulps of it.
    const RELATIVE: f32 = 7.629395e-6;
    /// 2^-22 of the coordinates, for the rounding of the planes and boxes themselves.
    const ROUNDING: f32 = 2.0 * f32::EPSILON;
    /// How much further than tame rays others may start for a tree with clipped triangles.
    const FAR: f32 = 67_108_864.0; // 2^26

    /// The slack for triangles whose own boxes have the union `bounds`; `None` if their
    /// coordinates are so large that distances overflow.
    /// Vertices may be off by `off` along each axis.
    pub fn new(bounds: &Aabb, off: f32) -> Option<Self> {
        let longest = bounds.extent().max_element();
        let magnitude = bounds.min.abs().max(bounds.max.abs()).max_element();
        let kept = longest * Self::RELATIVE;
        let delta = kept + magnitude * Self::ROUNDING + off;
        let reach = longest * Self::REACH;
        // A distance of delta must still be a normal number: 2^-110 leaves sixteen bits of room.
        let stride = (delta * 1.298074e33).min(f32::MAX);
        // And the distance of all that matters must be finite.
        let creep = reach * 1.880791e-37; // 2^-122
        let slack =
            Self { delta, kept: kept * 0.9375, centre: bounds.centre(), reach, stride, creep };
        (reach * Self::FAR).is_finite().then_some(slack)
    }

    /// The slack of a scene that can't be divided: no ray is tame.
    pub const NONE: Self =
        Self { delta: 0.0, kept: 0.0, centre: Vec3::ZERO, reach: -1.0, stride: 0.0, creep: 0.0 };

    /// A box with slack.
    pub fn grow(&self, bounds: &Aabb) -> Aabb {
        Aabb { min: bounds.min - self.delta, max: bounds.max + self.delta }
    }

    /// Whether the comparison of single distances is enough for this ray.
    #[inline(always)]
    pub fn is_tame(&self, ray: &Ray) -> bool {
        let far = (ray.origin() - self.centre).abs().max_element();
        let fast = ray.direction().abs().max_element();
        far <= self.reach && fast <= self.stride && fast >= self.creep
    }

    /// Whether the hit points of this ray are close enough to their triangles for a tree that
    /// holds triangles only where they are, not where their boxes are.
    pub fn is_placed(&self, ray: &Ray) -> bool {
        let far = (ray.origin() - self.centre).abs().max_element();
        far <= self.reach * Self::FAR
    }
}

/// The union of the own boxes of all triangles.
pub fn find_bounds(source: &dyn TriangleSource) -> Aabb {
    use rayon::prelude::*;
    (0..source.len())
        .into_par_iter()
        .map(|i| source.own_box(PrimId::from_index(i)))
        .reduce(|| Aabb::EMPTY, Aabb::union)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_boxes_gain_thickness_and_huge_ones_have_no_slack() {
        let flat = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 0.0, 1.0) };
        let slack = Slack::new(&flat, 0.0).expect("a unit square is of moderate size");
        assert!(slack.grow(&flat).extent().y > 1e-5);
        assert!(
            Slack::new(&Aabb { min: Vec3::splat(-1e38), max: Vec3::splat(1e38) }, 0.0).is_none()
        );
    }

    #[test]
    fn rays_from_afar_or_with_huge_strides_are_not_tame() {
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let slack = Slack::new(&unit, 0.0).expect("a unit cube is of moderate size");
        let ray = |o: f32, d: f32| Ray::new(Vec3::splat(o), Vec3::splat(d), 0.0, 1.0);
        assert!(slack.is_tame(&ray(3.0, 1.0)));
        assert!(!slack.is_tame(&ray(4.0, 1.0)) && slack.is_placed(&ray(4.0, 1.0)));
        assert!(!slack.is_tame(&ray(0.0, 1e29)));
        assert!(!slack.is_placed(&ray(1e20, 1.0)));
        assert!(!Slack::NONE.is_tame(&ray(0.0, 1.0)));
    }
}
