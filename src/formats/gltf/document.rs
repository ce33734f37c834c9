//! A whole document, read and checked: afterwards every index in it leads somewhere.

use serde_json::Value;

use super::accessor::{self, Accessor, View};
use super::animation::{self, Animation};
use super::camera::{self, CameraDeclaration};
use super::compressed;
use super::extensions;
use super::image_light::{self, ImageLight};
use super::json::{Fault, Object};
use super::light::{self, LightDeclaration};
use super::material;
use super::mesh::{self, MeshDeclaration};
use super::nodes::{self, Counts, Node};
use super::notices::Notices;
use super::resources::{self, BufferDeclaration};
use super::skin::{self, Skin};
use super::texture::{self, ImageDeclaration, Slots, TextureDeclaration};
use super::variants::{self, Variants};
use crate::formats::find_by_name_or_number;
use crate::scene::{Contents, Material, UsedExtension};

/// One of the scenes of a document.
#[derive(Clone, Debug)]
pub struct SceneDeclaration {
    /// What the file calls it.
    pub name: String,
    /// Nodes without parents.
    pub roots: Vec<usize>,
    /// What shines from all around.
    pub image_light: Option<usize>,
}

/// Everything that the document declares.
#[derive(Debug)]
pub struct Document {
    /// Files of numbers.
    pub buffers: Vec<BufferDeclaration>,
    /// Ranges of them.
    pub views: Vec<View>,
    /// Arrays in those.
    pub accessors: Vec<Accessor>,
    /// Image files.
    pub images: Vec<ImageDeclaration>,
    /// Images with samplers.
    pub textures: Vec<TextureDeclaration>,
    /// Materials, their textures numbered by `slots`.
    pub materials: Vec<Material>,
    /// Which textures materials use, and how.
    pub slots: Slots,
    /// Meshes.
    pub meshes: Vec<MeshDeclaration>,
    /// Nodes; they form trees.
    pub nodes: Vec<Node>,
    /// Skins.
    pub skins: Vec<Skin>,
    /// Nodes without parents.
    pub roots: Vec<usize>,
    /// Animations.
    pub animations: Vec<Animation>,
    /// Cameras.
    pub cameras: Vec<CameraDeclaration>,
    /// Lights.
    pub lights: Vec<LightDeclaration>,
    /// Lights from all around.
    pub image_lights: Vec<ImageLight>,
    /// Scenes.
    pub scenes: Vec<SceneDeclaration>,
    /// The scene to show if none is asked for.
    pub default_scene: Option<usize>,
    /// Names of variants of materials.
    pub variants: Vec<String>,
    /// Extensions that it uses.
    pub extensions: Vec<UsedExtension>,
}

/// Why a document is not read.
#[derive(Debug)]
pub enum Refusal {
    /// Something in it is wrong.
    Fault(Fault),
    /// It requires extensions that are not supported.
    Extensions(Vec<String>),
    /// It has no such variant of materials as is asked for, but these.
    Variant(Vec<String>),
}

impl From<Fault> for Refusal {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

impl Document {
    /// Reads and checks all of a document, also what no scene uses, but for the contents of its
    /// buffers and images. `variant` is the variant of materials to show, by name or number.
    pub fn read(
        value: &Value,
        variant: Option<&str>,
        notices: &mut Notices,
    ) -> Result<Self, Refusal> {
        let root = Object::new(value, String::new())?;
        check_version(&root)?;
        check_extensions(&root)?;
        let extensions = extensions::note(value, &root, notices)?;
        let buffers = resources::buffers(&root)?;
        let lengths: Vec<u64> = buffers.iter().map(|buffer| buffer.length).collect();
        let views = accessor::views(&root, &lengths, notices)?;
        let mut accessors = accessor::accessors(&root, &views, notices)?;
        let images = texture::images(&root, views.len())?;
        let textures = texture::textures(&root, images.len())?;
        let mut slots = Slots::new(textures.len());
        let materials = material::read(&root, &mut slots, notices)?;
        let variants = variants::names(&root)?;
        let shown = choose_variant(&variants, variant)?;
        let choice = Variants { count: variants.len(), materials: materials.len(), shown };
        let declared = accessors.len();
        let mut meshes = mesh::read(&root, declared, choice, notices)?;
        compressed::link(&root, &mut meshes, &mut accessors, views.len(), notices)?;
        let cameras = camera::read(&root, notices)?;
        let lights = light::read(&root, notices)?;
        let nodes_count = root.array("nodes")?.len();
        let skins = skin::read(&root, nodes_count, declared)?;
        let animations = animation::read(&root, nodes_count, declared, notices)?;
        let counts = Counts {
            nodes: nodes_count,
            meshes: meshes.len(),
            accessors: declared,
            cameras: cameras.len(),
            lights: lights.len(),
            skins: skins.len(),
        };
        let nodes = nodes::read(&root, counts, notices)?;
        let parents = nodes::parents(&nodes)?;
        let image_lights = image_light::read(&root, images.len())?;
        let scenes = scenes(&root, &parents, image_lights.len())?;
        let default_scene = root.reference("scene", "scene", scenes.len())?;
        let roots = (0..nodes.len()).filter(|&node| parents[node].is_none()).collect();
        Ok(Self {
            buffers,
            views,
            accessors,
            images,
            textures,
            materials,
            slots,
            meshes,
            nodes,
            skins,
            roots,
            animations,
            cameras,
            lights,
            image_lights,
            scenes,
            default_scene,
            variants,
            extensions,
        })
    }

    /// What the document declares, for those who choose.
    pub fn contents(&self) -> Contents {
        Contents {
            scenes: self.scenes.iter().map(|scene| scene.name.clone()).collect(),
            variants: self.variants.clone(),
            extensions: self.extensions.clone(),
        }
    }

    /// The roots of the scene called `wanted` or else of that number; if none is asked for those
    /// of the default scene, else of the first, else all there are. None: there is no such scene.
    pub fn scene_roots(&self, wanted: Option<&str>) -> Option<&[usize]> {
        match (self.scene(wanted), wanted) {
            (Some(scene), _) => Some(&scene.roots),
            (None, None) => Some(&self.roots),
            (None, Some(_)) => None,
        }
    }

    /// What shines from all around in that scene.
    pub fn image_light(&self, wanted: Option<&str>) -> Option<&ImageLight> {
        Some(&self.image_lights[self.scene(wanted)?.image_light?])
    }

    fn scene(&self, wanted: Option<&str>) -> Option<&SceneDeclaration> {
        let names = self.scenes.iter().map(|scene| scene.name.as_str());
        let default = || Some(self.default_scene.unwrap_or(0));
        let number = wanted.map_or_else(default, |wanted| find_by_name_or_number(names, wanted))?;
        self.scenes.get(number)
    }
}

/// Refuses a document that requires extensions that are not supported.
fn check_extensions(root: &Object) -> Result<(), Refusal> {
    match extensions::find_unsupported(root)? {
        none if none.is_empty() => Ok(()),
        unsupported => Err(Refusal::Extensions(unsupported)),
    }
}

/// The number of the variant that is wanted, if any is.
fn choose_variant(variants: &[String], wanted: Option<&str>) -> Result<Option<usize>, Refusal> {
    let Some(wanted) = wanted else { return Ok(None) };
    match find_by_name_or_number(variants.iter().map(String::as_str), wanted) {
        None => Err(Refusal::Variant(variants.to_vec())),
        found => Ok(found),
    }
}

fn check_version(root: &Object) -> Result<(), Fault> {
    let asset = root.object("asset")?.ok_or_else(|| root.absent("asset"))?;
    let version = asset.text("version")?.ok_or_else(|| asset.absent("version"))?;
    if version.split('.').next() != Some("2") {
        let message = format!("glTF {version} is not supported, only 2.0");
        return Err(asset.fault_at("version", message));
    }
    match asset.text("minVersion")? {
        None | Some("2.0") => Ok(()),
        Some(version) => {
            let message = format!("glTF {version} is required, only 2.0 is supported");
            Err(asset.fault_at("minVersion", message))
        }
    }
}

fn scenes(
    root: &Object,
    parents: &[Option<usize>],
    lights: usize,
) -> Result<Vec<SceneDeclaration>, Fault> {
    let mut listed_by = vec![usize::MAX; parents.len()];
    let mut scene = |(number, object): (usize, &Object)| {
        let roots = object.references("nodes", "node", parents.len())?;
        for (i, &node) in roots.iter().enumerate() {
            let place = || format!("{}/{i}", object.at("nodes"));
            if let Some(parent) = parents[node] {
                let message = format!("node {node} is no root: it is a child of node {parent}");
                return Err(Fault::new(place(), message));
            }
            if std::mem::replace(&mut listed_by[node], number) == number {
                return Err(Fault::new(place(), format!("node {node} is listed twice")));
            }
        }
        let image_light = image_light::of_scene(object, lights)?;
        Ok(SceneDeclaration { name: object.name()?, roots, image_light })
    };
    root.objects("scenes")?.iter().enumerate().map(&mut scene).collect()
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;

    fn document(members: &str) -> Result<Document, Refusal> {
        let text = format!("{{\"asset\": {{\"version\": \"2.0\"}}{members}}}");
        let value = json::parse(text.as_bytes()).expect("valid JSON");
        Document::read(&value, None, &mut Notices::default())
    }

    #[test]
    fn scenes_are_found_by_name_then_number_then_default() {
        let members = r#", "nodes": [{}, {}, {}], "scene": 1,
            "scenes": [{"name": "1", "nodes": [2]}, {"nodes": [0, 1]}]"#;
        let document = document(members).expect("valid");
        assert_eq!(document.scene_roots(None), Some(&[0, 1][..]));
        assert_eq!(document.scene_roots(Some("1")), Some(&[2][..]));
        assert_eq!(document.scene_roots(Some("0")), Some(&[2][..]));
        assert_eq!(document.scene_roots(Some("2")), None);
    }

    #[test]
    fn without_scenes_all_roots_are_shown() {
        let document = document(r#", "nodes": [{}, {"children": [0]}, {}]"#).expect("valid");
        assert_eq!(document.scene_roots(None), Some(&[1, 2][..]));
    }

    #[test]
    fn scenes_list_each_of_their_roots_once() {
        for scenes in [r#"[{"nodes": [0, 0]}]"#, r#"[{"nodes": [1]}]"#, r#"[{"nodes": [2]}]"#] {
            let members =
                format!(", \"nodes\": [{{\"children\": [1]}}, {{}}], \"scenes\": {scenes}");
            assert!(document(&members).is_err(), "{scenes}");
        }
        let both = r#", "nodes": [{}], "scenes": [{"nodes": [0]}, {"nodes": [0]}]"#;
        assert!(document(both).is_ok());
    }

    #[test]
    fn other_versions_are_refused() {
        for asset in [r#""1.0""#, r#""3.0""#, r#""2.1", "minVersion": "2.1""#, "2"] {
            let text = format!("{{\"asset\": {{\"version\": {asset}}}}}");
            let value = json::parse(text.as_bytes()).expect("valid JSON");
            let read = Document::read(&value, None, &mut Notices::default());
            assert!(read.is_err(), "{asset}");
        }
    }
}
