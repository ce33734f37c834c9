//! Cameras of a TOML scene.

use super::reader::Table;
use crate::camera::{Camera, ThinLens};
use crate::formats::LoadError;
use crate::math::{DVec3, Vec3};
use crate::scene::NamedCamera;
use crate::scene::defaults::AUTOMATIC_YFOV;

/// A camera that may look at the middle of what is not loaded yet.
pub struct CameraDeclaration<'d> {
    table: Table<'d>,
    name: String,
    eye: Vec3,
    target: Option<Vec3>,
    up: Vec3,
    yfov: f32,
    aperture: Option<f32>,
    focus: Option<f32>,
}

impl<'d> CameraDeclaration<'d> {
    pub fn read(table: Table<'d>) -> Result<Self, LoadError> {
        let point = |key| Ok::<_, LoadError>(table.numbers::<3>(key)?.map(vector));
        let eye = point("look-from")?.ok_or_else(|| table.fault("has no look-from"))?;
        let (target, up) = (point("look-at")?, point("up")?.unwrap_or(Vec3::Y));
        let yfov = table.positive("fov")?.unwrap_or(AUTOMATIC_YFOV);
        if yfov >= 180.0 {
            return Err(table.fault_at("fov", "must be below 180 degrees"));
        }
        let name = table.text("name")?.unwrap_or_default().to_owned();
        let (aperture, focus) = (table.positive("aperture")?, table.positive("focus")?);
        if focus.is_some() && aperture.is_none() {
            return Err(table.fault_at("focus", "needs an aperture, the radius of the lens"));
        }
        table.finish()?;
        Ok(Self { table, name, eye, target, up, yfov: yfov.to_radians(), aperture, focus })
    }

    /// The camera; without a `look-at` of its own it looks at `centre`.
    pub fn place(&self, centre: Vec3) -> Result<NamedCamera, LoadError> {
        let target = self.target.unwrap_or(centre);
        let ahead = (target.as_dvec3() - self.eye.as_dvec3()).normalize_or_zero();
        if ahead == DVec3::ZERO {
            let message = "is where the camera stands: there is no direction to look in";
            return Err(self.table.fault_at("look-at", message));
        }
        if self.table.has("up")
            && self.up.as_dvec3().normalize_or_zero().cross(ahead).length() < 1e-6
        {
            let message = "is along the line of sight, or zero: give another direction";
            return Err(self.table.fault_at("up", message));
        }
        let mut camera = Camera::look_at(self.eye, target, self.up, self.yfov);
        if let Some(aperture_radius) = self.aperture {
            let distance = target.as_dvec3().distance(self.eye.as_dvec3()) as f32;
            let focus_distance = self.focus.unwrap_or(distance);
            camera = camera.with_lens(ThinLens { aperture_radius, focus_distance });
        }
        Ok(NamedCamera { name: self.name.clone(), aspect: None, camera, planes: None })
    }
}

/// Three finite numbers in f32.
pub fn vector(numbers: [f64; 3]) -> Vec3 {
    DVec3::from_array(numbers).as_vec3()
}
