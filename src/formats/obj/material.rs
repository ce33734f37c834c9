//! From MTL's materials of the 1990s to the metallic-roughness material.
//!
//! | MTL | here |
//! |---|---|
//! | `Kd` | base colour; 0.8 if neither it nor `map_Kd` is there |
//! | `illum` 0 | `Kd` is shown as it is, whatever light falls on it |
//! | `Ks` absent or 0, or `illum` 1 | no specular reflection: Lambert |
//! | `Ks` | strength of a dielectric's reflection, where 0.5 is full strength as in Blender |
//! | `illum` 3 or 5 | `Ks` is the reflectance at normal incidence: a mirror if `Kd` is 0 |
//! | `Ns` | roughness: the exponent's width is alpha² = 2 / (Ns + 2), roughness = √alpha |
//! | `Ke` | emitted radiance |
//! | `d`, `1 - Tr`, `map_d` | the share of rays that the surface stops; see `transparency.rs` |
//! | `illum` 4, 6, 7 or 9 with d < 1 or `Tf` | smooth solid glass of index `Ni` (1.5 if absent) |
//! | `Tf` and `Ni` without `illum` | the same |
//! | `Pr`, `Pm` | roughness, metalness, instead of the above |
//! | `Pc`, `Ps`, `aniso`, … | what lies on it: `layers.rs` |
//!
//! Glass is tinted once per crossing, by `Tf`, or where that is absent by the share `d` of `Kd`.
//! `Ns` broadens highlights only and so leaves glass smooth; `Pr` makes it rough.

use std::path::Path;

use super::layers::layers;
use super::map_texels::Use;
use super::maps::Maps;
use super::mtl::MtlMaterial;
use super::remarks::Remarks;
use super::transparency::Reading;
use crate::math::Vec3;
use crate::scene::DEFAULT_GREY;
use crate::scene::{AlphaMode, Material, Volume};

/// Whether nothing is to be seen of what is made of it, by such a reading.
pub(super) fn is_invisible(mtl: &MtlMaterial, reading: Reading) -> bool {
    let opacity = reading.opacity(mtl);
    opacity <= 0.0 && !is_glass(mtl, opacity)
}

/// The material that stands in `file`, its transparency by such a reading; `remarks` are about that
/// file.
pub(super) fn convert(
    mtl: &MtlMaterial,
    (file, reading): (&Path, Reading),
    maps: &mut Maps,
    remarks: &mut Remarks,
) -> Material {
    let mut material = Material { name: mtl.name.clone(), metallic: 0.0, ..Material::default() };
    let opacity = opacity(mtl, reading, remarks);
    let absent = if mtl.map_kd.is_some() { 1.0 } else { DEFAULT_GREY };
    let kd = clamp_to_one(mtl.kd.unwrap_or(Vec3::splat(absent)), "Kd", mtl, remarks);
    material.base_color = kd.extend(1.0);

    surface(&mut material, mtl, remarks);
    if is_glass(mtl, opacity) {
        glass(&mut material, mtl, kd, opacity, remarks);
    } else if opacity < 1.0 || mtl.map_d.is_some() {
        material.base_color.w = opacity;
        material.alpha_mode = AlphaMode::Blend;
        material.alpha_texture =
            mtl.map_d.as_ref().and_then(|map| maps.texture(map, file, Use::Opacity));
        if opacity == 0.0 {
            let what = if mtl.d == Some(0.0) { "d is 0" } else { "opacity is 0 (Tr)" };
            remarks.add(mtl.line, format!("material {:?} is invisible: its {what}", mtl.name));
        }
    }
    material.emissive = match (mtl.ke, &mtl.map_ke) {
        (None, Some(_)) => Vec3::ONE,
        (ke, _) => ke.unwrap_or_default(),
    };
    textures(&mut material, mtl, file, maps, remarks);
    // A lamp stays a lamp.
    if mtl.illum == Some(0) && !material.is_emissive() {
        return material.into_unlit();
    }
    material.layers = layers(mtl, file, maps, remarks);
    material
}

/// Specular reflection, roughness and metalness.
fn surface(material: &mut Material, mtl: &MtlMaterial, remarks: &mut Remarks) {
    let is_pbr = [mtl.pr, mtl.pm].iter().any(Option::is_some)
        || [&mtl.map_pr, &mtl.map_pm].iter().any(|map| map.is_some());
    let given = if mtl.map_ks.is_some() || is_pbr { 0.5 } else { 0.0 };
    let ks = clamp_to_one(mtl.ks.unwrap_or(Vec3::splat(given)), "Ks", mtl, remarks);
    // Many files say 1 and have highlights nevertheless.
    material.ior = mtl.ni.filter(|&ni| ni > 1.0).unwrap_or(1.5);
    let strongest = ks.max_element();
    if strongest == 0.0 || matches!(mtl.illum, Some(0 | 1)) {
        material.specular = 0.0;
    } else if matches!(mtl.illum, Some(3 | 5)) && !is_pbr {
        material.ior = 1.5;
        let normal_incidence = 0.04; // ((1.5 - 1) / (1.5 + 1))²
        material.specular_color = ks / normal_incidence;
    } else {
        material.specular = (2.0 * strongest).min(1.0);
        material.specular_color = ks / strongest;
    }
    let exponent = mtl.ns.unwrap_or(0.0).max(0.0);
    let of_exponent = (2.0 / (exponent + 2.0)).sqrt().sqrt();
    let absent = if mtl.map_pr.is_some() { 1.0 } else { of_exponent };
    material.roughness = mtl.pr.unwrap_or(absent).clamp(0.0, 1.0);
    let absent = if mtl.map_pm.is_some() { 1.0 } else { 0.0 };
    material.metallic = mtl.pm.unwrap_or(absent).clamp(0.0, 1.0);
    if mtl.illum == Some(10) {
        remarks.add(mtl.line, "illum 10 (shadows on nothing) is not honoured: it is matt");
    }
}

fn is_glass(mtl: &MtlMaterial, opacity: f32) -> bool {
    let filter = mtl.tf.is_some_and(|tf| tf != Vec3::ZERO);
    match mtl.illum {
        Some(4 | 6 | 7 | 9) => filter || opacity < 1.0,
        Some(_) => false,
        None => filter && mtl.ni.is_some_and(|ni| ni > 1.0),
    }
}

fn glass(
    material: &mut Material,
    mtl: &MtlMaterial,
    kd: Vec3,
    opacity: f32,
    remarks: &mut Remarks,
) {
    let tint = mtl.tf.filter(|&tf| tf != Vec3::ZERO).unwrap_or(Vec3::ONE.lerp(kd, opacity));
    material.base_color = clamp_to_one(tint, "Tf", mtl, remarks).extend(1.0);
    material.transmission = 1.0;
    material.volume =
        Some(Volume { attenuation_color: Vec3::ONE, attenuation_distance: f32::INFINITY });
    material.ior = mtl.ni.unwrap_or(1.5).max(1.0);
    if mtl.ni.is_some_and(|ni| ni < 1.0) {
        remarks.add(mtl.line, "an index of refraction below 1 counts as 1");
    }
    // Dielectric interfaces are whole: what they do not let through, they reflect.
    (material.specular, material.specular_color) = (1.0, Vec3::ONE);
    material.roughness = mtl.pr.unwrap_or(0.0).clamp(0.0, 1.0);
    material.metallic = 0.0;
}

fn textures(
    material: &mut Material,
    mtl: &MtlMaterial,
    file: &Path,
    maps: &mut Maps,
    remarks: &mut Remarks,
) {
    if let Some(map) = &mtl.map_kd {
        material.base_color_texture = maps.texture(map, file, Use::Color);
        if mtl.kd == Some(Vec3::ZERO) {
            remarks.add(map.line, "map_Kd is black because Kd is: set Kd to 1 1 1");
        }
        if mtl.map_d.is_none() && maps.has_alpha(map, file) {
            remarks.add(map.line, "the alpha of map_Kd is not honoured: name it as map_d as well");
        }
    }
    let mut color = |map| maps.texture(map, file, Use::Color);
    material.specular_color_texture = mtl.map_ks.as_ref().and_then(&mut color);
    material.emissive_texture = mtl.map_ke.as_ref().and_then(&mut color);
    if let Some(map) = mtl.map_ke.as_ref().filter(|_| mtl.ke == Some(Vec3::ZERO)) {
        remarks.add(map.line, "map_Ke is black because Ke is: set Ke to 1 1 1");
    }
    material.normal_texture =
        mtl.norm.as_ref().and_then(|map| maps.texture(map, file, Use::Normals));
    if material.normal_texture.is_none() {
        material.bump_texture =
            mtl.bump.as_ref().and_then(|map| maps.texture(map, file, Use::Scalar));
    } else if let Some(bump) = &mtl.bump {
        remarks.add(bump.line, "heights beside normals are not honoured");
    }
    if let Some(map) = mtl.norm.as_ref().or(mtl.bump.as_ref()) {
        material.normal_scale = map.bump;
    }
    let scalars = [mtl.map_pm.as_ref(), mtl.map_pr.as_ref()];
    material.metallic_roughness_texture = maps.metallic_roughness(scalars, file);
    if let [Some(a), Some(b)] = scalars
        && (a.scale, a.offset, a.clamp) != (b.scale, b.offset, b.clamp)
    {
        remarks.add(a.line, "options of map_Pm that differ from map_Pr's are not honoured");
    }
}

fn opacity(mtl: &MtlMaterial, reading: Reading, remarks: &mut Remarks) -> f32 {
    let opacity = reading.opacity(mtl);
    if !(0.0..=1.0).contains(&opacity) {
        remarks.add(mtl.line, "an opacity outside of 0 to 1 is clamped");
    }
    opacity.clamp(0.0, 1.0)
}

/// Surfaces do not return more than they get.
fn clamp_to_one(color: Vec3, what: &str, mtl: &MtlMaterial, remarks: &mut Remarks) -> Vec3 {
    if color.max_element() > 1.0 {
        remarks.add(mtl.line, format!("a {what} above 1 is clamped"));
    }
    color.min(Vec3::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::{MissingTexture, MtlTransparency};
    use crate::texture::TextureStore;

    /// The only material of an MTL file, and what is remarked on.
    fn convert_text(text: &str) -> (Material, Vec<String>) {
        let file = Path::new("a.mtl");
        let mut remarks = Remarks::new(file);
        let text = format!("newmtl m\n{text}");
        let parsed = super::super::mtl::parse(text.as_bytes(), file, &mut remarks).unwrap();
        let store = TextureStore::default();
        let mut maps = Maps::new(Path::new("."), MissingTexture::Magenta, &store);
        let reading = Reading::Told(MtlTransparency::File);
        let material = convert(&parsed[0], (file, reading), &mut maps, &mut remarks);
        (material, remarks.finish().into_iter().map(|notice| notice.message).collect())
    }

    fn quietly(text: &str) -> Material {
        let (material, remarks) = convert_text(text);
        assert!(remarks.is_empty(), "{remarks:?}");
        material
    }

    #[test]
    fn without_ks_a_surface_is_lambertian() {
        let text = "illum 2\nKd 0.725 0.71 0.68\nKs 0 0 0\nKe 17 12 4\nNs 100\nNi 1.5";
        let m = quietly(text);
        assert_eq!(m.base_color, Vec3::new(0.725, 0.71, 0.68).extend(1.0));
        assert_eq!((m.metallic, m.specular, m.transmission), (0.0, 0.0, 0.0));
        assert_eq!(m.emissive, Vec3::new(17.0, 12.0, 4.0));
        assert_eq!((m.alpha_mode, m.double_sided), (AlphaMode::Opaque, false));
        assert_eq!(quietly("Kd 1 1 1").specular, 0.0);
        assert_eq!(quietly("illum 1\nKs 1").specular, 0.0);
        assert_eq!(quietly("").base_color.x, DEFAULT_GREY);
    }

    #[test]
    fn without_light_there_is_colour_alone() {
        let m = quietly("illum 0\nKd 0.5 0.25 1\nKs 1\nd 0.5");
        assert!(m.unlit && m.alpha_mode == AlphaMode::Blend);
        assert_eq!(m.base_color.truncate(), Vec3::new(0.5, 0.25, 1.0));
        let lamp = quietly("illum 0\nKe 1");
        assert!(!lamp.unlit && lamp.is_emissive());
    }

    #[test]
    fn highlights_are_a_dielectrics() {
        let m = quietly("Kd 0.1\nKs 0.5 0.25 0\nNs 30\nNi 1.0");
        assert_eq!((m.specular, m.specular_color), (1.0, Vec3::new(1.0, 0.5, 0.0)));
        assert_eq!((m.ior, m.roughness), (1.5, 0.5)); // alpha² = 2 / 32 = 1 / 16
        assert_eq!(quietly("Ks 0.05").specular, 0.1);
        assert_eq!(quietly("Ks 0.5").roughness, 1.0);
    }

    #[test]
    fn mirrors_reflect_ks_at_normal_incidence() {
        let m = quietly("Kd 0\nKs 1\nNs 1000000\nillum 3");
        assert_eq!((m.specular, m.ior), (1.0, 1.5));
        assert!((m.specular_color * 0.04).abs_diff_eq(Vec3::ONE, 1e-6));
    }

    #[test]
    fn opacity_is_d_before_tr() {
        let m = quietly("d 0.75\nTr 0.5");
        assert_eq!((m.alpha_mode, m.base_color.w), (AlphaMode::Blend, 0.75));
        assert_eq!(quietly("Tr 0.25").base_color.w, 0.75);
        assert_eq!(convert_text("d 0").1, ["material \"m\" is invisible: its d is 0"]);
        assert_eq!(convert_text("d 7").1, ["an opacity outside of 0 to 1 is clamped"]);
    }

    #[test]
    fn glass_needs_something_that_goes_through() {
        let m = quietly("illum 7\nNi 1.33\nd 0\nKd 0\nNs 50");
        assert_eq!((m.transmission, m.ior, m.roughness), (1.0, 1.33, 0.0));
        assert_eq!((m.base_color, m.alpha_mode), (Vec3::ONE.extend(1.0), AlphaMode::Opaque));
        assert!(m.volume.is_some());
        assert_eq!(quietly("illum 4\nTf 0.5 1 0.5").base_color.x, 0.5);
        assert_eq!(quietly("illum 9\nd 0.5\nKd 0.5 1 1").base_color.x, 0.75);
        assert_eq!(quietly("Tf 0.5 1 0.5\nNi 1.5").transmission, 1.0);
        for opaque in ["illum 4\nd 1", "illum 2\nTf 1 1 1\nNi 1.5", "Tf 1 1 1"] {
            assert_eq!(quietly(opaque).transmission, 0.0, "{opaque}");
        }
    }

    #[test]
    fn pbr_statements_win() {
        let m = quietly("Kd 1 0.5 0\nNs 10\nPr 0.2\nPm 0.7\nillum 3");
        assert_eq!((m.roughness, m.metallic, m.specular), (0.2, 0.7, 1.0));
    }

    #[test]
    fn coats_sheen_and_stretch_lie_on_it() {
        let coated = quietly("Kd 1 0 0\nPr 0.5\nPc 0.75\nPcr 0.1\nPs 0.25\naniso 0.5\nanisor 0.25");
        let layers = coated.layers.expect("layers");
        assert_eq!((layers.clearcoat, layers.clearcoat_roughness), (0.75, 0.1));
        assert_eq!((layers.sheen_color.x, layers.anisotropy), (0.25, 0.5));
        assert!((layers.anisotropy_rotation - crate::math::Vec2::Y).length() < 1e-6);
        assert!(quietly("Pc 0\nPcr 0.5\nPs 0\naniso 0").layers.is_none());
        assert_eq!(convert_text("Pc 3").1, ["a Pc outside of 0 to 1 is clamped"]);
    }

    #[test]
    fn mistakes_are_remarked_on() {
        assert_eq!(convert_text("Kd 2").1, ["a Kd above 1 is clamped"]);
        assert_eq!(
            convert_text("Kd 0\nmap_Kd a.png").1,
            ["map_Kd is black because Kd is: set Kd to 1 1 1"]
        );
        assert_eq!(
            convert_text("illum 6\nd 0.1\nNi 0.7").1,
            ["an index of refraction below 1 counts as 1"]
        );
    }
}
