//! The materials that a scene shows.

use super::mesh::Primitive;
use crate::math::MaterialId;
use crate::scene::Material;

/// The materials that primitives use, in the file's order, the default one last.
pub(super) struct Palette {
    pub materials: Vec<Material>,
    /// Of each of the file's materials its new number.
    ids: Vec<Option<MaterialId>>,
    default: Option<MaterialId>,
    /// Of each material which sets of coordinates its textures need.
    pub sets: Vec<[bool; 2]>,
}

impl Palette {
    /// The palette of those primitives, of the materials that the file declares.
    pub fn new<'a>(declared: Vec<Material>, users: impl Iterator<Item = &'a Primitive>) -> Self {
        let mut used = vec![false; declared.len()];
        let mut needs_default = false;
        for primitive in users {
            match primitive.material {
                Some(material) => used[material] = true,
                None => needs_default = true,
            }
        }
        let mut palette = Self {
            materials: Vec::new(),
            ids: vec![None; declared.len()],
            default: None,
            sets: Vec::new(),
        };
        for (i, material) in declared.into_iter().enumerate().filter(|&(i, _)| used[i]) {
            palette.ids[i] = Some(palette.add(material));
        }
        if needs_default {
            palette.default = Some(palette.add(Material::default()));
        }
        palette
    }

    fn add(&mut self, mut material: Material) -> MaterialId {
        let mut sets = [false; 2];
        for texture in material.textures_mut() {
            sets[usize::from(texture.uv_set)] = true;
        }
        self.sets.push(sets);
        self.materials.push(material);
        MaterialId::from_index(self.materials.len() - 1)
    }

    /// The material of a primitive.
    pub fn id(&self, primitive: &Primitive) -> MaterialId {
        let id = match primitive.material {
            Some(material) => self.ids[material],
            None => self.default,
        };
        id.expect("all primitives that are drawn have been asked for their materials")
    }
}
