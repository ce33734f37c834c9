//! What lies on a material by the PBR extension of MTL.
//!
//! | MTL | here |
//! |---|---|
//! | `Pc`, `map_Pc`; `Pcr`, `map_Pcr` | strength and roughness of a clear coat |
//! | `Ps`, `map_Ps` | sheen: white fibres of that strength, of roughness 0.5 |
//! | `aniso`; `anisor` | stretch of the reflection, and its angle in turns from the tangent |
//!
//! The extension says no more of sheen than its strength; 0.5 is what Blender takes.

use std::path::Path;

use super::map_texels::Use;
use super::maps::Maps;
use super::mtl::MtlMaterial;
use super::remarks::Remarks;
use crate::math::{Vec2, Vec3};
use crate::scene::MaterialLayers;

const SHEEN_ROUGHNESS: f32 = 0.5;

/// The layers of a material that stands in `file`, if it has any.
pub(super) fn layers(
    mtl: &MtlMaterial,
    file: &Path,
    maps: &mut Maps,
    remarks: &mut Remarks,
) -> Option<Box<MaterialLayers>> {
    // A map without its number is there in full.
    let mut share = |value: Option<f32>, has_map: bool, what: &str| {
        let value = value.unwrap_or(if has_map { 1.0 } else { 0.0 });
        if !(0.0..=1.0).contains(&value) {
            remarks.add(mtl.line, format!("a {what} outside of 0 to 1 is clamped"));
        }
        value.clamp(0.0, 1.0)
    };
    let mut layers = MaterialLayers {
        clearcoat: share(mtl.pc, mtl.map_pc.is_some(), "Pc"),
        clearcoat_roughness: share(mtl.pcr, mtl.map_pcr.is_some(), "Pcr"),
        sheen_color: Vec3::splat(share(mtl.ps, mtl.map_ps.is_some(), "Ps")),
        sheen_roughness: SHEEN_ROUGHNESS,
        anisotropy: share(mtl.aniso, false, "aniso"),
        ..MaterialLayers::default()
    };
    if !layers.any() {
        return None;
    }
    let (sine, cosine) = libm::sincosf(mtl.anisor.unwrap_or(0.0) * std::f32::consts::TAU);
    layers.anisotropy_rotation = Vec2::new(cosine, sine);
    let mut scalar = |map| maps.texture(map, file, Use::Scalar);
    layers.clearcoat_texture = mtl.map_pc.as_ref().and_then(&mut scalar);
    layers.clearcoat_roughness_texture = mtl.map_pcr.as_ref().and_then(&mut scalar);
    layers.sheen_color_texture = mtl.map_ps.as_ref().and_then(&mut scalar);
    Some(Box::new(layers))
}
