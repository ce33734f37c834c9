//! Triangles under construction.

use crate::math::DVec3;

/// A corner: where it is, and which way the surface faces there.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// In the space of its part, metres.
    pub position: [f32; 3],
    /// Of unit length.
    pub normal: [f32; 3],
}

/// Triangles over shared vertices, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tessellation {
    /// The corners.
    pub vertices: Vec<Vertex>,
    /// Three corners a triangle.
    pub indices: Vec<[u32; 3]>,
}

impl Tessellation {
    /// Adds a corner; `normal` need not be of unit length.
    pub fn vertex(&mut self, position: DVec3, normal: DVec3) -> u32 {
        let normal = normal.normalize_or(DVec3::Y).as_vec3().to_array();
        self.vertices.push(Vertex { position: position.as_vec3().to_array(), normal });
        self.vertices.len() as u32 - 1
    }

    /// Turns all corners to face as the triangles around them do, by their areas.
    pub fn face_as_triangles(&mut self) {
        let mut sums = vec![DVec3::ZERO; self.vertices.len()];
        for triangle in &self.indices {
            let corner =
                |i: usize| DVec3::from(self.vertices[triangle[i] as usize].position.map(f64::from));
            let face = (corner(1) - corner(0)).cross(corner(2) - corner(0));
            for &i in triangle {
                sums[i as usize] += face;
            }
        }
        for (vertex, sum) in self.vertices.iter_mut().zip(sums) {
            vertex.normal = sum.normalize_or(DVec3::Y).as_vec3().to_array();
        }
    }

    /// Adds a triangle, unless two of its corners are one.
    pub fn triangle(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners;
        if a != b && b != c && c != a {
            self.indices.push(corners);
        }
    }

    /// Adds a face of four sides, counter-clockwise.
    pub fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    /// Adds a flat face of four sides that shares no corner with others.
    pub fn flat_quad(&mut self, corners: [DVec3; 4]) {
        let [a, b, _, d] = corners;
        let normal = (b - a).cross(d - a);
        let corners = corners.map(|corner| self.vertex(corner, normal));
        self.quad(corners);
    }

    /// Joins two rows of as many corners: the front is where (along the row) × (from `lower` to
    /// `upper`) points.
    pub fn band(&mut self, lower: &[u32], upper: &[u32], closed: bool) {
        let columns = if closed { lower.len() } else { lower.len() - 1 };
        for i in 0..columns {
            let next = (i + 1) % lower.len();
            self.quad([lower[i], lower[next], upper[next], upper[i]]);
        }
    }

    /// Joins the corners of a closed row with one point; `above`: the point is where a band's
    /// `upper` would be.
    pub fn fan(&mut self, point: u32, row: &[u32], above: bool) {
        for i in 0..row.len() {
            let (here, next) = (row[i], row[(i + 1) % row.len()]);
            self.triangle(if above { [here, next, point] } else { [point, next, here] });
        }
    }

    /// The smallest and the largest coordinates.
    pub fn bounds(&self) -> [[f32; 3]; 2] {
        let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for vertex in &self.vertices {
            for (axis, &x) in vertex.position.iter().enumerate() {
                bounds[0][axis] = bounds[0][axis].min(x);
                bounds[1][axis] = bounds[1][axis].max(x);
            }
        }
        bounds
    }
}
