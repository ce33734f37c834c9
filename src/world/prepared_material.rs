//! What is known of a material before any point of it is seen.

use std::sync::Arc;

use super::lookup::surface_params;
use super::{Attributes, layers};
use crate::geom::Mesh;
use crate::material::{Bsdf, BsdfForm};
use crate::math::{MaterialId, Vec3};
use crate::scene::{AlphaMode, Material, Scene, Volume};

/// What is known of a material before any point of it is seen.
#[derive(Clone, Debug)]
pub(super) struct PreparedMaterial {
    /// The scattering, if no texture changes it from point to point.
    pub bsdf: Option<Bsdf>,
    /// Whether something lies on it.
    pub layered: bool,
    /// Whether any texture is looked up at all.
    pub textured: bool,
    /// See [`Material::is_opaque`]; the colours of vertices have a say in it too.
    pub opaque: bool,
    /// Whether it bounds solids that light goes through.
    pub solid: bool,
    /// The inside, if it takes away light.
    pub absorption: Option<Volume>,
}

impl PreparedMaterial {
    /// What can be said of a material whose surfaces scatter by `form`.
    pub fn new(material: &Material, form: BsdfForm) -> Self {
        let looked_up = [
            material.base_color_texture,
            material.metallic_roughness_texture,
            material.glossiness_texture,
            material.specular_texture,
            material.specular_color_texture,
            material.transmission_texture,
        ];
        // Where layers have directions of their own, each point has.
        let layers = material.layers.as_deref();
        let constant = looked_up.iter().all(Option::is_none)
            && layers.is_none_or(|layers| layers::are_constant(material, layers));
        let plain = || {
            let params = surface_params(&Scene::default(), material, &Attributes::NONE);
            match layers {
                Some(layers) => Bsdf::layered(&params, &layers::constant_layers(layers), form),
                None => Bsdf::new(&params, form),
            }
        };
        Self {
            bsdf: constant.then(plain),
            layered: layers.is_some(),
            textured: material.clone().textures_mut().next().is_some(),
            opaque: material.is_opaque(),
            solid: material.volume.is_some() && material.transmission > 0.0,
            absorption: material.volume.filter(|volume| {
                volume.attenuation_distance.is_finite()
                    && volume.attenuation_distance > 0.0
                    && volume.attenuation_color != Vec3::ONE
            }),
        }
    }
}

/// Materials that do not ignore alpha, on meshes with vertices that are not opaque.
pub(super) fn materials_with_clear_vertices(scene: &Scene) -> impl Iterator<Item = MaterialId> {
    let clear = |mesh: &Arc<Mesh>| mesh.colors.iter().any(|color| color.w < 1.0);
    let clear: Vec<bool> = scene.meshes.iter().map(clear).collect();
    let used = scene.instances.iter().filter(move |instance| clear[instance.mesh.index()]);
    used.map(|instance| instance.material)
        .filter(|id| scene.materials[id.index()].alpha_mode != AlphaMode::Opaque)
}
