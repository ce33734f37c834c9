//! Files that a TOML scene places, and where.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DMat4, DQuat, DVec3};

use super::material::Overrides;
use super::reader::Table;
use crate::formats::model::load_model;
use crate::formats::{Broken, LoadError, LoadOptions, uri};
use crate::geom::Mesh;
use crate::math::{Aabb, MaterialId, MeshId, TextureId};
use crate::scene::placement::{MAX_INSTANCES, narrow, rigid, stays_finite};
use crate::scene::{Instance, Material, Scene, Transform};

/// A file, where it stands and what is changed of it.
pub struct Placement<'d> {
    table: Table<'d>,
    name: &'d str,
    scene: Option<String>,
    variant: Option<String>,
    animation: Option<String>,
    time: Option<f32>,
    to_world: DAffine3,
    overrides: Overrides,
}

impl<'d> Placement<'d> {
    pub fn read(table: Table<'d>) -> Result<Self, LoadError> {
        let name = table.required_text("file")?;
        if ending_of(Path::new(name)).as_deref() == Some("toml") {
            let message = "is a TOML scene, which cannot be placed: place the files that it places";
            return Err(table.fault_at("file", message));
        }
        let owned = |key| Ok::<_, LoadError>(table.text(key)?.map(str::to_owned));
        let (scene, variant) = (owned("scene")?, owned("variant")?);
        let animation = owned("animation")?;
        let time = table.number_in("time", -f32::MAX..=f32::MAX)?;
        let to_world = transform(&table)?;
        let overrides = match table.table("material")? {
            Some(tables) => Overrides::read(&tables)?,
            None => Overrides::default(),
        };
        table.finish()?;
        Ok(Self { table, name, scene, variant, animation, time, to_world, overrides })
    }

    fn part(&self, path: PathBuf, options: &LoadOptions) -> Part {
        let time = self.time.or(options.time).map(f32::to_bits);
        (path, [&self.scene, &self.variant, &self.animation].map(Clone::clone), time)
    }
}

fn ending_of(path: &Path) -> Option<String> {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase())
}

/// A matrix by columns, or else scale, then rotation, then translation.
fn transform(table: &Table) -> Result<DAffine3, LoadError> {
    let translate = table.numbers::<3>("translate")?.map(DVec3::from_array);
    let rotate = table.one_of_numbers::<3, 4>("rotate")?;
    let scale = table.scale("scale")?.map(DVec3::from_array);
    if let Some(columns) = table.numbers::<16>("matrix")? {
        if translate.is_some() || rotate.is_some() || scale.is_some() {
            return Err(table.fault("has both a matrix and translate, rotate or scale"));
        }
        let matrix = DMat4::from_cols_array(&columns);
        if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
            let message = "its columns must end in 0, 0, 0 and 1: the translation comes last";
            return Err(table.fault_at("matrix", message));
        }
        return Ok(DAffine3::from_mat4(matrix));
    }
    let rotation = match rotate {
        None => DQuat::IDENTITY,
        Some(Ok(degrees)) => {
            let [x, y, z] = degrees.map(f64::to_radians);
            DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x)
        }
        Some(Err(quaternion)) => {
            let quaternion = DQuat::from_array(quaternion);
            if quaternion.length() < 1e-6 {
                return Err(table.fault_at("rotate", "is no rotation: its length is 0"));
            }
            quaternion.normalize()
        }
    };
    let (scale, translate) = (scale.unwrap_or(DVec3::ONE), translate.unwrap_or_default());
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translate))
}

/// What of a file is loaded: its path, one of its scenes, one of its variants, one of its
/// animations, and the bits of the time that it is posed at.
type Part = (PathBuf, [Option<String>; 3], Option<u32>);

/// A scene that parts are added to; each file is loaded once.
pub struct Stage<'a> {
    folder: &'a Path,
    options: &'a LoadOptions,
    /// Each with the boxes of its meshes.
    parts: HashMap<Part, (Scene, Vec<Aabb>)>,
    /// Of a part where its meshes and textures begin.
    bases: HashMap<Part, (usize, usize)>,
    /// Of parts with the overrides made where their materials begin.
    materials: Vec<(Part, Overrides, usize)>,
    /// All that is missing.
    pub broken: Vec<Broken>,
    /// What has been put together.
    pub scene: Scene,
}

impl<'a> Stage<'a> {
    /// An empty one for files in a folder.
    pub fn new(folder: &'a Path, options: &'a LoadOptions) -> Self {
        Self {
            folder,
            options,
            parts: HashMap::new(),
            bases: HashMap::new(),
            materials: Vec::new(),
            broken: Vec::new(),
            scene: Scene::default(),
        }
    }

    /// Loads the file of a placement; what is missing is kept for later.
    pub fn load(&mut self, at: &Placement) -> Result<(), LoadError> {
        let place = at.table.place();
        let mut missing = |name: &str, place: String, reason: String, texture| {
            self.broken.push(Broken { name: name.to_owned(), place, reason, texture });
        };
        let path = match uri::file(self.folder, at.name) {
            Ok(path) => path,
            Err(reason) => {
                missing(at.name, place, reason, false);
                return Ok(());
            }
        };
        let part = at.part(path.clone(), self.options);
        if self.parts.contains_key(&part) {
            return Ok(());
        }
        let options = LoadOptions {
            strict: false,
            scene: at.scene.clone(),
            variant: at.variant.clone(),
            animation: at.animation.clone(),
            time: at.time.or(self.options.time),
            ..self.options.clone()
        };
        match load_model(&path, &options) {
            Ok(mut scene) => {
                self.scene.notices.append(&mut scene.notices);
                let points = |mesh: &Arc<Mesh>| Aabb::of_points(mesh.positions.iter().copied());
                let bounds = scene.meshes.iter().map(points).collect();
                self.parts.insert(part, (scene, bounds));
            }
            Err(LoadError::References { broken, .. }) => {
                for one in broken {
                    let place = format!("{}: {}", path.display(), one.place);
                    missing(&one.name, place, one.reason, one.texture);
                }
                // Its failure is told once.
                self.parts.insert(part, (Scene::default(), Vec::new()));
            }
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// Places what has been loaded; `common` are the overrides of all placements.
    pub fn place(&mut self, at: &Placement, common: &Overrides) -> Result<(), LoadError> {
        let Ok(path) = uri::file(self.folder, at.name) else { return Ok(()) };
        let part = at.part(path, self.options);
        let Some((source, bounds)) = self.parts.get(&part) else { return Ok(()) };
        let names: Vec<String> = source.materials.iter().map(|m| m.name.clone()).collect();
        if let Some((name, line)) = at.overrides.find_unmatched(&names) {
            let wanted = crate::formats::choice::absent("material", name, &names);
            let message = format!("{wanted} ({})", at.name);
            return Err(at.table.fault_on(line, message));
        }
        if self.scene.instances.len() + source.instances.len() > MAX_INSTANCES {
            return Err(at.table.fault(format!("more than {MAX_INSTANCES} meshes are placed")));
        }
        let scene = &mut self.scene;
        let (meshes, textures) = *self.bases.entry(part.clone()).or_insert_with(|| {
            let bases = (scene.meshes.len(), scene.textures.len());
            scene.meshes.extend(source.meshes.iter().cloned());
            scene.textures.extend(source.textures.iter().cloned());
            bases
        });
        let overrides = common.merge(&at.overrides);
        let known = self.materials.iter().find(|known| known.0 == part && known.1 == overrides);
        let materials = if let Some(known) = known {
            known.2
        } else {
            let first = scene.materials.len();
            let changed =
                source.materials.iter().map(|m| renumber_material(m, textures, &overrides));
            scene.materials.extend(changed);
            self.materials.push((part.clone(), overrides, first));
            first
        };
        for instance in &source.instances {
            let to_world = at.to_world * widen(&instance.transform);
            let bounds = bounds[instance.mesh.index()];
            if !bounds.is_empty() && !stays_finite(&to_world, bounds) {
                let message = "places its meshes beyond the range of 32-bit floats";
                return Err(at.table.fault(message));
            }
            scene.instances.push(Instance {
                mesh: MeshId::from_index(meshes + instance.mesh.index()),
                material: MaterialId::from_index(materials + instance.material.index()),
                transform: Transform::new(narrow(&to_world)),
            });
        }
        place_lights_and_cameras(source, at, scene)
    }

    /// The names of all materials that have been loaded.
    pub fn material_names(&self) -> Vec<String> {
        let mut names: Vec<String> = self
            .parts
            .values()
            .flat_map(|(part, _)| part.materials.iter().map(|material| material.name.clone()))
            .collect();
        names.sort_unstable();
        names.dedup();
        names
    }
}

fn renumber_material(material: &Material, textures: usize, overrides: &Overrides) -> Material {
    let mut material = material.clone();
    for texture in material.textures_mut() {
        texture.texture = TextureId::from_index(textures + texture.texture.index());
    }
    overrides.apply(&mut material);
    material
}

fn widen(transform: &Transform) -> DAffine3 {
    DAffine3::from_cols_array(&transform.to_world().to_cols_array().map(f64::from))
}

/// Lights keep their strength whatever the scale, as at the nodes of a glTF file.
fn place_lights_and_cameras(
    source: &Scene,
    at: &Placement,
    scene: &mut Scene,
) -> Result<(), LoadError> {
    if source.lights.is_empty() && source.cameras.is_empty() {
        return Ok(());
    }
    let turned = rigid(&at.to_world);
    let turned =
        turned.ok_or_else(|| at.table.fault("leaves no directions to its lights and cameras"))?;
    for light in &source.lights {
        let mut light = *light;
        light.position = at.to_world.transform_point3(light.position.as_dvec3()).as_vec3();
        light.direction = turned.transform_vector3(light.direction.as_dvec3()).as_vec3();
        scene.lights.push(light);
    }
    for named in &source.cameras {
        let mut named = named.clone();
        let own = DAffine3::from_cols_array(&named.camera.to_world.to_cols_array().map(f64::from));
        let Some(to_world) = rigid(&(at.to_world * own)) else { continue };
        named.camera.to_world = narrow(&to_world);
        scene.cameras.push(named);
    }
    Ok(())
}
