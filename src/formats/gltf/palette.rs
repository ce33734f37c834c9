//! The materials that a scene shows, and which sets of texture coordinates they look up.

use std::collections::BTreeSet;

use super::mesh::Primitive;
use crate::math::MaterialId;
use crate::scene::Material;

/// The materials that primitives use, in the file's order, the default one last.
pub(super) struct Palette {
    pub materials: Vec<Material>,
    /// Of each of the file's materials its new number.
    ids: Vec<Option<MaterialId>>,
    default: Option<MaterialId>,
    /// Of each material which of the sets that a mesh keeps its textures need.
    pub sets: Vec<BTreeSet<u32>>,
    /// Of each material which sets of the file a mesh keeps for it.
    kept: Vec<Vec<u32>>,
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
            kept: Vec::new(),
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
        let used: BTreeSet<u32> = material.textures_mut().map(|texture| texture.uv_set).collect();
        // The first two stay what they are; else all that are looked up move together.
        let kept: Vec<u32> =
            if used.iter().all(|&set| set < 2) { vec![0, 1] } else { used.into_iter().collect() };
        let mut sets = BTreeSet::new();
        for texture in material.textures_mut() {
            let slot = kept.iter().position(|&set| set == texture.uv_set);
            texture.uv_set = slot.map_or(texture.uv_set, |slot| slot as u32);
            sets.insert(texture.uv_set);
        }
        self.kept.push(kept);
        self.sets.push(sets);
        self.materials.push(material);
        MaterialId::from_index(self.materials.len() - 1)
    }

    /// The sets of coordinates that a primitive is to keep; none: it is not drawn.
    pub fn kept(&self, primitive: &Primitive) -> Option<&[u32]> {
        self.known(primitive).map(|id| &*self.kept[id.index()])
    }

    /// The material of a primitive.
    pub fn id(&self, primitive: &Primitive) -> MaterialId {
        let known = self.known(primitive);
        known.expect("all primitives that are drawn have been asked for their materials")
    }

    /// The same, if it was asked for.
    fn known(&self, primitive: &Primitive) -> Option<MaterialId> {
        match primitive.material {
            Some(material) => self.ids[material],
            None => self.default,
        }
    }
}
