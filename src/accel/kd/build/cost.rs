//! The surface area heuristic.

use crate::math::{Aabb, DVec3, Vec3};

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

    /// What dividing a cell costs.
    pub fn in_cell<'a>(&'a self, cell: &'a Aabb) -> CellCosts<'a> {
        let (area, e) = (cell.half_area(), cell.extent().max(Vec3::ZERO).as_dvec3());
        // A cell without area is as likely to be crossed as its parts.
        let (ends, sides) = if area > 0.0 {
            let ends = DVec3::new(e.y * e.z, e.z * e.x, e.x * e.y);
            (ends / area, DVec3::new(e.y + e.z, e.z + e.x, e.x + e.y) / area)
        } else {
            (DVec3::ONE, DVec3::ZERO)
        };
        CellCosts { costs: self, cell, ends: ends.to_array(), sides: sides.to_array() }
    }
}

/// What dividing a cell costs, with all that does not depend on the plane reckoned beforehand: the
/// area of a part is linear in where it ends.
#[derive(Clone, Copy, Debug)]
pub struct CellCosts<'a> {
    costs: &'a Costs,
    cell: &'a Aabb,
    /// The faces that a part has however thin it is, by axis, over the cell's area.
    ends: [f64; 3],
    /// The others, for each unit of length.
    sides: [f64; 3],
}

impl CellCosts<'_> {
    /// The cost of dividing the cell with that many triangles below and above; `None` if the plane
    /// is not inside.
    #[inline]
    pub fn plane(&self, axis: usize, split: f32, below: usize, above: usize) -> Option<Plane> {
        let (min, max) = (self.cell.min[axis], self.cell.max[axis]);
        if !(split > min && split < max) {
            return None;
        }
        let share = |low: f32, high: f32| {
            self.ends[axis] + self.sides[axis] * (f64::from(high) - f64::from(low))
        };
        let costs = self.costs;
        let bonus = if below == 0 || above == 0 { 1.0 - costs.empty } else { 1.0 };
        let tests = share(min, split) * below as f64 + share(split, max) * above as f64;
        Some(Plane { axis, split, cost: costs.step + bonus * costs.triangle * tests })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_costs_a_step_and_its_sides_by_their_area() {
        let costs = Costs { step: 1.0, triangle: 2.0, empty: 0.5 };
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let costs = costs.in_cell(&unit);
        // Half a cube has two thirds of the area.
        let plane = costs.plane(1, 0.5, 3, 6).expect("it is inside");
        assert!((plane.cost - (1.0 + 2.0 * (3.0 + 6.0) * 2.0 / 3.0)).abs() < 1e-12);
        let cut = costs.plane(1, 0.5, 0, 6).expect("it is inside");
        assert!((cut.cost - (1.0 + 2.0 * 0.5 * 6.0 * 2.0 / 3.0)).abs() < 1e-12);
        assert_eq!(costs.plane(1, 1.0, 3, 6), None);
    }
}
