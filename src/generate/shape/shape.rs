//! What every shape can do.

use std::fmt::Debug;

use crate::generate::tessellation::Tessellation;

/// Something with a surface.
pub trait Shape: Debug + Send + Sync {
    /// Triangles at a level of detail: never fewer at a higher level, 1 at least.
    fn count(&self, level: u32) -> u64;

    /// As many triangles as [`Shape::count`] says, none without area.
    fn build(&self, level: u32) -> Tessellation;

    /// About the distance of its farthest points, metres.
    fn extent(&self) -> f64;
}
