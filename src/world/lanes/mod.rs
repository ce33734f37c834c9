//! Surfaces and lights in lanes: for as many paths at once as a vector has lanes.
//!
//! What depends on where data lies is fetched lane by lane, as rows of four numbers; arithmetic is
//! done for all lanes at once, with the bits of [`super::Surface`] and of
//! [`World::sample_light`].

mod environment;
mod light;
mod light_samples;
mod surface;

pub use light::LightRows;
pub use light_samples::LightSamples;
pub use surface::{SurfaceLanes, SurfaceRows};

use super::World;
use super::interpolation::Interpolation;
use super::prepared_material::BsdfClass;
use crate::accel::ClosestHit;
use crate::geom::Mesh;
use crate::material::lanes::BsdfRows;
use crate::material::{Dielectric, Lambert, MetallicRoughness};
use crate::math::{InstanceId, MaterialId};
use crate::scene::Instance;

impl World {
    /// The instance and the number of the triangle that was hit, and what class of BSDF it has.
    #[inline(always)]
    pub fn classify(&self, hit: &ClosestHit) -> (InstanceId, usize, BsdfClass) {
        let (id, index) = (hit.triangle.instance, hit.triangle.index as usize);
        let instance = &self.scene.instances[id.index()];
        (id, index, self.materials[instance.material.index()].class)
    }

    /// Bounds the error of a plane, see [`SurfaceLanes::new`].
    pub fn slack(&self) -> f32 {
        self.slack
    }

    /// What the inside of a material absorbs, if anything: the colour that is left of white light
    /// after a distance, and that distance in metres.
    #[inline(always)]
    pub fn absorption(&self, id: MaterialId) -> Option<[f32; 4]> {
        let volume = self.materials[id.index()].absorption?;
        let [r, g, b] = volume.attenuation_color.to_array();
        Some([r, g, b, volume.attenuation_distance])
    }

    /// The form of all BSDFs.
    pub fn form(&self) -> crate::material::BsdfForm {
        self.form
    }

    /// The rows of a BSDF that differs from point to point.
    #[inline(never)]
    fn bsdf_rows(&self, instance: &Instance, mesh: &Mesh, point: &Interpolation) -> BsdfRows {
        let id = instance.material;
        let material = &self.materials[id.index()];
        let params =
            self.surface_params(id, &point.attributes((instance.mesh, mesh), material.textured));
        match material.class {
            BsdfClass::Lambert => Lambert { reflectance: params.base_color }.rows(),
            BsdfClass::SmoothGlass => {
                Dielectric::new(&params, self.form).rows().expect("a colour changes no class")
            }
            _ => MetallicRoughness::new(&params, self.form).rows(),
        }
    }
}
