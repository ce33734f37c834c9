//! Attributes of vertices, interpolated at a point of a triangle.

use crate::geom::Mesh;
use crate::math::{MeshId, Vec2, Vec3, Vec4};
use crate::scene::Scene;

/// What the vertices of a mesh say of the colour at a point between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attributes {
    /// The first two sets of texture coordinates; zero where the mesh has none or no texture asks.
    pub uv: [Vec2; 2],
    /// How wide the path that looks here is, along each set: the side of a square; zero: a point.
    pub footprint: [f32; 2],
    /// Where further sets are looked up; none: the mesh has none.
    pub further: Option<Further>,
    /// Linear colour and alpha that multiply the base colour.
    pub color: Vec4,
}

impl Attributes {
    /// Those of a mesh that says nothing.
    pub const NONE: Self =
        Self { uv: [Vec2::ZERO; 2], footprint: [0.0; 2], further: None, color: Vec4::ONE };

    /// The texture coordinates of a set of any number, and how wide the path is along it.
    #[inline]
    pub(super) fn uv_set(&self, scene: &Scene, number: u32) -> (Vec2, f32) {
        match self.uv.get(number as usize) {
            Some(&uv) => (uv, self.footprint[number as usize]),
            None => self.further_set(scene, number),
        }
    }

    /// Few materials look up more sets than two: the others are interpolated where they are asked
    /// for.
    #[cold]
    fn further_set(&self, scene: &Scene, number: u32) -> (Vec2, f32) {
        let Some(Further { mesh, triangle, mirrored, at, spread }) = self.further else {
            return (Vec2::ZERO, 0.0);
        };
        let mesh = &scene.meshes[mesh.index()];
        let point = Interpolation::new(mesh, triangle as usize, mirrored, at.x, at.y);
        let all = mesh.uv_set(number as usize);
        if all.is_empty() {
            return (Vec2::ZERO, 0.0);
        }
        let footprint = if spread > 0.0 { spread * point.uv_area(all).sqrt() } else { 0.0 };
        (point.vec2(all), footprint)
    }
}

/// A point of a mesh that has more than two sets of texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Further {
    mesh: MeshId,
    triangle: u32,
    mirrored: bool,
    /// The weights of the second and third corner.
    at: Vec2,
    /// How wide the path is, by the root of the triangle's area.
    spread: f32,
}

/// Corners and weights of a point in a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interpolation {
    pub corners: [usize; 3],
    weights: [f32; 3],
    triangle: usize,
    mirrored: bool,
}

impl Interpolation {
    /// The point of a hit. `u` and `v` belong to the triangle as the world sees it, which has its
    /// last two corners exchanged where the instance is mirrored.
    pub fn new(mesh: &Mesh, triangle: usize, mirrored: bool, u: f32, v: f32) -> Self {
        let [a, b, c] = mesh.indices[triangle].map(|i| i as usize);
        let corners = if mirrored { [a, c, b] } else { [a, b, c] };
        Self { corners, weights: [1.0 - u - v, u, v], triangle, mirrored }
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

    /// What the mesh, which has that number, says of the point's colour; `textured`: whether
    /// anybody asks for the texture coordinates.
    #[inline]
    pub fn attributes(&self, (id, mesh): (MeshId, &Mesh), textured: bool) -> Attributes {
        let mut attributes = Attributes::NONE;
        if textured {
            for (uv, all) in attributes.uv.iter_mut().zip(&mesh.uvs) {
                *uv = if all.is_empty() { Vec2::ZERO } else { self.vec2(all) };
            }
            if !mesh.more_uvs.is_empty() {
                let [_, u, v] = self.weights;
                attributes.further = Some(Further {
                    mesh: id,
                    triangle: self.triangle as u32,
                    mirrored: self.mirrored,
                    at: Vec2::new(u, v),
                    spread: 0.0,
                });
            }
        }
        if !mesh.colors.is_empty() {
            attributes.color = self.vec4(|i| mesh.colors[i]);
        }
        attributes
    }

    /// Tells attributes how wide along each set of texture coordinates a path is that is `width`
    /// metres wide on the triangle, whose area is `area`: by the ratio of both areas
    /// (Akenine-Möller et al. 2019).
    pub fn widen(&self, attributes: &mut Attributes, mesh: &Mesh, area: f32, width: f32) {
        if area <= 0.0 {
            return;
        }
        for (footprint, all) in attributes.footprint.iter_mut().zip(&mesh.uvs) {
            if !all.is_empty() {
                *footprint = width * (self.uv_area(all) / area).sqrt();
            }
        }
        if let Some(further) = &mut attributes.further {
            further.spread = width / area.sqrt();
        }
    }

    /// The triangle's area in a set of texture coordinates.
    fn uv_area(&self, all: &[Vec2]) -> f32 {
        let [a, b, c] = self.corners.map(|i| all[i]);
        0.5 * (b - a).perp_dot(c - a).abs()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    /// A set is looked up alike whatever its number is.
    #[test]
    fn further_sets_are_as_the_first() {
        let uvs = vec![Vec2::new(0.1, 0.7), Vec2::new(0.9, 0.3), Vec2::new(0.4, 2.0)];
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            uvs: [uvs.clone(), Vec::new()],
            more_uvs: vec![Vec::new(), uvs],
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let scene = Scene { meshes: vec![Arc::new(mesh)], ..Scene::default() };
        for mirrored in [false, true] {
            let point = Interpolation::new(&scene.meshes[0], 0, mirrored, 0.3, 0.6);
            let at = (MeshId(0), &*scene.meshes[0]);
            let mut attributes = point.attributes(at, true);
            let first = attributes.uv_set(&scene, 0);
            assert!(first.0 != Vec2::ZERO && first.1 == 0.0);
            assert_eq!(attributes.uv_set(&scene, 3), first);
            point.widen(&mut attributes, at.1, 0.5, 0.01);
            let (first, further) = (attributes.uv_set(&scene, 0), attributes.uv_set(&scene, 3));
            assert_eq!(further.0, first.0);
            assert!(first.1 > 0.0 && (further.1 / first.1 - 1.0).abs() < 1e-6);
            for none in [1, 2, 4, u32::MAX] {
                assert_eq!(attributes.uv_set(&scene, none), (Vec2::ZERO, 0.0));
            }
        }
        // A mesh that has no more than two has nowhere to look.
        assert_eq!(Attributes::NONE.uv_set(&scene, 3), (Vec2::ZERO, 0.0));
        assert_eq!(size_of::<Attributes>(), 64);
    }
}
