//! Shapes of triangles.

use std::f64::consts::{PI, TAU};

use dapple::math::{DVec3, Vec3};

/// Triangles over shared vertices.
#[derive(Clone, Default)]
pub struct Shape {
    pub positions: Vec<[f32; 3]>,
    /// Empty: flat.
    pub normals: Vec<[f32; 3]>,
    /// Two sets, either possibly empty.
    pub uvs: [Vec<[f32; 2]>; 2],
    /// Linear colours and alpha; empty: white.
    pub colors: Vec<[f32; 4]>,
    pub indices: Vec<u16>,
}

impl Shape {
    /// The smallest and largest coordinates.
    pub fn bounds(&self) -> ([f32; 3], [f32; 3]) {
        let points = || self.positions.iter().map(|p| Vec3::from_array(*p));
        let low = points().fold(Vec3::INFINITY, Vec3::min);
        (low.to_array(), points().fold(Vec3::NEG_INFINITY, Vec3::max).to_array())
    }

    /// Adds another shape of the same attributes.
    pub fn add(&mut self, other: &Shape) {
        let first = self.positions.len() as u16;
        self.positions.extend(&other.positions);
        self.normals.extend(&other.normals);
        self.colors.extend(&other.colors);
        for (set, others) in self.uvs.iter_mut().zip(&other.uvs) {
            set.extend(others);
        }
        self.indices.extend(other.indices.iter().map(|i| first + i));
    }

    /// Texture coordinates of the first set, scaled.
    pub fn tiled(mut self, u: f32, v: f32) -> Self {
        self.uvs[0].iter_mut().for_each(|uv| *uv = [uv[0] * u, uv[1] * v]);
        self
    }

    /// Without texture coordinates, which would only make the file larger.
    pub fn plain(mut self) -> Self {
        self.uvs = Default::default();
        self
    }
}

/// A parallelogram, front towards `right` × `up`; (0, 0) of its texture is the upper left.
pub fn quad(corner: Vec3, right: Vec3, up: Vec3) -> Shape {
    let corners = [corner, corner + right, corner + right + up, corner + up];
    let normal = right.cross(up).normalize();
    Shape {
        positions: corners.map(|c| c.to_array()).to_vec(),
        normals: vec![normal.to_array(); 4],
        uvs: [vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]], Vec::new()],
        colors: Vec::new(),
        indices: vec![0, 1, 2, 0, 2, 3],
    }
}

/// The four-sided face of the given corners, without normals or texture coordinates.
pub fn face(corners: [[f32; 3]; 4]) -> Shape {
    Shape { positions: corners.to_vec(), indices: vec![0, 1, 2, 0, 2, 3], ..Shape::default() }
}

/// A box with its front outside.
pub fn cuboid(low: Vec3, high: Vec3) -> Shape {
    let (s, mut shape) = (high - low, Shape::default());
    let (x, y, z) = (Vec3::X * s.x, Vec3::Y * s.y, Vec3::Z * s.z);
    let sides = [
        (low + z, x, y),
        (low + x, -x, y),
        (low, z, y),
        (low + x + z, -z, y),
        (low + y + z, x, -z),
        (low, x, z),
    ];
    for (corner, right, up) in sides {
        shape.add(&quad(corner, right, up));
    }
    shape
}

/// A surface over (0..=1)², `columns` by `rows`, seen from outside where ∂u × ∂v points. It closes
/// along u if `closed`. Normals are by central differences.
pub fn surface(columns: u16, rows: u16, closed: bool, point: impl Fn(f64, f64) -> DVec3) -> Shape {
    let mut shape = Shape::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let (u, v) = (f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows));
            // The seam's two sides are the same numbers, so that no ray slips through.
            let around = if closed && column == columns { 0.0 } else { u };
            shape.positions.push(point(around, v).as_vec3().to_array());
            let step = 1e-4;
            let du = point(u + step, v) - point(u - step, v);
            let dv = point(u, v + step) - point(u, v - step);
            shape.normals.push(du.cross(dv).normalize_or_zero().as_vec3().to_array());
            shape.uvs[0].push([u as f32, 1.0 - v as f32]);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let [b, c, d] = [a + 1, a + columns + 2, a + columns + 1];
            for triangle in [[a, b, c], [a, c, d]] {
                let [p, q, r] = triangle.map(|i| shape.positions[usize::from(i)]);
                // At poles a row is one point.
                if p != q && q != r && r != p {
                    shape.indices.extend(triangle);
                }
            }
        }
    }
    shape
}

/// A unit sphere about the origin.
pub fn sphere(columns: u16) -> Shape {
    let mut shape = surface(columns, columns / 2, true, |u, v| {
        let (sin_u, cos_u) = libm::sincos(u * TAU);
        let (sin_v, cos_v) = libm::sincos(v * PI);
        let sin_v = if v == 1.0 { 0.0 } else { sin_v };
        DVec3::new(sin_v * sin_u, -cos_v, sin_v * cos_u)
    });
    shape.normals.clone_from(&shape.positions);
    shape
}

/// A torus about the Y axis with a tube of `radius` at distance 1.
pub fn torus(columns: u16, rows: u16, radius: f64) -> Shape {
    let mut shape = surface(columns, rows, true, |u, v| {
        let (sin_u, cos_u) = libm::sincos(u * TAU);
        // The last row is the first again, to the bit.
        let (sin_v, cos_v) = libm::sincos(if v == 1.0 { 0.0 } else { v * TAU });
        let out = 1.0 - radius * cos_v;
        DVec3::new(out * sin_u, -radius * sin_v, out * cos_u)
    });
    // The seam's two rows have one normal too.
    let last = shape.normals.len() - usize::from(columns) - 1;
    for column in 0..=usize::from(columns) {
        let (sin_u, cos_u) = libm::sincos(column as f64 / f64::from(columns) * TAU);
        let inwards = DVec3::new(-sin_u, 0.0, -cos_u).as_vec3().to_array();
        (shape.normals[column], shape.normals[last + column]) = (inwards, inwards);
    }
    shape
}

/// A seashell: a tube that coils and grows; it is not its own mirror image.
pub fn shell(columns: u16, rows: u16) -> Shape {
    surface(columns, rows, true, |u, v| {
        let (sin_u, cos_u) = libm::sincos(u * TAU);
        let turn = 2.6 * TAU * v;
        let size = libm::exp(0.13 * (turn - 2.6 * TAU));
        let (sin_t, cos_t) = libm::sincos(turn);
        let out = size * (1.0 - 0.62 * cos_u);
        DVec3::new(out * cos_t, size * (2.0 - 0.85 * sin_u), out * sin_t)
    })
}
