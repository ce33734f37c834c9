//! Axis-aligned bounding boxes.

use glam::Vec3;

/// The closed box `[min, max]`; empty where `min > max` on an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The lowest corner.
    pub min: Vec3,
    /// The highest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing, neutral in [`Aabb::union`].
    pub const EMPTY: Self =
        Self { min: Vec3::splat(f32::INFINITY), max: Vec3::splat(f32::NEG_INFINITY) };

    /// The smallest box of `points`.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::include)
    }

    /// The smallest box of this one and `point`.
    #[inline(always)]
    pub fn include(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box of both.
    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// What both have in common; may be empty.
    #[inline(always)]
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Whether it holds no point.
    pub fn is_empty(self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether all of `other` lies inside; true for an empty `other`.
    pub fn contains(self, other: Self) -> bool {
        other.is_empty() || (self.min.cmple(other.min).all() && self.max.cmpge(other.max).all())
    }

    /// Its eight corners; none if it is empty.
    pub fn corners(self) -> Vec<Vec3> {
        let corner = |i: usize| {
            let end = |axis: usize| if i >> axis & 1 == 0 { self.min } else { self.max }[axis];
            Vec3::new(end(0), end(1), end(2))
        };
        if self.is_empty() { Vec::new() } else { (0..8).map(corner).collect() }
    }

    /// Edge lengths; negative infinity for [`Aabb::EMPTY`].
    #[inline(always)]
    pub fn extent(self) -> Vec3 {
        self.max - self.min
    }

    /// The middle. Halves before it adds, so that huge boxes do not overflow.
    #[inline(always)]
    pub fn centre(self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Half of the surface area, zero for an empty box: what the surface area heuristic weighs by.
    /// In f64, because boxes of 1e20 square to infinity in f32.
    #[inline(always)]
    pub fn half_area(self) -> f64 {
        let e = self.extent().max(Vec3::ZERO).as_dvec3();
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// The axis of the longest edge; the first of equals.
    pub fn longest_axis(self) -> usize {
        let e = self.extent();
        if e.x >= e.y && e.x >= e.z {
            0
        } else if e.y >= e.z {
            1
        } else {
            2
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_box_has_no_area_and_is_neutral() {
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        assert_eq!(Aabb::EMPTY.half_area(), 0.0);
        assert_eq!(Aabb::EMPTY.union(unit), unit);
        assert!(Aabb::EMPTY.is_empty());
        assert!(unit.contains(Aabb::EMPTY));
    }

    #[test]
    fn half_area_of_a_brick() {
        let brick = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 3.0) };
        assert_eq!(brick.half_area(), 2.0 + 6.0 + 3.0);
        assert_eq!(brick.longest_axis(), 2);
    }
}
