//! Wavefront OBJ geometry and MTL materials.
//!
//! The reader is our own: the crate `tobj` names no lines in its errors, cuts polygons into fans,
//! which is wrong for concave ones, and knows neither texture options nor names with spaces.
//! Specification: Wavefront Technologies, "Object Files (.obj)" and "MTL material format", version
//! 3.0 and 4.2, 1995; with the PBR extension that Clara.io proposed (`Pr`, `Pm`, `norm`, …).
//!
//! - There is one mesh for each object, group and material; polygons of any shape become triangles
//!   (`triangulate.rs`), in the file's order within their mesh.
//! - Shading is flat where the file gives neither normals nor smoothing groups; the latter have
//!   normals made for them (`smoothing.rs`). OBJ counts v of texture coordinates upwards;
//!   they are turned over.
//! - Materials are mapped as `material.rs` tells. Emitters shine from the front of their triangles.
//! - Colours after the coordinates of vertices, as scanners write them, are sRGB and multiply the
//!   material's.
//! - A material that is missing is grey; in place of a missing library the one that is called like
//!   the scene is read; both are said. A texture that is missing is an error as for any other
//!   format. References may not leave the scene's folder.

mod geometry;
mod layers;
mod libraries;
mod lines;
mod map_texels;
mod maps;
mod material;
mod mesh;
mod mtl;
mod parse;
mod paths;
mod remarks;
mod smoothing;
mod texture_statement;
mod transparency;

use std::path::Path;
use std::sync::Arc;

use geometry::Geometry;
use libraries::Libraries;
use maps::Maps;
use remarks::Remarks;
use transparency::Reading;

use super::{LoadError, LoadOptions, MtlTransparency, read_file};
use crate::files::Meter;
use crate::math::{Affine3A, MaterialId, MeshId, Vec4};
use crate::scene::{Instance, Material, Scene, Transform};
use crate::texture::TextureStore;

/// Loads an OBJ file, its material libraries and their textures.
///
/// # Errors
/// [`LoadError`] with the line of a malformed statement, or a list of all unusable textures.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    options.refuse_choices(path)?;
    let mut remarks = Remarks::new(path);
    let geometry = parse::parse(&read_file(path)?, path, &mut remarks, &options.meter)?;
    let folder = path.parent().unwrap_or(Path::new(""));

    let mut libraries = Libraries::new(path, folder);
    for (line, names) in &geometry.libraries {
        libraries.load(names, *line, &mut remarks)?;
    }
    if let ([], [(_, line), ..]) = (&*geometry.libraries, &*geometry.materials) {
        let instead = libraries.load_namesake()?;
        remarks.add(*line, format!("materials without mtllib{instead}"));
    }
    let mut maps = Maps::new(folder, options.missing_texture, &options.textures);
    let used = geometry.materials.iter().filter_map(|(name, _)| libraries.materials.get(name));
    maps.preload(used.flat_map(|(_, material)| material.used_maps()));
    let mut scene = Scene::default();
    let reading = choose_reading(&geometry, &libraries, options, &mut remarks);
    let ids = materials(&geometry, (&mut libraries, reading), &mut maps, &mut scene, &mut remarks);
    scene.textures = maps.finish(path, &mut libraries.notices)?;

    let meshes = mesh::build(&geometry)
        .map_err(|intricate| LoadError::invalid(path, "", intricate.to_string()))?;
    if meshes.is_empty() {
        remarks.add_file("it has no faces");
    }
    for (part, mesh) in meshes {
        let mesh_id = MeshId::from_index(scene.meshes.len());
        scene.meshes.push(Arc::new(mesh));
        let material = match geometry.parts[part].material {
            Some(used) => ids[used],
            None => grey_id(&mut scene),
        };
        let transform = Transform::new(Affine3A::IDENTITY);
        scene.instances.push(Instance { mesh: mesh_id, material, transform });
    }
    scene.notices = remarks.finish();
    scene.notices.append(&mut libraries.notices);
    Ok(scene)
}

/// How transparency is told: as someone says, else as the file does, unless nothing would be seen.
fn choose_reading(
    geometry: &Geometry,
    libraries: &Libraries,
    options: &LoadOptions,
    remarks: &mut Remarks,
) -> Reading {
    if let Some(told) = options.mtl_transparency {
        return Reading::Told(told);
    }
    let reading = Reading::Told(MtlTransparency::File);
    let is_invisible = |part: &geometry::Part| {
        let name = part.material.map(|used| &geometry.materials[used].0);
        let found = name.and_then(|name| libraries.materials.get(name));
        found.is_some_and(|(_, mtl)| material::is_invisible(mtl, reading))
    };
    let mut parts = geometry.parts.iter().filter(|part| !part.polygons.is_empty()).peekable();
    if parts.peek().is_none() || !parts.all(is_invisible) {
        return reading;
    }
    remarks.add_file(
        "all of it would be invisible by its d or Tr: it is taken as opaque \
         (--mtl-transparency file: as it says)",
    );
    Reading::Opaque
}

/// The materials that the geometry uses, in the order of their first use, and their ids.
fn materials(
    geometry: &Geometry,
    (libraries, reading): (&mut Libraries, Reading),
    maps: &mut Maps,
    scene: &mut Scene,
    remarks: &mut Remarks,
) -> Vec<MaterialId> {
    let mut ids = Vec::with_capacity(geometry.materials.len());
    for (name, line) in &geometry.materials {
        let id = if let Some((file, parsed)) = libraries.materials.get(name) {
            let mut about = Remarks::new(file);
            scene.materials.push(material::convert(parsed, (file, reading), maps, &mut about));
            libraries.notices.append(&mut about.finish());
            MaterialId::from_index(scene.materials.len() - 1)
        } else {
            remarks.add(*line, format!("no material {name:?}: it is grey"));
            grey_id(scene)
        };
        ids.push(id);
    }
    ids
}

/// The material of what has none, kept once: grey, or white under colours of vertices.
fn grey_id(scene: &mut Scene) -> MaterialId {
    let mut grey = Material::grey();
    if scene.meshes.iter().any(|mesh| !mesh.colors.is_empty()) {
        grey.base_color = Vec4::ONE;
    }
    let at = scene.materials.iter().position(|material| material.name == grey.name);
    MaterialId::from_index(at.unwrap_or_else(|| {
        scene.materials.push(grey);
        scene.materials.len() - 1
    }))
}

/// Reads the text of an OBJ file alone, without the files that it refers to: what a fuzzer calls.
///
/// # Errors
/// As [`load`].
pub fn check_obj(bytes: &[u8]) -> Result<(), LoadError> {
    let path = Path::new("fuzz.obj");
    let geometry = parse::parse(bytes, path, &mut Remarks::new(path), &Meter::default())?;
    let built = mesh::build(&geometry);
    built.map(drop).map_err(|intricate| LoadError::invalid(path, "", intricate.to_string()))
}

/// Reads the text of an MTL file alone, without its textures: what a fuzzer calls.
///
/// # Errors
/// As [`load`].
pub fn check_mtl(bytes: &[u8]) -> Result<(), LoadError> {
    let path = Path::new("fuzz.mtl");
    let mut remarks = Remarks::new(path);
    let store = TextureStore::default();
    let mut maps = Maps::new(Path::new("/nowhere"), super::MissingTexture::Magenta, &store);
    let reading = Reading::Told(MtlTransparency::File);
    for parsed in mtl::parse(bytes, path, &mut remarks)? {
        material::convert(&parsed, (path, reading), &mut maps, &mut remarks);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::AlphaMode;

    /// A model of two parts, of materials with such statements; and what is said of it.
    fn load_with(mtl: [&str; 2], told: Option<MtlTransparency>) -> (Vec<f32>, Vec<String>) {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name);
        let text = format!("newmtl a\n{}\nnewmtl b\n{}\n", mtl[0], mtl[1]);
        std::fs::write(place("a.mtl"), text).expect("written");
        let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n\
                    usemtl a\nf 1 2 3\nusemtl b\nf 3 2 1\n";
        std::fs::write(place("a.obj"), text).expect("written");
        let options = LoadOptions { mtl_transparency: told, ..LoadOptions::default() };
        let scene = load(&place("a.obj"), &options).expect("a good file");
        let opacity = |material: &Material| match material.alpha_mode {
            AlphaMode::Opaque => 1.0,
            _ => material.base_color.w,
        };
        let said = scene.notices.into_iter().map(|notice| notice.message).collect();
        (scene.materials.iter().map(opacity).collect(), said)
    }

    #[test]
    fn a_model_is_not_invisible_as_a_whole() {
        for mtl in [["Tr 1.0", "Tr 1"], ["d 0", "Tr 1"]] {
            let (opacities, said) = load_with(mtl, None);
            assert_eq!(opacities, [1.0, 1.0]);
            assert!(said.len() == 1 && said[0].contains("taken as opaque"), "{said:?}");
        }
        // Parts that are hidden stay so.
        assert_eq!(load_with(["Tr 1", "Tr 0.25"], None).0, [0.0, 0.75]);
        assert_eq!(load_with(["d 0", ""], None).0, [0.0, 1.0]);
        // Glass is not invisible: nothing is mended.
        let (_, said) = load_with(["illum 4\nd 0", "d 0"], None);
        assert!(said.iter().all(|it| !it.contains("taken as opaque")), "{said:?}");
    }

    #[test]
    fn transparency_is_as_someone_says() {
        use MtlTransparency::{D, File, Tr};
        for (mtl, told, expected) in [
            (["Tr 1", "Tr 0.75"], D, [1.0, 0.75]),
            (["Tr 1", "Tr 0.75"], Tr, [0.0, 0.25]),
            (["Tr 1", "Tr 1"], File, [0.0, 0.0]),
            (["d 0.5\nTr 1", "d 0.5"], D, [0.5, 0.5]),
            (["d 0.5\nTr 1", "d 0.5"], Tr, [0.0, 0.5]),
            (["d 0.5\nTr 1", "d 0.5"], File, [0.5, 0.5]),
        ] {
            assert_eq!(load_with(mtl, Some(told)).0, expected, "{mtl:?} {told:?}");
        }
    }
}
