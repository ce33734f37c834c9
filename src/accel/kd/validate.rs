//! Whether a tree is what it must be.

use std::collections::HashSet;

use super::tree::{KdTree, LeafId, Node, split_cell};
use crate::geom::Triangle;
use crate::math::{Aabb, DVec3, NodeId, PrimId};

impl KdTree {
    /// Checks that cells tile the root's, that nodes and leaves are all used once, and that each
    /// triangle is in every leaf whose cell, grown by the slack, it touches.
    ///
    /// # Errors
    /// Says what is wrong.
    pub fn validate(&self) -> Result<(), String> {
        self.validate_cells()?;
        let leaves = &self.base.leaves;
        let ids = |leaf| leaves.triangles(LeafId(leaf)).iter().map(|&slot| leaves.id(slot));
        let lists: Vec<HashSet<PrimId>> =
            (0..leaves.count() as u32).map(|leaf| ids(leaf).collect()).collect();
        for i in 0..self.base.source.len() {
            let id = PrimId::from_index(i);
            self.validate_triangle(id, &lists)?;
        }
        Ok(())
    }

    fn validate_cells(&self) -> Result<(), String> {
        let (mut next, mut leaves) = (0, 0);
        let mut todo = vec![(NodeId(0), self.base.bounds, 0)];
        while let Some((at, cell, depth)) = todo.pop() {
            if at.index() != next {
                return Err(format!("node {next} is not in depth-first order"));
            }
            next += 1;
            if depth > self.depth() {
                return Err(format!("node {} is at depth {depth}", at.0));
            }
            match self.nodes.get(at.index()) {
                None => return Err(format!("node {} is not there", at.0)),
                Some(&Node::Leaf(leaf)) if leaf.index() == leaves => leaves += 1,
                Some(Node::Leaf(leaf)) => return Err(format!("leaf {} is not next", leaf.0)),
                Some(&Node::Inner { axis, split, above }) => {
                    let axis = axis as usize;
                    if !(cell.min[axis] < split && split < cell.max[axis]) {
                        return Err(format!("plane {split} of node {} is outside", at.0));
                    }
                    let [low, high] = split_cell(&cell, axis, split);
                    todo.push((above, high, depth + 1));
                    todo.push((NodeId(at.0 + 1), low, depth + 1));
                }
            }
        }
        if next != self.nodes.len() || leaves != self.base.leaves.count() {
            return Err(format!("{next} nodes and {leaves} leaves are reached"));
        }
        Ok(())
    }

    fn validate_triangle(&self, id: PrimId, lists: &[HashSet<PrimId>]) -> Result<(), String> {
        let slack = self.base.slack.kept;
        let triangle = self.base.source.triangle(id);
        let grow = |b: &Aabb| Aabb { min: b.min - slack, max: b.max + slack };
        let grown = grow(&triangle.bounds());
        let mut todo = vec![(NodeId(0), KdTree::SPACE)];
        while let Some((at, cell)) = todo.pop() {
            match self.nodes[at.index()] {
                Node::Leaf(leaf) => {
                    let listed = lists[leaf.index()].contains(&id);
                    // With infinite planes there is nothing to project on: clip them to the box.
                    let cell = grow(&cell.intersection(self.base.bounds));
                    if !listed && touches(&triangle, &cell) {
                        return Err(format!("triangle {} is missing in leaf {}", id.0, leaf.0));
                    }
                }
                Node::Inner { axis, split, above } => {
                    let axis = axis as usize;
                    let [low, high] = split_cell(&cell, axis, split);
                    if grown.min[axis] <= split {
                        todo.push((NodeId(at.0 + 1), low));
                    }
                    if grown.max[axis] >= split {
                        todo.push((above, high));
                    }
                }
            }
        }
        Ok(())
    }
}

/// Whether a triangle touches a box: no axis parts them, of the box's three, the triangle's normal
/// and the nine products of edges (Gottschalk, Lin and Manocha 1996).
fn touches(triangle: &Triangle, bounds: &Aabb) -> bool {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let (centre, half) = ((min + max) * 0.5, (max - min) * 0.5);
    let corners = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3() - centre);
    let edges = [corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]];
    let parted = |axis: DVec3| {
        let along = corners.map(|p| p.dot(axis));
        let reach = half.dot(axis.abs());
        along.iter().all(|&x| x > reach) || along.iter().all(|&x| x < -reach)
    };
    let products = edges
        .into_iter()
        .flat_map(|edge| DVec3::AXES.into_iter().map(move |axis| edge.cross(axis)));
    !DVec3::AXES.into_iter().chain([edges[0].cross(edges[1])]).chain(products).any(parted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::kd::build::OPTIONS;
    use crate::accel::{Options, Steps};
    use crate::geom::{TriangleList, TriangleSource};
    use crate::math::Vec3;
    use std::sync::Arc;

    #[test]
    fn a_plane_that_was_moved_is_found() {
        let corner = |i: usize| Vec3::new((i * i % 37) as f32, (i * 7 % 31) as f32, i as f32);
        let list = (0..200).map(|i| {
            let a = corner(i);
            Triangle { a, b: a + Vec3::X * 3.0, c: a + Vec3::new(1.0, 2.0, 3.0) }
        });
        let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(list.collect()));
        for build in ["sah", "minmax", "binned"] {
            let options = Options::parse("kd", &OPTIONS, &format!("build={build}"));
            let tree = KdTree::build(&source, &options.expect("it is known"), &Steps::untold())
                .expect("it is small");
            assert_eq!(tree.validate(), Ok(()), "{build}");
            // Far enough that a triangle lies between the old plane and the new one.
            for by in [2.0, 1e9] {
                let mut moved = tree.clone();
                let Node::Inner { split, .. } = &mut moved.nodes[0] else { panic!("one leaf") };
                *split += by;
                assert!(moved.validate().is_err(), "{build}, {by}");
            }
        }
    }

    #[test]
    fn boxes_beside_the_long_side_are_not_touched() {
        let half = Triangle { a: Vec3::ZERO, b: Vec3::X * 4.0, c: Vec3::Y * 4.0 };
        let around = |at: Vec3| Aabb { min: at - 0.4, max: at + 0.4 };
        assert!(touches(&half, &around(Vec3::new(2.0, 2.0, 0.0))));
        assert!(!touches(&half, &around(Vec3::new(2.5, 2.5, 0.0))));
        assert!(!touches(&half, &around(Vec3::new(1.0, 1.0, 0.5))));
    }
}
