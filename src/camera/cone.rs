//! How wide pixels are.

use std::f32::consts::PI;

use super::{Camera, CameraRays, Projection};

impl Camera {
    /// How wide a pixel is at the camera, and by how much more at a distance of one metre, on a
    /// film of so many rows; without its lens.
    pub fn pixel_cone(&self, rows: u32) -> [f32; 2] {
        let rows = rows as f32;
        match self.projection {
            Projection::Perspective { yfov } => [0.0, 2.0 * libm::tanf(0.5 * yfov) / rows],
            Projection::Orthographic { ymag, .. } => [2.0 * ymag / rows, 0.0],
            Projection::Panorama => [0.0, PI / rows],
        }
    }
}

impl CameraRays {
    /// See [`Camera::pixel_cone`].
    pub fn pixel_cone(&self, rows: u32) -> [f32; 2] {
        self.camera.pixel_cone(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    #[test]
    fn rows_fill_the_film() {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.5 * PI);
        let [width, spread] = camera.pixel_cone(100);
        assert!(width == 0.0 && (spread - 0.02).abs() < 1e-6, "{spread}");
        let projection = Projection::Orthographic { xmag: 1.0, ymag: 3.0 };
        assert_eq!(Camera { projection, ..camera }.pixel_cone(60), [0.1, 0.0]);
        assert_eq!(camera.with_panorama().pixel_cone(180), [0.0, PI / 180.0]);
    }
}
