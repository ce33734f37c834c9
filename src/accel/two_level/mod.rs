//! Two levels: one structure of each mesh, in its own space, and one over placements.
//!
//! A forest of a few trees placed a million times takes the memory of the trees and of a million
//! boxes. Any row of the table may be at the bottom and any on top. The walks are the rows' own: to
//! the structure above, placements are primitives that are boxes; to the one below, a ray comes in
//! the mesh's space. Each asks a [`crate::accel::Verdict`] where it would ask the exact test.
//!
//! # Why hits are those of brute force, bit for bit
//! 1. *One exact test.* In the end the exact test is asked about the ray as it is and the
//!    triangle's vertices in the world, the same numbers as for a flat structure.
//! 2. *One winner.* Hits name placement and triangle, ordered as the running number is, and the
//!    smallest `(t, id)` wins on both levels.
//! 3. *Above*, the box of a placement holds the own boxes of its triangles in the world
//!    ([`placement::world_box`]), so that a hit lies in all boxes around it, as in a flat
//!    hierarchy.
//! 4. *Below*, boxes are grown by what the ways into the mesh's space may be off by, and the limit
//!    behind which boxes do not matter is raised likewise ([`placement`]); blocks of triangles
//!    filter with the same allowance ([`crate::geom::BlockRef::find_near`]). So all that the exact
//!    test might accept is offered to it.
//!
//! What is placed once, has few triangles or can't be taken into its own space with a small error
//! (it is singular, or rounded in the world to steps that are large for it) is flattened to
//! triangles in the world, and with it the smallest of the other meshes: a ray lies in the boxes of
//! many small parts, and entering one takes as long as some ten nodes.
//!
//! Hierarchies of eight children (`auto`, `mbvh8`) are walked together: one tree of what is
//! flattened and of parts of placements leads into those of the meshes. In all other rows, and in
//! these where anything moves, what is flattened has a structure beside the placements, asked
//! first; in the other rows, slices stay slices there and above, and come ray by ray below. Rows
//! for packets walk placements as packets, and meshes with packets of one. Structures that are
//! narrowed to regions are not, in two levels.
//!
//! # What moves
//! What moves while the shutter is open is always kept apart, whatever becomes of copies; all that
//! stands still is as it would be without. Each ray has a time ([`crate::Batch::with_times`]), and:
//!
//! 1. *Above*, the box of a placement holds what [`placement::world_box`] holds, at all times: it
//!    is the union over pieces of the time of the box in the middle of each, grown by how far
//!    anything can be from there ([`crate::motion::Motion::pieces`]). Placements also have boxes
//!    for parts of the time (`timed_boxes`). Hierarchies that are walked together have a tree of
//!    these for each part, and a ray enters that of its time; the other rows ask the box of the
//!    ray's time before they take it into the mesh's space. In the former, what has few triangles
//!    is in such trees triangle by triangle instead (`moving_triangles`), and what keeps its places
//!    to each other is one body (`bodies`). Where a few triangles are all that is kept apart, there
//!    is no tree (`few_moving`).
//! 2. *Below*, a mesh that keeps its shape is in its own space as ever: the way into it is that of
//!    the placement at the ray's time. What vertices may be off by is looked at for that time;
//!    where it is more than the mesh's boxes allow for, the ray is held against all triangles.
//!    Hierarchies that are walked together take a way that is found faster, but off by a little
//!    more, which the mesh's boxes allow for (`timed_ways`).
//! 3. A mesh that changes its shape has a structure for each of some pieces of the time
//!    (`spans`); a ray asks that of its own. It is one of boxes, one a triangle, that hold its own
//!    boxes over the piece ([`crate::geom::Deformation::own_box`]).
//! 4. The verdict asks the exact test about the vertices at the ray's time: the same numbers for
//!    every structure, and those that surfaces are shaded with.
//!
//! | file | what is in it |
//! |---|---|
//! | [`placement`] | a mesh where it is placed: its box, a ray in its space, errors |
//! | `division` | which placements are kept apart |
//! | `levels` | a scene as it is divided, and the ways into placements |
//! | `sources` | what the structures are built over |
//! | `spans` | the structures of meshes, by pieces of the time |
//! | `timed_boxes` | the boxes of what moves, by parts of the time |
//! | `timed_ways` | the ways into what moves, by parts of the time |
//! | `outline` | which rays are asked about where anything moves |
//! | `slab` | two planes between which all of that stays |
//! | `trees` | all trees that are walked together, in one piece of memory |
//! | `parts` | placements as that has them: whole or opened |
//! | `verdict` | who says what is hit on each level |
//! | `two_level` | both levels of any two rows |
//! | `levels_tracer` | what a thread asks of these |
//! | `wide_levels` | hierarchies of eight children on both levels |
//! | `wide` | the walk through them, in flight |
//! | `moving` | the same, of what moves |
//! | `moved` | where that is at a ray's time |
//! | `bodies` | which of what moves keep their places to each other |
//! | `body` | these, as one |
//! | `moving_triangles` | what moves and is small, triangle by triangle |
//! | `moving_blocks` | blocks of these, held against a ray |
//! | `few_moving` | these alone, where they are very few |
//! | `upper_trees` | the trees above the meshes |

mod bodies;
mod body;
mod division;
mod few_moving;
mod levels;
mod levels_tracer;
mod moved;
mod moving;
mod moving_blocks;
mod moving_triangles;
mod outline;
mod parts;
pub mod placement;
mod slab;
mod sources;
mod spans;
mod timed_boxes;
mod timed_ways;
mod trees;
#[allow(clippy::module_inception)] // what a reader looks for
mod two_level;
mod upper_trees;
mod verdict;
mod wide;
mod wide_levels;

pub use division::find_uses;
pub use sources::Placed;
pub use two_level::TwoLevel;
