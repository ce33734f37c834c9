//! Meshes and triangles, and the tests of rays against triangles and boxes.
//!
//! | file | what is in it |
//! |---|---|
//! | [`mod@intersect_triangle`] | the exact ray-triangle test, for one ray |
//! | `intersect_bundle` | the same for a bundle of eight rays |
//! | `intersect_pairs`, `ray_lanes` | the same for sixteen pairs of a ray and a triangle |
//! | [`block`] | the filter: many triangles against one ray |
//! | `moving_block` | the same for triangles that move |
//! | [`planes`] | the filter: rays in lanes against one triangle after the other |
//! | [`bundle`] | bundles of eight rays: the slab test and the filter |
//! | [`slab`] | the slab test, and why culling by it is exact |
//! | [`shaft`] | regions that hold rays, to cull boxes for all of them at once |
//! | `numbering` | one running number over the triangles of many meshes |
//! | `usable` | which rays can be traced, in lanes |
//! | `clip` | the part of a triangle in a box, for builders |
//! | `mesh`, `tangents`, `source` | meshes, their tangents, triangles in world space |

pub mod block;
pub mod bundle;
mod clip;
mod deformation;
mod heading;
mod intersect_bundle;
mod intersect_pairs;
pub mod intersect_triangle;
mod mesh;
mod moving_block;
mod numbering;
pub mod planes;
mod ray_lanes;
pub mod shaft;
mod sheared;
pub mod slab;
mod source;
mod tangents;
mod triangle;
mod usable;

pub use block::{BlockRef, TriangleBlock};
pub use bundle::{FilterTriangle, RayBundle};
pub use clip::clip_bounds;
pub use deformation::{Deformation, Posed, VertexKey};
pub use heading::Heading;
pub use intersect_bundle::BundleHits;
pub use intersect_pairs::{PairHits, PairTriangle};
pub use intersect_triangle::{ShearRay, intersect_triangle};
pub use mesh::Mesh;
pub use moving_block::{MovingBlock, MovingTriangle};
pub use numbering::Numbering;
pub use planes::{FilterLanes, FilterPlane, FilterSides, Reach};
pub use ray_lanes::RayLanes;
pub use shaft::Shaft;
pub use slab::{SlabRay, grow_own_box, own_box};
pub use source::{Motions, Placements, TriangleList, TriangleSource};
pub use tangents::add_tangents;
pub use triangle::{Corners, Triangle};
pub use usable::are_usable;
