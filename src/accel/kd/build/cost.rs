//! The surface area heuristic.

use crate::accel::kd::tree::halves;
use crate::math::Aabb;

/// What things cost, in units of a step down the tree.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// A step.
    pub step: f64,
    /// A triangle of a leaf.
    pub triangle: f64,
    /// The share that is taken off where one side is empty.
    pub empty: f64,
}

impl Default for Costs {
    fn default() -> Self {
        Self { step: 1.0, triangle: 1.5, empty: 0.2 }
    }
}

/// A splitting plane with what it is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// 0 to 2.
    pub axis: usize,
    /// Its coordinate.
    pub split: f32,
    /// Expected cost of the node if it is divided here.
    pub cost: f64,
}

impl Plane {
    /// The cheaper; the first of equals, so that the order of candidates decides ties.
    pub fn better(best: Option<Self>, other: Self) -> Option<Self> {
        match best {
            Some(best) if best.cost <= other.cost => Some(best),
            _ => Some(other),
        }
    }
}

impl Costs {
    /// The cost of a leaf.
    pub fn leaf(&self, triangles: usize) -> f64 {
        self.triangle * triangles as f64
    }

    /// The cost of dividing `cell` with that many triangles below and above; `None` if the plane
    /// is not inside the cell.
    #[inline]
    pub fn plane(
        &self,
        cell: &Aabb,
        axis: usize,
        split: f32,
        below: usize,
        above: usize,
    ) -> Option<Plane> {
        if !(split > cell.min[axis] && split < cell.max[axis]) {
            return None;
        }
        let [low, high] = halves(cell, axis, split);
        let area = cell.half_area();
        let share = |part: &Aabb| if area > 0.0 { part.half_area() / area } else { 1.0 };
        let bonus = if below == 0 || above == 0 { 1.0 - self.empty } else { 1.0 };
        let tests = share(&low) * below as f64 + share(&high) * above as f64;
        Some(Plane { axis, split, cost: self.step + bonus * self.triangle * tests })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    #[test]
    fn a_plane_costs_a_step_and_its_sides_by_their_area() {
        let costs = Costs { step: 1.0, triangle: 2.0, empty: 0.5 };
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        // Half a cube has two thirds of the area.
        let plane = costs.plane(&unit, 1, 0.5, 3, 6).expect("it is inside");
        assert!((plane.cost - (1.0 + 2.0 * (3.0 + 6.0) * 2.0 / 3.0)).abs() < 1e-12);
        let cut = costs.plane(&unit, 1, 0.5, 0, 6).expect("it is inside");
        assert!((cut.cost - (1.0 + 2.0 * 0.5 * 6.0 * 2.0 / 3.0)).abs() < 1e-12);
        assert_eq!(costs.plane(&unit, 1, 1.0, 3, 6), None);
    }
}
