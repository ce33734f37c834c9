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
mod lines;
mod maps;
mod material;
mod mesh;
mod mtl;
mod remarks;
mod smoothing;
mod texture_statement;

use std::collections::{HashMap, HashSet};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use geometry::Geometry;
use maps::Maps;
use mtl::MtlMaterial;
use remarks::Remarks;

use super::{LoadError, LoadOptions, read_file};
use crate::math::{Affine3A, MaterialId, MeshId, Vec4};
use crate::scene::{Instance, Material, Notice, Scene, Transform};

/// Loads an OBJ file, its material libraries and their textures.
///
/// # Errors
/// [`LoadError`] with the line of a malformed statement, or a list of all unusable textures.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    options.refuse_choices(path)?;
    let mut remarks = Remarks::new(path);
    let geometry = geometry::parse(&read_file(path)?, path, &mut remarks)?;
    let folder = path.parent().unwrap_or(Path::new(""));

    let mut libraries = Libraries::new(path, folder);
    for (line, names) in &geometry.libraries {
        libraries.load(names, *line, &mut remarks)?;
    }
    if let ([], [(_, line), ..]) = (&*geometry.libraries, &*geometry.materials) {
        let instead = libraries.load_namesake()?;
        remarks.add(*line, format!("materials without mtllib{instead}"));
    }
    let mut maps = Maps::new(folder, options.missing_texture);
    let mut scene = Scene::default();
    let ids = materials(&geometry, &mut libraries, &mut maps, &mut scene, &mut remarks);
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

/// The materials that the geometry uses, in the order of their first use, and their ids.
fn materials(
    geometry: &Geometry,
    libraries: &mut Libraries,
    maps: &mut Maps,
    scene: &mut Scene,
    remarks: &mut Remarks,
) -> Vec<MaterialId> {
    let mut ids = Vec::with_capacity(geometry.materials.len());
    for (name, line) in &geometry.materials {
        let id = if let Some((file, parsed)) = libraries.materials.get(name) {
            let mut about = Remarks::new(file);
            scene.materials.push(material::convert(parsed, file, maps, &mut about));
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

/// All materials of the libraries read so far.
struct Libraries<'a> {
    scene: &'a Path,
    folder: &'a Path,
    read: HashSet<PathBuf>,
    /// By name, with the file that they stand in.
    materials: HashMap<String, (PathBuf, MtlMaterial)>,
    notices: Vec<Notice>,
}

impl<'a> Libraries<'a> {
    fn new(scene: &'a Path, folder: &'a Path) -> Self {
        let (materials, notices) = (HashMap::new(), Vec::new());
        Self { scene, folder, read: HashSet::new(), materials, notices }
    }

    /// Loads what a `mtllib` statement names: one file whose name may hold spaces, or several.
    fn load(&mut self, names: &str, line: usize, remarks: &mut Remarks) -> Result<(), LoadError> {
        let whole = lines::unquoted(names);
        let names = match confined(self.folder, whole) {
            Some(path) if path.is_file() => vec![whole.to_owned()],
            _ => lines::names(names),
        };
        for name in names {
            let problem = match confined(self.folder, &name) {
                Some(path) if path.is_file() => {
                    self.read(&path)?;
                    continue;
                }
                Some(_) => "is missing",
                None => "is not read: it leaves the scene's folder",
            };
            let instead = self.load_namesake()?;
            remarks.add(line, format!("material library {name:?} {problem}{instead}"));
        }
        Ok(())
    }

    /// Loads the library that is called like the scene, as a last resort; says so, if it is there.
    fn load_namesake(&mut self) -> Result<String, LoadError> {
        let path = self.scene.with_extension("mtl");
        if !path.is_file() {
            return Ok(String::new());
        }
        self.read(&path)?;
        Ok(format!("; {} is used instead", path.display()))
    }

    fn read(&mut self, path: &Path) -> Result<(), LoadError> {
        if !self.read.insert(path.to_path_buf()) {
            return Ok(());
        }
        let mut remarks = Remarks::new(path);
        for material in mtl::parse(&read_file(path)?, path, &mut remarks)? {
            if self.materials.contains_key(&material.name) {
                let name = &material.name;
                remarks.add(material.line, format!("material {name:?} again: the first counts"));
                continue;
            }
            self.materials.insert(material.name.clone(), (path.to_path_buf(), material));
        }
        self.notices.append(&mut remarks.finish());
        Ok(())
    }
}

/// The path of a file that the scene refers to, by either kind of slash, or none if it would leave
/// the scene's folder.
fn confined(folder: &Path, name: &str) -> Option<PathBuf> {
    let name = name.replace('\\', "/");
    // On Unix `C:` would be a folder like any other.
    if name.is_empty() || name.as_bytes().get(1) == Some(&b':') {
        return None;
    }
    let mut inside = PathBuf::new();
    for component in Path::new(&name).components() {
        match component {
            Component::Normal(part) => inside.push(part),
            Component::CurDir => {}
            Component::ParentDir if inside.pop() => {}
            _ => return None,
        }
    }
    Some(folder.join(inside))
}

/// Reads the text of an OBJ file alone, without the files that it refers to: what a fuzzer calls.
///
/// # Errors
/// As [`load`].
pub fn check_obj(bytes: &[u8]) -> Result<(), LoadError> {
    let path = Path::new("fuzz.obj");
    let geometry = geometry::parse(bytes, path, &mut Remarks::new(path))?;
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
    let mut maps = Maps::new(Path::new("/nowhere"), crate::formats::MissingTexture::Magenta);
    for parsed in mtl::parse(bytes, path, &mut remarks)? {
        material::convert(&parsed, path, &mut maps, &mut remarks);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_stay_in_the_folder() {
        let folder = Path::new("scenes");
        let inside = |name| confined(folder, name);
        assert_eq!(inside(".\\maps\\a b.png"), Some("scenes/maps/a b.png".into()));
        assert_eq!(inside("maps/../a.png"), Some("scenes/a.png".into()));
        for outside in ["../a.png", "maps/../../a.png", "/etc/passwd", "C:\\a.png", "\\\\host\\a"] {
            assert_eq!(inside(outside), None, "{outside}");
        }
    }
}
