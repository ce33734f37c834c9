//! What lies on a material at a point of a surface: factors times textures, and the directions
//! that coats and brush strokes have there.

use super::Attributes;
use super::lookup::look_up;
use super::shading_normal::{NormalContext, mapped_normal, smooth_normal, tangent};
use crate::material::Layers;
use crate::math::{Frame, TextureId, Vec2, Vec3};
use crate::scene::{Material, MaterialLayers, Scene, TextureRef};

/// A coat's normal less above its base than this is taken for the base's.
const LEAST_COSINE: f32 = 0.05;

/// Whether the layers of `material` are the same at all of its points.
pub(super) fn are_constant(material: &Material, layers: &MaterialLayers) -> bool {
    let bent = material.normal_texture.is_some() || material.bump_texture.is_some();
    let textured = layers.clone().ranged_slots_mut().any(|(slot, _)| slot.is_some());
    !(textured || bent && layers.clearcoat > 0.0 || layers.anisotropy > 0.0)
}

/// The layers but for textures and directions.
pub(super) fn constant_layers(layers: &MaterialLayers) -> Layers {
    // All fields are named, so that the compiler asks here about a new one.
    Layers {
        clearcoat: layers.clearcoat,
        clearcoat_roughness: layers.clearcoat_roughness,
        clearcoat_normal: Layers::NONE.clearcoat_normal,
        sheen_color: layers.sheen_color,
        sheen_roughness: layers.sheen_roughness,
        anisotropy: layers.anisotropy,
        anisotropy_direction: Layers::NONE.anisotropy_direction,
        iridescence: layers.iridescence,
        iridescence_ior: layers.iridescence_ior,
        iridescence_thickness: layers.iridescence_thickness[1],
    }
}

/// The layers at a point, whose shading frame is `frame`: factors times textures, with directions.
pub(super) fn layers_at(
    described: &MaterialLayers,
    at: &NormalContext<'_>,
    frame: &Frame,
) -> Layers {
    let mut layers = textured_layers(at.scene, described, at.attributes);
    if layers.clearcoat > 0.0 {
        layers.clearcoat_normal = coat_normal(described, at, frame);
    }
    if layers.anisotropy > 0.0 {
        set_anisotropy(described, at, frame, &mut layers);
    }
    layers
}

/// Factors times textures, but for directions.
fn textured_layers(scene: &Scene, described: &MaterialLayers, at: &Attributes) -> Layers {
    let texel = |texture: &Option<TextureRef>| texture.map(|texture| look_up(scene, &texture, at));
    let mut layers = constant_layers(described);
    if let Some(texel) = texel(&described.clearcoat_texture) {
        layers.clearcoat *= texel.x;
    }
    if let Some(texel) = texel(&described.clearcoat_roughness_texture) {
        layers.clearcoat_roughness *= texel.y;
    }
    if let Some(texel) = texel(&described.sheen_color_texture) {
        layers.sheen_color *= texel.truncate();
    }
    if let Some(texel) = texel(&described.sheen_roughness_texture) {
        layers.sheen_roughness *= texel.w;
    }
    if let Some(texel) = texel(&described.iridescence_texture) {
        layers.iridescence *= texel.x;
    }
    if let Some(texel) = texel(&described.iridescence_thickness_texture) {
        let [least, greatest] = described.iridescence_thickness;
        layers.iridescence_thickness = least + (greatest - least) * texel.y;
    }
    layers
}

/// The coat's normal in the base's frame. It does not follow the base's normal map.
fn coat_normal(described: &MaterialLayers, at: &NormalContext<'_>, frame: &Frame) -> Vec3 {
    let mut normal = smooth_normal(at);
    if let Some(texture) = &described.clearcoat_normal_texture {
        normal = mapped_normal(at, texture, described.clearcoat_normal_scale, normal);
    }
    let local = frame.to_local(normal);
    if local.z < LEAST_COSINE { Vec3::Z } else { local }
}

/// Sets how far and in which direction the reflection is stretched.
fn set_anisotropy(
    described: &MaterialLayers,
    at: &NormalContext<'_>,
    frame: &Frame,
    layers: &mut Layers,
) {
    let mut way = Vec2::X;
    if let Some(texture) = &described.anisotropy_texture {
        let texel = look_up(at.scene, texture, at.attributes);
        layers.anisotropy *= texel.z;
        way = (texel.truncate().truncate() * 2.0 - 1.0).try_normalize().unwrap_or(way);
    }
    let Vec2 { x: cos, y: sin } = described.anisotropy_rotation;
    let way = Vec2::new(cos * way.x - sin * way.y, sin * way.x + cos * way.y);
    // Where no texture says so, the first set of coordinates leads.
    let texture = at.material.tangent_texture().or(described.anisotropy_texture);
    let texture = texture.unwrap_or(TextureRef::new(TextureId::from_index(0)));
    let (tangent, sign) = tangent(at, &texture, frame.normal).unwrap_or((frame.tangent, 1.0));
    let tangents = Frame::from_normal_tangent(frame.normal, tangent);
    let world = tangents.to_world(Vec3::new(way.x, way.y * sign, 0.0));
    let local = frame.to_local(world).truncate();
    layers.anisotropy_direction = local.try_normalize().unwrap_or(Vec2::X);
}
