//! `mbvh4`, `mbvh8`, `mbvh16`: hierarchies of nodes with as many children as a vector has lanes.
//!
//! M. Ernst and G. Greiner, "Multi bounding volume hierarchies", 2008. A node's children are tested
//! by one stream of vector instructions, and so are a leaf's triangles. A binary tree is built
//! first and collapsed (`collapse`, `optimal`), or none (`direct`), and its `shape` written into
//! one `arena`, small leaves side by side (`share`).
//! A ray walks by algorithm 2 of the paper, its children ordered by distance, or by the direction's
//! octant as in the paper (`octants`), and a slice of rays is walked with sixteen of them in flight
//! (`flight`). There, where any hit will do, they are taken as they come: sorting them costs up to
//! 15 % and gains 4 at most. Rays of a pinhole may go down together instead, sixteen at a time
//! (`packet_walk`).

pub mod arena;
mod beam;
mod collapse;
mod direct;
mod flight;
pub mod node;
mod octants;
mod optimal;
mod packet;
mod packet_walk;
mod shape;
mod share;
pub mod stack;
mod variants;
pub mod wide_bvh;

pub use variants::{AUTO, MBVH4, MBVH8, MBVH16, build_auto_tree};
