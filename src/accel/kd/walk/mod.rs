//! Walks: which nodes a ray visits, in which order. They know nothing of builds.

pub mod backtrack;
pub mod branchless;
pub mod front_to_back;
mod interface;
pub mod leaf_by_leaf;
pub mod plane_points;
pub mod prefetch;
mod robust;
pub mod todo;
mod visit;
mod walked;
pub mod wide;

pub use interface::Walk;
pub use visit::{Visit, With};
pub use walked::Walked;
