//! The surface area heuristic of kd-trees.

use crate::accel::sah::expected_tests;
use crate::math::{Aabb, DVec3, Vec3};

/// What things cost, in units of a step down the tree.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// A step down the tree.
    pub traversal_cost: f64,
    /// The test of a triangle of a leaf.
    pub intersection_cost: f64,
    /// The share that is taken off where one side is empty.
    pub empty_bonus: f64,
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
    pub fn choose_cheaper(best: Option<Self>, other: Self) -> Self {
        match best {
            Some(best) if best.cost <= other.cost => best,
            _ => other,
        }
    }
}

impl Costs {
    /// The cost of a leaf.
    pub fn leaf_cost(&self, triangles: usize) -> f64 {
        self.intersection_cost * triangles as f64
    }

    /// The cost of a part with that many triangles before it is built, as planes are judged.
    pub fn expected_cost(&self, triangles: usize) -> f64 {
        self.intersection_cost * expected_count(triangles)
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

/// Tests to expect in a part that is yet to be divided.
///
/// The greedy heuristic takes both parts for leaves, so it overrates the cost of many triangles
/// (Wald and Havran, "On building fast kd-trees", on the local greedy approximation) and cuts off
/// slivers where balance would save more steps. Of parts that are too large for a leaf, the cost
/// grows less than the count: ours by its power of three quarters. Powers of .7 to 1 from 16 to
/// 1024 triangles on were tried on two kitchens, the bunny, a robot cell and small scenes: this
/// one, which two square roots give, made the kitchens' trees cheapest by the exact sweep (.77 and
/// .95 of what the bare count gives) and the others' within 1 % of it. Of synthetic clutter, no
/// power is best: single trees scatter by several per cent.
#[inline]
fn expected_count(triangles: usize) -> f64 {
    const LINEAR: f64 = 256.0;
    let count = triangles as f64;
    if count <= LINEAR {
        return count;
    }
    let root = (count / LINEAR).sqrt();
    LINEAR * root * root.sqrt()
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
    /// Weighs dividing the cell with that many triangles below and above; `None` if the plane
    /// is not inside.
    #[inline]
    pub fn weigh(&self, axis: usize, split: f32, below: usize, above: usize) -> Option<Plane> {
        let (min, max) = (self.cell.min[axis], self.cell.max[axis]);
        if !(split > min && split < max) {
            return None;
        }
        let share = |low: f32, high: f32| {
            self.ends[axis] + self.sides[axis] * (f64::from(high) - f64::from(low))
        };
        let costs = self.costs;
        let bonus = if below == 0 || above == 0 { 1.0 - costs.empty_bonus } else { 1.0 };
        let (below, above) = (expected_count(below), expected_count(above));
        let tests = expected_tests([(share(min, split), below), (share(split, max), above)]);
        Some(Plane {
            axis,
            split,
            cost: costs.traversal_cost + bonus * costs.intersection_cost * tests,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_triangles_cost_more_but_of_many_less_than_the_count() {
        for n in 1..1000 {
            assert!(expected_count(n) > expected_count(n - 1), "{n}");
            assert_eq!(expected_count(n) < n as f64, n > 256, "{n}");
        }
    }

    #[test]
    fn a_plane_costs_a_step_and_its_sides_by_their_area() {
        let costs = Costs { traversal_cost: 1.0, intersection_cost: 2.0, empty_bonus: 0.5 };
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let costs = costs.in_cell(&unit);
        // Half a cube has two thirds of the area.
        let plane = costs.weigh(1, 0.5, 3, 6).expect("it is inside");
        let (three, six) = (expected_count(3), expected_count(6));
        assert!((plane.cost - (1.0 + 2.0 * (three + six) * 2.0 / 3.0)).abs() < 1e-12);
        let cut = costs.weigh(1, 0.5, 0, 6).expect("it is inside");
        assert!((cut.cost - (1.0 + 2.0 * 0.5 * six * 2.0 / 3.0)).abs() < 1e-12);
        assert_eq!(costs.weigh(1, 1.0, 3, 6), None);
    }
}
