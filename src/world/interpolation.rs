//! Attributes of vertices, interpolated at a point of a triangle.

use crate::geom::Mesh;
use crate::math::{Vec2, Vec3, Vec4};

/// What the vertices of a mesh say of the colour at a point between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attributes {
    /// Both sets of texture coordinates; zero where the mesh has none or no texture asks.
    pub uv: [Vec2; 2],
    /// How wide the path that looks here is, along each set: the side of a square; zero: a point.
    pub footprint: [f32; 2],
    /// Linear colour and alpha that multiply the base colour.
    pub color: Vec4,
}

impl Attributes {
    /// Those of a mesh that says nothing.
    pub const NONE: Self = Self { uv: [Vec2::ZERO; 2], footprint: [0.0; 2], color: Vec4::ONE };
}

/// Corners and weights of a point in a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interpolation {
    pub corners: [usize; 3],
    weights: [f32; 3],
}

impl Interpolation {
    /// The point of a hit. `u` and `v` belong to the triangle as the world sees it, which has its
    /// last two corners exchanged where the instance is mirrored.
    pub fn new(mesh: &Mesh, triangle: usize, mirrored: bool, u: f32, v: f32) -> Self {
        let [a, b, c] = mesh.indices[triangle].map(|i| i as usize);
        let corners = if mirrored { [a, c, b] } else { [a, b, c] };
        Self { corners, weights: [1.0 - u - v, u, v] }
    }

    /// The attribute of the point.
    pub fn vec2(&self, values: &[Vec2]) -> Vec2 {
        let [a, b, c] = self.corners.map(|i| values[i]);
        a * self.weights[0] + b * self.weights[1] + c * self.weights[2]
    }

    /// The attribute of the point.
    #[inline(always)]
    pub fn vec3(&self, value: impl Fn(usize) -> Vec3) -> Vec3 {
        let [a, b, c] = self.corners.map(value);
        a * self.weights[0] + b * self.weights[1] + c * self.weights[2]
    }

    /// The attribute of the point.
    #[inline(always)]
    pub fn vec4(&self, value: impl Fn(usize) -> Vec4) -> Vec4 {
        let [a, b, c] = self.corners.map(value);
        a * self.weights[0] + b * self.weights[1] + c * self.weights[2]
    }

    /// What the mesh says of the point's colour; `textured`: whether anybody asks for the texture
    /// coordinates.
    #[inline]
    pub fn attributes(&self, mesh: &Mesh, textured: bool) -> Attributes {
        let mut attributes = Attributes::NONE;
        if textured {
            for (uv, all) in attributes.uv.iter_mut().zip(&mesh.uvs) {
                *uv = if all.is_empty() { Vec2::ZERO } else { self.vec2(all) };
            }
        }
        if !mesh.colors.is_empty() {
            attributes.color = self.vec4(|i| mesh.colors[i]);
        }
        attributes
    }

    /// How wide along each set of texture coordinates a path is that is `width` metres wide on the
    /// triangle, whose area is `area`: by the ratio of both areas (Akenine-Möller et al. 2019).
    pub fn footprint(&self, mesh: &Mesh, area: f32, width: f32) -> [f32; 2] {
        mesh.uvs.each_ref().map(|all| {
            if all.is_empty() || area <= 0.0 {
                return 0.0;
            }
            let [a, b, c] = self.corners.map(|i| all[i]);
            let uv_area = 0.5 * (b - a).perp_dot(c - a).abs();
            width * (uv_area / area).sqrt()
        })
    }
}
