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
    /// Of each material which of the two sets that a mesh keeps its textures need.
    pub sets: Vec<[bool; 2]>,
    /// Whether a material looks up more sets than two.
    pub has_too_many: bool,
    /// Of each material which sets of the file these two are.
    kept: Vec<[Option<u8>; 2]>,
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
            has_too_many: false,
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
        let used: BTreeSet<u8> = material.textures_mut().map(|texture| texture.uv_set).collect();
        let kept = if used.iter().all(|&set| set < 2) {
            [Some(0), Some(1)]
        } else {
            let mut used = used.into_iter();
            [used.next(), used.next()]
        };
        let mut sets = [false; 2];
        for texture in material.textures_mut() {
            let slot = kept.iter().position(|&set| set == Some(texture.uv_set));
            self.has_too_many |= slot.is_none();
            texture.uv_set = slot.unwrap_or(0) as u8;
            sets[usize::from(texture.uv_set)] = true;
        }
        self.kept.push(kept);
        self.sets.push(sets);
        self.materials.push(material);
        MaterialId::from_index(self.materials.len() - 1)
    }

    /// The sets of coordinates that a primitive is to keep; none: it is not drawn.
    pub fn kept(&self, primitive: &Primitive) -> Option<[Option<u8>; 2]> {
        self.known(primitive).map(|id| self.kept[id.index()])
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
