//! Three levels at a step: a wide node of seven planes, and the spans of its eight children at
//! once.
//!
//! Not in the review. The plain stack's arithmetic by vector instructions: the distances to all
//! planes of a wide node, [`KdRay::t_split`]'s lane by lane; then for each child what is left of
//! the node's span, up to the nearest plane that it lies in front of, from the farthest that it
//! lies behind. Cells don't overlap, so neither do the spans of those children that are crossed,
//! and where they begin gives their order. A ray branches once for three levels, where it can
//! hardly be guessed, in place of six times; meets no empty leaves; and waits for memory once for
//! three levels, and once for a leaf (see [`super::super::wide_nodes`]). The tree is made for it: a
//! step of a vector is cheap and a miss of the cache is not, so leaves are large.
//!
//! By the tie rule of all walks, a child is crossed if what is left of the span has a length. A
//! span that is a point has none; such rays are rare and take the walk of those that are not tame.
//!
//! The idea is that of multi bounding volume hierarchies (M. Ernst, G. Greiner, 2008), done to the
//! subtrees of three levels that V. Havran put on a cache line (1999).

use std::ops::ControlFlow;
use std::sync::Arc;

use fearless_simd::{
    Bytes, Level, Select, Simd, SimdBase, SimdFloat, SimdMask, f32x8, i32x8, u32x8,
};

use super::robust;
use super::visit::{Visit, With, find_span};
use crate::accel::kd::layout::{Compact, Layout, Nodes};
use crate::accel::kd::ray::{KdRay, Span};
use crate::accel::kd::tree::{Base, KdTree};
use crate::accel::kd::wide_nodes::{Block, Child, Target, WideNode, WideNodes};
use crate::accel::{
    BuildError, Built, Counters, Event, MemoryReport, Query, RayContext, Structure, WalkRay,
};
use crate::simd::pick;

/// Walks by wide nodes.
pub struct WideWalk {
    base: Arc<Base>,
    wide: WideNodes,
    /// For rays that are not tame.
    nodes: Compact,
    built: Built,
}

impl WideWalk {
    /// Lays a tree out to walk it.
    ///
    /// # Errors
    /// If the tree is too deep for the stack.
    pub fn new(tree: &KdTree, level: Level) -> Result<Self, BuildError> {
        const LIMIT: usize = 64;
        if tree.depth() > LIMIT {
            return Err(BuildError::TooDeep { depth: tree.depth(), limit: LIMIT });
        }
        Ok(Self {
            base: Arc::clone(&tree.base),
            wide: WideNodes::new(tree)?,
            nodes: Compact::new(tree),
            built: Built { level, report: tree.report.clone() },
        })
    }
}

/// Entries of a stack: seven for each third level, and some to spare.
const ENTRIES: usize = 256;
const MASK: usize = ENTRIES - 1;

/// A child with the span in which it is crossed.
#[derive(Clone, Copy, Debug)]
struct Entry {
    child: Child,
    span: Span,
}

/// Children that wait, the farthest at the bottom.
pub struct Stack([Entry; ENTRIES]);

impl Stack {
    /// Hands out the nearest of a wide node's children that are crossed, if any, and puts the
    /// others on top.
    #[inline(always)]
    fn put(&mut self, children: &Children, node: &WideNode, top: &mut usize) -> Option<Entry> {
        let entry = |child: u32| {
            let child = child as usize & 7;
            let span = Span { enter: children.enter[child], exit: children.exit[child] };
            Entry { child: node.children[child], span }
        };
        let mut left = children.crossed;
        if left == 0 {
            return None;
        }
        let mut nearest = entry(left.trailing_zeros());
        left &= left - 1;
        let bottom = *top;
        while left != 0 {
            let other = entry(left.trailing_zeros());
            left &= left - 1;
            let is_nearer = other.span.enter < nearest.span.enter;
            let (near, far) = if is_nearer { (other, nearest) } else { (nearest, other) };
            nearest = near;
            let mut place = *top;
            while place > bottom && self.0[(place - 1) & MASK].span.enter < far.span.enter {
                self.0[place & MASK] = self.0[(place - 1) & MASK];
                place -= 1;
            }
            self.0[place & MASK] = far;
            *top += 1;
        }
        Some(nearest)
    }
}

/// The spans of a wide node's children.
struct Children {
    enter: [f32; 8],
    exit: [f32; 8],
    /// A bit for each that is crossed and not empty.
    crossed: u32,
}

impl Children {
    /// How many are crossed beside the nearest.
    #[inline(always)]
    fn others(&self) -> u32 {
        self.crossed.count_ones().saturating_sub(1)
    }
}

/// A ray, prepared for wide nodes: origin and reciprocal direction by axis, and the same once more,
/// as lanes are picked modulo eight.
struct Planes<S: Simd> {
    origin: f32x8<S>,
    inverse: f32x8<S>,
}

impl<S: Simd> Planes<S> {
    #[inline(always)]
    fn new(simd: S, ray: &KdRay) -> Self {
        let twice = |[x, y, z]: [f32; 3]| f32x8::load_array(simd, [x, y, z, x, x, y, z, x]);
        Self {
            origin: twice([ray.origin(0), ray.origin(1), ray.origin(2)]),
            inverse: twice([ray.inverse(0), ray.inverse(1), ray.inverse(2)]),
        }
    }

    /// The spans of a wide node's children within its own.
    #[inline(always)]
    fn children(&self, simd: S, node: &WideNode, span: Span) -> Children {
        /// On each level, the plane of each child, and a sign where the child is above it.
        const PLANE: [[u32; 8]; 3] = [[0; 8], [1, 1, 1, 1, 2, 2, 2, 2], [3, 3, 4, 4, 5, 5, 6, 6]];
        const UP: i32 = i32::MIN;
        const ABOVE: [[i32; 8]; 3] = [
            [0, 0, 0, 0, UP, UP, UP, UP],
            [0, 0, UP, UP, 0, 0, UP, UP],
            [0, UP, 0, UP, 0, UP, 0, UP],
        ];
        const SHIFT: [u32; 8] = [0, 2, 4, 6, 8, 10, 12, 14];
        let load = |values: &[u32; 8]| u32x8::load_array(simd, *values);
        let axes = u32x8::splat(simd, node.planes[7]) >> load(&SHIFT);
        let inverse = pick(simd, self.inverse, axes);
        let splits = f32x8::from_bits(load(&node.planes));
        let t = (splits - pick(simd, self.origin, axes)) * inverse;
        let mut enter = f32x8::splat(simd, span.enter);
        let mut exit = f32x8::splat(simd, span.exit);
        for level in 0..3 {
            let plane = load(&PLANE[level]);
            let t = pick(simd, t, plane);
            let sign: i32x8<S> = pick(simd, inverse, plane).to_bits().bitcast();
            // A child lies behind a plane if it is above and the ray goes up, or neither.
            let behind = (sign ^ i32x8::load_array(simd, ABOVE[level])).simd_lt(0);
            enter = behind.select(enter.max(t), enter);
            exit = behind.select(exit, exit.min(t));
        }
        let crossed = enter.simd_lt(exit).to_bitmask() as u32 & node.occupied();
        Children { enter: enter.to_array(), exit: exit.to_array(), crossed }
    }
}

impl WideWalk {
    #[inline(always)]
    fn descend<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        span: Span,
        stack: &mut Stack,
    ) {
        let planes = Planes::new(context.simd, &KdRay::new(&context.ray.ray));
        let mut next = Entry { child: Child::ROOT, span };
        let mut top = 0;
        loop {
            match self.wide.follow(next.child) {
                Target::Node(node) => {
                    context.counters.count(Event::InnerNode);
                    let children = planes.children(context.simd, node, next.span);
                    context.counters.add(Event::Push, u64::from(children.others()));
                    if let Some(nearest) = stack.put(&children, node, &mut top) {
                        next = nearest;
                        continue;
                    }
                }
                Target::Leaf(blocks) => {
                    context.counters.count(Event::Leaf);
                    if test_leaf(context, blocks).is_break() {
                        return;
                    }
                }
            }
            if top == 0 {
                return;
            }
            top -= 1;
            next = stack.0[top & MASK];
            // All that wait lie behind it.
            if next.span.enter > context.query.t_max() {
                return;
            }
        }
    }
}

#[inline(always)]
fn test_leaf<S: Simd, Q: Query, C: Counters>(
    context: &mut RayContext<'_, S, Q, C>,
    blocks: &[Block],
) -> ControlFlow<()> {
    for block in blocks {
        context.test_block(block.parts())?;
    }
    ControlFlow::Continue(())
}

impl Structure for WideWalk {
    type Scratch = (Stack, robust::Todo);

    fn scratch(&self) -> Self::Scratch {
        let nothing = Entry { child: Child::ROOT, span: Span { enter: 0.0, exit: 0.0 } };
        (Stack([nothing; ENTRIES]), robust::Todo::default())
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let mut parts = vec![("nodes", self.nodes.bytes())];
        parts.extend(self.wide.memory());
        parts.extend(self.base.leaves.memory());
        MemoryReport::new(parts)
    }
}

impl WalkRay for WideWalk {
    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        (stack, todo): &mut Self::Scratch,
    ) {
        let is_tame = self.base.slack.is_tame(&context.ray.ray);
        let span = find_span(&self.base, context.ray, context.query.t_max());
        if is_tame && span.is_none() {
            return;
        }
        // A span that is a point has no part in any child.
        if let Some(span) = span.filter(|span| is_tame && span.enter < span.exit) {
            self.descend(context, span, stack);
        } else {
            let leaf_test = &With(context.simd);
            robust::walk(&self.nodes, &mut Visit::new(&self.base, context, leaf_test), todo);
        }
    }
}
