//! Kd-trees for many rays at a time: section 4 of the review, and 5.3.
//!
//! A slice is cut into packets (`accel::packet`): blocks of its raster, or runs of rays. Packets of
//! rays that go the same way share a shaft. The tree and its leaves are those of the walks for
//! single rays. What the structures trade, and where they differ from their papers:
//!
//! `kd-packet` (`front_to_back`; 4.2, 4.6): a node is fetched and decided on once for up to 256
//! rays, eight at a time, as long as one of them crosses it. Packets whose rays head different ways
//! are split by heading. Ours stores where rays leave the cell of each level, not where they enter
//! it, and needs no masks: a ray crosses a cell if it enters before it leaves (`spans`). Use it for
//! primary rays, with `size=4` or 8 where triangles are small.
//!
//! `kd-packet-ropes` (`rope_walk`; 5.3): no stack of spans, but ropes from each face of each leaf.
//! It visits the fewest nodes, takes more memory, and looks for waiting rays after every leaf.
//! Meant for processors without memory for stacks; on others, for comparison.
//!
//! `kd-omnidirectional` and `kd-omnidirectional-origin` (`mixed`; 4.7): packets of rays that head
//! any way, with both ends of each span carried along and no early end. The first tells near
//! children by direction, the second by origin, which suits rays that fan out from one point. Ours
//! puts rays of one heading into the same bundles of eight, as the exact test requires. All slices
//! are walked like that: use them where rays begin close together and diverge.
//!
//! `kd-lcts` (`sequence`, `cone`; 4.1): the corners of a packet that starts at one point go through
//! the tree in place of its rays, as far as all corners go the same way; from there on the packet
//! itself. `kd-relevant-triangles` (4.3) does the same, and does not test triangles that the
//! corners show to be missed. They save steps in empty space for packets that are narrow beside the
//! cells; for all other packets they cost `kd-packet` and four distances a node.
//!
//! `kd-entry-point` (4.4, 4.5): packets start at the deepest node that holds all non-empty leaves
//! that their shaft meets. Tiles are packets: `tiles=N` by N, or divided until they are simple.
//! Reshetov et al. cut off empty space more eagerly when they build such trees; that is `empty=` of
//! all kd-trees. Ours stays at the default of 0.1: on the Stanford bunny 0.3 spends the tree's
//! levels on slivers and leaves four times the triangles to test, for 0.64 of the rate of primary
//! rays; on a kitchen it gains 3 % (Zen 4, AVX-512, `trace --counters`).
//!
//! `kd-path-compression` (sections 3.4 and 5.1 of Barczak's paper): packets in a tree of only those
//! nodes of which a slice's shaft meets leaves on both sides. In a kd-tree a node has no box, so
//! each branch holds those of its sides, and spans are narrowed by six planes where a node has one.
//! The paper asks what that is worth: the counters tell nodes and searched nodes apart.
//!
//! # Why no ray misses its hit
//! A packet's walk tests, for each ray, at least the leaves that the ray's own walk would come to,
//! and a ray ends only when it was hit strictly before the next cell. Distances are those of
//! [`super::ray::KdRay`]; ties go where [`super::ray::Crossing`] sends them.
//!
//! *Starting below the root*: if a ray comes to a leaf by itself, the point at some `t` of its span
//! there is within 2^-20 of the distance of each plane of the cell, which is what a shaft allows
//! for ([`crate::geom::shaft`]). So no shaft misses the cell of a leaf where one of its rays could
//! be hit, nor a cell around it, and such leaves are below the entry point or the branch. Spans
//! there are narrowed by planes that the way from the root would have used.
//!
//! A triangle is in about four leaves. Which rays of a packet have been tested against it is
//! remembered for a while (`leaf`), and they are not tested again.
//!
//! Rays that are not tame (see [`super`]), packets whose slopes differ by more than a half, and
//! groups of fewer than four rays take the walk of `kd-stack-direction`.

mod cells;
mod cone;
mod front_to_back;
mod leaf;
mod mixed;
mod packet_kd_tree;
mod rope_walk;
mod sequence;
mod slice;
mod spans;

pub use packet_kd_tree::{Algorithm, PacketKdTree};
