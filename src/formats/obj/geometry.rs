//! All that an OBJ file says of shapes.

use crate::math::{Vec2, Vec3};

/// An index that is not there.
pub(super) const NONE: u32 = u32::MAX;

/// All that an OBJ file says.
#[derive(Debug, Default)]
pub(super) struct Geometry {
    pub positions: Vec<Vec3>,
    /// As many as positions, in sRGB, where any vertex has a colour.
    pub colors: Vec<Vec3>,
    /// As in the file: v counts upwards.
    pub uvs: Vec<Vec2>,
    /// Of unit length, or zero where the file's is.
    pub normals: Vec<Vec3>,
    pub parts: Vec<Part>,
    /// Names of materials in the order of their first use, and the line of that.
    pub materials: Vec<(String, usize)>,
    /// Of each `mtllib` its line and what follows.
    pub libraries: Vec<(usize, String)>,
}

/// The polygons of one object, group and material.
#[derive(Debug)]
pub(super) struct Part {
    /// `object`, `group` or `object/group`.
    pub name: String,
    /// In [`Geometry::materials`].
    pub material: Option<usize>,
    /// The corners of all polygons, one after the other; all indices are valid.
    pub corners: Vec<Corner>,
    /// The number of corners of each polygon, at least three.
    pub polygons: Vec<u32>,
}

/// A corner of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Corner {
    pub position: u32,
    /// Or [`NONE`].
    pub uv: u32,
    /// Or [`NONE`].
    pub normal: u32,
}
