//! What TOML scenes place, put together.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use glam::DAffine3;

use super::copies::Copies;
use super::library::{Library, Loaded};
use super::material::Overrides;
use super::placement::{Part, Placement};
use crate::files::memory;
use crate::formats::copies::CopiesFile;
use crate::formats::{Broken, LoadError, LoadOptions, uri};
use crate::geom::Mesh;
use crate::light::Punctual;
use crate::math::{MaterialId, MeshId, TextureId};
use crate::scene::placement::{light_moved, make_room, narrow, rigid, stays_finite};
use crate::scene::{Instance, Material, MovingLight, Scene, Transform};

/// A scene that parts are added to.
pub struct Stage<'a> {
    folder: &'a Path,
    options: &'a LoadOptions,
    /// What has been loaded, here and by the scenes around this one.
    pub library: &'a mut Library,
    /// What of it this one places.
    parts: Vec<Part>,
    /// Of each mesh its number; parts may share it.
    meshes: HashMap<*const Mesh, MeshId>,
    /// Of a part its meshes, and where its textures begin.
    bases: HashMap<Part, (Rc<[MeshId]>, usize)>,
    /// Of parts with the overrides made where their materials begin.
    materials: Vec<(Part, Overrides, usize)>,
    /// All that is missing.
    pub broken: Vec<Broken>,
    /// What has been put together.
    pub scene: Scene,
}

impl<'a> Stage<'a> {
    /// An empty one for files in a folder.
    pub fn new(folder: &'a Path, options: &'a LoadOptions, library: &'a mut Library) -> Self {
        Self {
            folder,
            options,
            library,
            parts: Vec::new(),
            meshes: HashMap::new(),
            bases: HashMap::new(),
            materials: Vec::new(),
            broken: Vec::new(),
            scene: Scene::default(),
        }
    }

    /// What of which file a placement needs, if that is still to be loaded; what is missing is kept
    /// for later.
    pub fn find(&mut self, at: &Placement) -> Option<Part> {
        if let Copies::InFile(name) = at.copies {
            self.file(at, name);
        }
        let path = self.file(at, at.name)?;
        let part = at.part(path, self.options);
        self.parts.push(part.clone());
        (!self.library.parts.contains_key(&part)).then_some(part)
    }

    /// The file of such a name, which is there.
    fn file(&mut self, at: &Placement, name: &str) -> Option<PathBuf> {
        let broken = |reason| {
            let (name, place) = (name.to_owned(), at.table.place());
            self.broken.push(Broken { name, place, reason, texture: false });
        };
        uri::file(self.folder, name).map_err(broken).ok()
    }

    /// Keeps what has been loaded of a file; what is missing of it is kept for later.
    pub fn keep(&mut self, part: Part, loaded: Result<Scene, LoadError>) -> Result<(), LoadError> {
        let loaded = match loaded {
            Ok(mut scene) => {
                self.scene.notices.append(&mut scene.notices);
                if scene.environment.take().is_some() {
                    self.library.without_surroundings.push(part.0.clone());
                }
                if scene.medium.take().is_some() {
                    self.library.without_medium.push(part.0.clone());
                }
                Loaded::new(scene)
            }
            Err(LoadError::References { broken, .. }) => {
                self.broken.extend(broken.into_iter().map(|one| Broken {
                    place: format!("{}: {}", part.0.display(), one.place),
                    ..one
                }));
                Loaded::default()
            }
            Err(error) => return Err(error),
        };
        self.library.parts.insert(part, Rc::new(loaded));
        Ok(())
    }

    /// Places what has been loaded; `common` are the overrides of all placements.
    pub fn place(&mut self, at: &Placement, common: &Overrides) -> Result<(), LoadError> {
        let Ok(path) = uri::file(self.folder, at.name) else { return Ok(()) };
        let part = at.part(path, self.options);
        let Some(loaded) = self.library.parts.get(&part).cloned() else { return Ok(()) };
        let source = &loaded.scene;
        let names: Vec<String> = source.materials.iter().map(|m| m.name.clone()).collect();
        if let Some((name, line)) = at.overrides.find_unmatched(&names) {
            let wanted = crate::formats::choice::absent("material", name, &names);
            let message = format!("{wanted} ({})", at.name);
            return Err(at.table.fault_on(line, message));
        }
        let (meshes, textures) = self.add_meshes_and_textures(&part, source);
        let materials = self.add_materials(part, source, textures, common.merge(&at.overrides));
        let mut copier = Copier { loaded: &loaded, meshes, materials, scene: &mut self.scene };
        let fault = |message: String| at.table.fault(message);
        match &at.copies {
            Copies::None => {
                copier.make_room(1).map_err(fault)?;
                copier.copy(&at.to_world).map_err(fault)?;
                copier.place_cameras(&at.to_world).map_err(fault)
            }
            Copies::Listed(all) => {
                copier.make_room(all.len() as u64).map_err(fault)?;
                let mut numbered = all.iter().enumerate();
                numbered.try_for_each(|(number, stands)| {
                    let copied = copier.copy(&(at.to_world * stands));
                    copied.map_err(|message| fault(format!("copy {number} {message}")))
                })
            }
            Copies::InFile(name) => {
                let Ok(path) = uri::file(self.folder, name) else { return Ok(()) };
                let file = CopiesFile::read(&path)?;
                copier.make_room(file.most()).map_err(fault)?;
                file.each(&mut |stands| copier.copy(&(at.to_world * stands)))
            }
        }
    }

    /// Adds what a part has of both, once; meshes that other parts share are there already.
    fn add_meshes_and_textures(&mut self, part: &Part, source: &Scene) -> (Rc<[MeshId]>, usize) {
        if let Some(known) = self.bases.get(part) {
            return known.clone();
        }
        let scene = &mut self.scene;
        let mut number = |mesh: &Arc<Mesh>| {
            *self.meshes.entry(Arc::as_ptr(mesh)).or_insert_with(|| {
                scene.meshes.push(mesh.clone());
                MeshId::from_index(scene.meshes.len() - 1)
            })
        };
        let meshes: Rc<[MeshId]> = source.meshes.iter().map(&mut number).collect();
        for (number, mesh) in meshes.iter().enumerate() {
            let moves = source.motion.as_ref().and_then(|motion| motion.deformation(number));
            if let Some(deformation) = moves {
                scene.motion_mut().deform(mesh.index(), Arc::clone(deformation));
            }
        }
        let bases = (meshes, scene.textures.len());
        scene.textures.extend(source.textures.iter().cloned());
        self.bases.insert(part.clone(), bases.clone());
        bases
    }

    /// Where the materials of a part with some overrides begin, which are added once.
    fn add_materials(
        &mut self,
        part: Part,
        source: &Scene,
        textures: usize,
        overrides: Overrides,
    ) -> usize {
        let mut known = self.materials.iter();
        if let Some(known) = known.find(|known| known.0 == part && known.1 == overrides) {
            return known.2;
        }
        let first = self.scene.materials.len();
        let changed = source.materials.iter().map(|m| renumber_material(m, textures, &overrides));
        self.scene.materials.extend(changed);
        self.materials.push((part, overrides, first));
        first
    }

    /// The names of all materials that have been loaded.
    pub fn material_names(&self) -> Vec<String> {
        let parts = self.parts.iter().filter_map(|part| self.library.parts.get(part));
        let mut names: Vec<String> = parts
            .flat_map(|part| part.scene.materials.iter().map(|material| material.name.clone()))
            .collect();
        names.sort_unstable();
        names.dedup();
        names
    }
}

/// About what the motion of a copy takes.
const MOTION_BYTES: u64 = 512;

/// What a place without directions does.
const NO_DIRECTIONS: &str = "leaves no directions to its lights and cameras";

/// Puts copies of a part into a scene.
struct Copier<'s> {
    loaded: &'s Loaded,
    meshes: Rc<[MeshId]>,
    materials: usize,
    scene: &'s mut Scene,
}

impl Copier<'_> {
    /// Asks for the memory of so many copies.
    ///
    /// # Errors
    /// What is the matter.
    fn make_room(&mut self, copies: u64) -> Result<(), String> {
        let source = &self.loaded.scene;
        let of = |count: usize| copies.saturating_mul(count as u64);
        make_room(&mut self.scene.instances, of(source.instances.len()))
            .map_err(|error| error.to_string())?;
        if source.motion.is_some() {
            let bytes = of(source.instances.len()).saturating_mul(MOTION_BYTES);
            memory::claim(bytes).map_err(|error| format!("their motion {error}"))?;
        }
        let lights = of(source.lights.len());
        memory::claim(lights.saturating_mul(size_of::<Punctual>() as u64))
            .map_err(|error| format!("{lights} lights: their list {error}"))
    }

    /// Puts a copy where it stands. Lights keep their strength whatever the scale, as at the nodes
    /// of a glTF file.
    ///
    /// # Errors
    /// What is the matter.
    fn copy(&mut self, to_world: &DAffine3) -> Result<(), String> {
        let (source, scene) = (&self.loaded.scene, &mut *self.scene);
        let motion = source.motion.as_ref();
        for (number, instance) in source.instances.iter().enumerate() {
            if let Some(motion) = motion.and_then(|motion| motion.placement(number)) {
                let motion = Arc::new(motion.within(*to_world));
                let instance = scene.instances.len();
                scene.motion_mut().move_placement(instance, motion);
            }
            let to_world = *to_world * widen(&instance.transform);
            let bounds = self.loaded.bounds[instance.mesh.index()];
            if !bounds.is_empty() && !stays_finite(&to_world, bounds) {
                return Err("places its meshes beyond the range of 32-bit floats".to_owned());
            }
            scene.instances.push(Instance {
                mesh: self.meshes[instance.mesh.index()],
                material: MaterialId::from_index(self.materials + instance.material.index()),
                transform: Transform::new(narrow(&to_world)),
            });
        }
        if source.lights.is_empty() {
            return Ok(());
        }
        for number in 0..source.lights.len() {
            if let Some(moving) = motion.and_then(|motion| motion.light(number)) {
                let mut moving = MovingLight::clone(moving);
                moving.placed.push(*to_world);
                let light = scene.lights.len() + number;
                scene.motion_mut().move_light(light, Arc::new(moving));
            }
        }
        for light in &source.lights {
            scene.lights.push(light_moved(light, to_world).ok_or(NO_DIRECTIONS)?);
        }
        Ok(())
    }

    /// Puts the cameras where they stand; those that look nowhere stay away.
    ///
    /// # Errors
    /// That all of them do.
    fn place_cameras(&mut self, to_world: &DAffine3) -> Result<(), String> {
        let cameras = &self.loaded.scene.cameras;
        if !cameras.is_empty() && rigid(to_world).is_none() {
            return Err(NO_DIRECTIONS.to_owned());
        }
        let motion = self.loaded.scene.motion.as_ref();
        for (number, named) in cameras.iter().enumerate() {
            let mut named = named.clone();
            let own =
                DAffine3::from_cols_array(&named.camera.to_world.to_cols_array().map(f64::from));
            let Some(stands) = rigid(&(*to_world * own)) else { continue };
            named.camera.to_world = narrow(&stands);
            // They would have to be scaled as the scene is.
            named.planes = None;
            if let Some(motion) = motion.and_then(|motion| motion.camera(number)) {
                let motion = Arc::new(motion.within(*to_world));
                let camera = self.scene.cameras.len();
                self.scene.motion_mut().move_camera(camera, motion);
            }
            self.scene.cameras.push(named);
        }
        Ok(())
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
