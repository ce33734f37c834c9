//! What is known of a material before any point of it is seen.

use std::sync::Arc;

use super::lookup::surface_params;
use super::{Attributes, layers};
use crate::geom::Mesh;
use crate::material::lanes::BsdfRows;
use crate::material::{BaseBsdf, Bsdf, BsdfForm};
use crate::math::{MaterialId, Vec3};
use crate::scene::{AlphaMode, Material, Scene, Volume};

/// The classes of surfaces that are shaded in lanes, and all others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BsdfClass {
    /// Shaded one by one.
    Other,
    /// A [`Lambert`](crate::material::Lambert) without emission, normal map or inside.
    Lambert,
    /// The same of [`MetallicRoughness`](crate::material::MetallicRoughness).
    MetallicRoughness,
    /// Smooth glass of one index for all colours, likewise: the boundary of a solid or a sheet.
    SmoothGlass,
}

/// The class of a material, whatever its textures say at a point.
fn classify(material: &Material, form: BsdfForm) -> BsdfClass {
    let bare = material.layers.is_none() && !material.unlit && !material.is_emissive();
    let bare = bare && material.diffuse_transmission <= 0.0 && material.scattering.is_none();
    let smooth = material.normal_texture.is_none() && material.bump_texture.is_none();
    if !(bare && smooth) {
        return BsdfClass::Other;
    }
    if material.transmission > 0.0 {
        let smooth = is_smooth_glass(material, form);
        return if smooth { BsdfClass::SmoothGlass } else { BsdfClass::Other };
    }
    let is_metallic = material.metallic > 0.0;
    let is_coated = material.specular > 0.0 || material.specular.is_nan();
    if !is_metallic && !is_coated {
        BsdfClass::Lambert
    } else if is_coated && material.specular_texture.is_none()
        || is_metallic && material.metallic_roughness_texture.is_none()
    {
        BsdfClass::MetallicRoughness
    } else {
        BsdfClass::Other
    }
}

/// Whether a material is clear and smooth all over, whatever its colour.
fn is_smooth_glass(material: &Material, form: BsdfForm) -> bool {
    let looked_up = [
        material.metallic_roughness_texture,
        material.glossiness_texture,
        material.specular_texture,
        material.specular_color_texture,
        material.transmission_texture,
    ];
    if looked_up.iter().any(Option::is_some) || material.dispersion > 0.0 {
        return false;
    }
    let colorless = Material { base_color_texture: None, ..material.clone() };
    let params = surface_params(&Scene::default(), &colorless, &Attributes::NONE);
    matches!(BaseBsdf::new(&params, form), BaseBsdf::Dielectric(glass) if glass.rows().is_some())
}

/// What is known of a material before any point of it is seen.
#[derive(Clone, Debug)]
pub(super) struct PreparedMaterial {
    /// The scattering, if no texture changes it from point to point.
    pub bsdf: Option<Bsdf>,
    /// What kernel in lanes its surfaces go through.
    pub class: BsdfClass,
    /// The scattering for that kernel, if no texture and no vertex changes it.
    pub rows: Option<BsdfRows>,
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
            material.diffuse_transmission_texture,
            material.diffuse_transmission_color_texture,
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
        let bsdf = constant.then(plain);
        let class = classify(material, form);
        Self {
            bsdf,
            class,
            rows: match (class, bsdf) {
                (BsdfClass::Lambert, Some(Bsdf::Base(BaseBsdf::Lambert(bsdf)))) => {
                    Some(bsdf.rows())
                }
                (
                    BsdfClass::MetallicRoughness,
                    Some(Bsdf::Base(BaseBsdf::MetallicRoughness(bsdf))),
                ) => Some(bsdf.rows()),
                (BsdfClass::SmoothGlass, Some(Bsdf::Base(BaseBsdf::Dielectric(bsdf)))) => {
                    bsdf.rows()
                }
                _ => None,
            },
            layered: layers.is_some(),
            textured: material.clone().textures_mut().next().is_some(),
            opaque: material.is_opaque(),
            solid: material.is_solid(),
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
