//! Whether a tree is what it must be.

use std::collections::HashSet;

use super::tree::{KdTree, LeafId, Node, halves};
use crate::geom::own_box;
use crate::math::{Aabb, NodeId, TriangleId};

impl KdTree {
    /// Checks that cells tile the root's, that nodes and leaves are all used once, and that each
    /// triangle is in every leaf whose cell, grown by the slack, it touches.
    ///
    /// # Errors
    /// Says what is wrong.
    pub fn validate(&self) -> Result<(), String> {
        self.validate_cells()?;
        let lists: Vec<HashSet<TriangleId>> = (0..self.base.leaves.len())
            .map(|leaf| self.base.leaves.triangles(LeafId(leaf as u32)).collect())
            .collect();
        for i in 0..self.base.source.len() {
            let id = TriangleId::from_index(i);
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
                    let [low, high] = halves(&cell, axis, split);
                    todo.push((above, high, depth + 1));
                    todo.push((NodeId(at.0 + 1), low, depth + 1));
                }
            }
        }
        if next != self.nodes.len() || leaves != self.base.leaves.len() {
            return Err(format!("{next} nodes and {leaves} leaves are reached"));
        }
        Ok(())
    }

    fn validate_triangle(
        &self,
        id: TriangleId,
        lists: &[HashSet<TriangleId>],
    ) -> Result<(), String> {
        // Boxes were rounded when they were grown: hold the tree to seven eighths.
        let slack = 0.875 * self.base.slack.delta;
        let own = own_box(&self.base.source.triangle(id));
        let grown = Aabb { min: own.min - slack, max: own.max + slack };
        let mut todo = vec![NodeId(0)];
        while let Some(at) = todo.pop() {
            match self.nodes[at.index()] {
                Node::Leaf(leaf) if !lists[leaf.index()].contains(&id) => {
                    return Err(format!("triangle {} is missing in leaf {}", id.0, leaf.0));
                }
                Node::Leaf(_) => {}
                Node::Inner { axis, split, above } => {
                    let axis = axis as usize;
                    if grown.min[axis] <= split {
                        todo.push(NodeId(at.0 + 1));
                    }
                    if grown.max[axis] >= split {
                        todo.push(above);
                    }
                }
            }
        }
        Ok(())
    }
}
