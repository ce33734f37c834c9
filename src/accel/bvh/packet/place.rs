//! Places in the hierarchy: a node or leaf by the box that its parent has of it.

use crate::accel::bvh::binary::Bvh2;
use crate::accel::bvh::link::Link;
use crate::accel::narrowing::Hierarchy;
use crate::math::{Aabb, Vec3};

/// A child of a node: the node's place and the child's side. The root is nobody's child.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place(u32);

impl Place {
    /// The root.
    pub const ROOT: Self = Self(u32::MAX);

    /// The children of a node.
    #[inline(always)]
    pub fn children(node: usize) -> [Self; 2] {
        let first = (node as u32) << 1;
        [Self(first), Self(first | 1)]
    }

    #[inline(always)]
    fn node_and_side(self) -> (usize, usize) {
        ((self.0 >> 1) as usize, (self.0 & 1) as usize)
    }
}

/// A hierarchy by its places.
#[derive(Clone, Copy)]
pub struct Places<'a> {
    pub bvh: &'a Bvh2,
    /// What the root leads to.
    pub root: Link,
}

impl Places<'_> {
    /// What lies there.
    #[inline(always)]
    pub fn link(&self, place: Place) -> Link {
        if place == Place::ROOT {
            return self.root;
        }
        let (node, side) = place.node_and_side();
        self.bvh.nodes[node].children[side]
    }

    /// Twice the way from the middle of an inner node's first child to that of its second.
    #[inline(always)]
    pub fn apart(&self, place: Place) -> Vec3 {
        let node = &self.bvh.nodes[self.link(place).place()];
        let [first, second] = [node.bounds(0), node.bounds(1)];
        (second.min + second.max) - (first.min + first.max)
    }
}

impl Hierarchy for Places<'_> {
    type Place = Place;

    /// All of space for the root.
    #[inline(always)]
    fn bounds(&self, place: Place) -> Aabb {
        if place == Place::ROOT {
            return Aabb { min: Vec3::MIN, max: Vec3::MAX };
        }
        let (node, side) = place.node_and_side();
        self.bvh.nodes[node].bounds(side)
    }

    #[inline(always)]
    fn children(&self, place: Place) -> Option<[Place; 2]> {
        let link = self.link(place);
        (!link.is_leaf()).then(|| Place::children(link.place()))
    }

    #[inline(always)]
    fn is_empty(&self, _: Place) -> bool {
        false
    }
}
