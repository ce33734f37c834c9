//! What there is to report of a scene, and the words for it.

use crate::camera::Projection;
use crate::light::{Punctual, PunctualKind};
use crate::math::{Aabb, Vec3};
use crate::scene::{AlphaMode, Material, MaterialLayers, Scene, SceneMemory, Survey};
use crate::texture::ColorSpace;

/// All that there is to report.
pub struct Report<'a> {
    pub file: &'a str,
    pub bounds: Aabb,
    pub scene: &'a Scene,
    pub survey: &'a Survey,
    pub memory: SceneMemory,
    pub faults: Vec<(&'static str, String)>,
}

pub fn kind_of_light(light: &Punctual) -> &'static str {
    match light.kind {
        PunctualKind::Point => "point",
        PunctualKind::Spot { .. } => "spot",
        PunctualKind::Directional => "directional",
    }
}

/// Of a light the unit of its strength.
pub fn unit_of_light(light: &Punctual) -> &'static str {
    if light.kind == PunctualKind::Directional { "lux" } else { "candela" }
}

pub fn kind_of_camera(projection: &Projection) -> &'static str {
    match projection {
        Projection::Perspective { .. } => "perspective",
        Projection::Orthographic { .. } => "orthographic",
        Projection::Panorama => "panorama",
    }
}

pub fn name_of_space(space: ColorSpace) -> &'static str {
    match space {
        ColorSpace::Srgb => "sRGB",
        ColorSpace::Linear => "linear",
    }
}

/// What sets a material apart, in words.
pub fn traits(material: &Material) -> Vec<&'static str> {
    let textured = material.clone().textures_mut().next().is_some();
    let of_layer = |is: fn(&MaterialLayers) -> bool| material.layers.as_deref().is_some_and(is);
    let all = [
        ("unlit", material.unlit),
        ("emits", material.is_emissive()),
        ("metal", !material.unlit && material.metallic == 1.0),
        ("transmits", material.transmission > 0.0),
        ("translucent", material.diffuse_transmission > 0.0),
        ("solid", material.volume.is_some()),
        ("scatters", material.scattering.is_some()),
        ("clearcoat", of_layer(|layers| layers.clearcoat > 0.0)),
        ("sheen", of_layer(|layers| layers.sheen_color != Vec3::ZERO)),
        ("anisotropic", of_layer(|layers| layers.anisotropy > 0.0)),
        ("iridescent", of_layer(|layers| layers.iridescence > 0.0)),
        ("disperses", material.dispersion > 0.0),
        ("prior to others", material.priority > 0),
        ("posterior to others", material.priority < 0),
        ("masked", matches!(material.alpha_mode, AlphaMode::Mask(_))),
        ("blended", material.alpha_mode == AlphaMode::Blend),
        ("double-sided", material.double_sided),
        ("textured", textured),
        ("normal map", material.normal_texture.is_some()),
        ("bump map", material.bump_texture.is_some()),
    ];
    all.into_iter().filter(|(_, is)| *is).map(|(name, _)| name).collect()
}
