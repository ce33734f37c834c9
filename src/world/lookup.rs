//! A material at a point: its factors times its textures.

use super::Attributes;
use crate::material::SurfaceParams;
use crate::math::{Vec3, Vec4};
use crate::scene::{Material, Scene, TextureRef};

/// Looks a texture up where a material asks for it.
pub(super) fn look_up(scene: &Scene, texture: &TextureRef, at: &Attributes) -> Vec4 {
    let (uv, footprint) = at.uv_set(scene, texture.uv_set);
    let uv = texture.transform(uv);
    let image = &scene.textures[texture.texture.index()];
    if footprint > 0.0 {
        let scale = (texture.scale.x * texture.scale.y).abs().sqrt();
        return image.sample_over(uv, footprint * scale);
    }
    image.sample(uv)
}

/// What a material emits at a point.
pub(super) fn emission(scene: &Scene, material: &Material, at: &Attributes) -> Vec3 {
    if material.unlit {
        return base_color(scene, material, at).truncate();
    }
    match &material.emissive_texture {
        Some(texture) => material.emissive * look_up(scene, texture, at).truncate(),
        None => material.emissive,
    }
}

/// Colour and alpha at a point: factor times texture times the vertices' colour.
pub(super) fn base_color(scene: &Scene, material: &Material, at: &Attributes) -> Vec4 {
    let color = material.base_color * at.color;
    match &material.base_color_texture {
        Some(texture) => color * look_up(scene, texture, at),
        None => color,
    }
}

/// The alpha of a material at a point.
pub(super) fn alpha(scene: &Scene, material: &Material, at: &Attributes) -> f32 {
    let mut alpha = base_color(scene, material, at).w;
    if let Some(texture) = &material.alpha_texture {
        alpha *= look_up(scene, texture, at).x;
    }
    alpha
}

/// The parameters of what a material scatters at a point, but for what lies on it.
pub(super) fn surface_params(scene: &Scene, material: &Material, at: &Attributes) -> SurfaceParams {
    if material.unlit {
        // Black and without a coat: all that comes from it is its emission.
        return SurfaceParams { base_color: Vec3::ZERO, specular: 0.0, ..SurfaceParams::default() };
    }
    let texel = |texture: &Option<TextureRef>| match texture {
        Some(texture) => look_up(scene, texture, at),
        None => Vec4::ONE,
    };
    let metallic_roughness = texel(&material.metallic_roughness_texture);
    SurfaceParams {
        base_color: base_color(scene, material, at).truncate(),
        metallic: material.metallic * metallic_roughness.z,
        roughness: match material.glossiness_texture {
            None => material.roughness * metallic_roughness.y,
            Some(_) => 1.0 - (1.0 - material.roughness) * texel(&material.glossiness_texture).w,
        },
        ior: material.ior,
        specular: material.specular * texel(&material.specular_texture).w,
        specular_color: material.specular_color
            * texel(&material.specular_color_texture).truncate(),
        transmission: material.transmission * texel(&material.transmission_texture).x,
        diffuse_transmission: material.diffuse_transmission
            * texel(&material.diffuse_transmission_texture).w,
        diffuse_transmission_color: material.diffuse_transmission_color
            * texel(&material.diffuse_transmission_color_texture).truncate(),
        thin: material.volume.is_none(),
    }
}
