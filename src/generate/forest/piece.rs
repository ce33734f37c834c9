//! Triangles of plants under construction.

use crate::math::DVec3;

/// Triangles of one material, with colours that multiply it.
#[derive(Clone, Debug, Default)]
pub struct Piece {
    /// Index of the material.
    pub material: usize,
    /// Corners, metres.
    pub positions: Vec<[f32; 3]>,
    /// Of unit length, one a corner; empty: each triangle is flat.
    pub normals: Vec<[f32; 3]>,
    /// Linear, as 8 bits.
    pub colors: Vec<[u8; 4]>,
    /// Three corners a triangle.
    pub indices: Vec<[u32; 3]>,
}

impl Piece {
    /// Nothing yet.
    pub fn new(material: usize) -> Self {
        Self { material, ..Self::default() }
    }

    /// Adds a corner of flat triangles.
    pub fn corner(&mut self, at: DVec3, color: DVec3) -> u32 {
        let byte = |share: f64| (share.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        self.positions.push(at.as_vec3().to_array());
        self.colors.push([byte(color.x), byte(color.y), byte(color.z), 255]);
        self.positions.len() as u32 - 1
    }

    /// Adds a corner of a smooth surface; `normal` need not be of unit length.
    pub fn smooth_corner(&mut self, at: DVec3, normal: DVec3, color: DVec3) -> u32 {
        self.normals.push(normal.normalize_or(DVec3::Y).as_vec3().to_array());
        self.corner(at, color)
    }

    /// Gives all corners the normals of the triangles around them, by their areas.
    pub fn smooth(&mut self) {
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for triangle in &self.indices {
            let at = triangle.map(|i| DVec3::from(self.positions[i as usize].map(f64::from)));
            let face = (at[1] - at[0]).cross(at[2] - at[0]);
            for &i in triangle {
                sums[i as usize] += face;
            }
        }
        let unit = |sum: DVec3| sum.normalize_or(DVec3::Y).as_vec3().to_array();
        self.normals = sums.into_iter().map(unit).collect();
    }

    /// Adds a leaf of two triangles, or half a leaf of one: from `base` `along` to its tip, half as
    /// wide as `across`, its edges bent by `lift`.
    pub fn leaf(
        &mut self,
        (base, along): (DVec3, DVec3),
        across: DVec3,
        lift: DVec3,
        color: DVec3,
        whole: bool,
    ) {
        let middle = base + along * 0.42 + lift;
        let [root, tip] = [base, base + along].map(|at| self.corner(at, color));
        let right = self.corner(middle + across, color);
        self.indices.push([root, right, tip]);
        if whole {
            let left = self.corner(middle - across, color);
            self.indices.push([root, tip, left]);
        }
    }
}
