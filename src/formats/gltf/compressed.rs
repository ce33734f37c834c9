//! Primitives that are packed as a whole (KHR_draco_mesh_compression).
//!
//! Each array of such a primitive becomes an accessor of its own, beside those of the document,
//! that tells which part of which packed mesh it is.

use std::collections::BTreeMap;

use super::accessor::{Accessor, Component, Part, Shape};
use super::json::{Fault, Object};
use super::mesh::{MeshDeclaration, Mode, Primitive};
use super::notices::Notices;

/// The name of the extension.
const NAME: &str = "KHR_draco_mesh_compression";

/// Lets the primitives of `meshes` that are packed read their parts; `views` is how many buffer
/// views there are.
///
/// # Errors
/// Buffer views that are not there, attributes without numbers, modes that cannot be packed.
pub fn link(
    root: &Object,
    meshes: &mut [MeshDeclaration],
    accessors: &mut Vec<Accessor>,
    views: usize,
    notices: &mut Notices,
) -> Result<(), Fault> {
    let mut linker = Linker { accessors, known: BTreeMap::new() };
    for (object, mesh) in root.objects("meshes")?.iter().zip(meshes) {
        let mut drawn = mesh.primitives.iter_mut().peekable();
        for primitive in object.objects("primitives")? {
            let found = drawn.next_if(|drawn| drawn.place == primitive.place());
            let Some(packed) = primitive.extension(NAME)? else { continue };
            let view = packed.required_reference("bufferView", "buffer view", views)?;
            let ids = packed.object("attributes")?.ok_or_else(|| packed.absent("attributes"))?;
            note_extra(&primitive, &ids, notices)?;
            let Some(found) = found else { continue };
            if found.geometry.mode == Mode::Fan {
                return Err(packed.fault("a fan of triangles cannot be packed"));
            }
            linker.primitive(found, view, &packed, &ids)?;
        }
    }
    Ok(())
}

/// Notes what is packed that the primitive does not have: its attributes tell what it consists of.
fn note_extra(primitive: &Object, ids: &Object, notices: &mut Notices) -> Result<(), Fault> {
    let attributes = primitive.object("attributes")?;
    for (name, _) in ids.members() {
        if !attributes.as_ref().is_some_and(|attributes| attributes.has(name)) {
            let message = "is packed, but no attribute of the primitive: it is left out";
            notices.add(ids.at(name), message);
        }
    }
    Ok(())
}

struct Linker<'a> {
    accessors: &'a mut Vec<Accessor>,
    /// Of each part, and the accessor that declares it, its own accessor.
    known: BTreeMap<(Part, Option<usize>), usize>,
}

impl Linker<'_> {
    fn primitive(
        &mut self,
        primitive: &mut Primitive,
        view: usize,
        packed: &Object,
        ids: &Object,
    ) -> Result<(), Fault> {
        let geometry = &mut primitive.geometry;
        let mut attribute = |slot: &mut usize, name: &str| -> Result<(), Fault> {
            let Some(id) = ids.whole(name)? else { return Ok(()) };
            let id =
                u32::try_from(id).map_err(|_| ids.fault_at(name, "is no attribute's number"))?;
            *slot = self.part(Part { view, attribute: Some(id) }, Some(*slot), ids.at(name));
            Ok(())
        };
        attribute(&mut geometry.positions, "POSITION")?;
        for (slot, name) in [
            (&mut geometry.normals, "NORMAL"),
            (&mut geometry.tangents, "TANGENT"),
            (&mut geometry.colors, "COLOR_0"),
        ] {
            if let Some(slot) = slot {
                attribute(slot, name)?;
            }
        }
        for (set, slot) in &mut primitive.uv_sets {
            attribute(slot, &format!("TEXCOORD_{set}"))?;
        }
        for (set, [joints, weights]) in geometry.joints.iter_mut().enumerate() {
            attribute(joints, &format!("JOINTS_{set}"))?;
            attribute(weights, &format!("WEIGHTS_{set}"))?;
        }
        // Whatever they were made of, triangles come out.
        geometry.mode = Mode::Triangles;
        let corners = Part { view, attribute: None };
        let place = packed.place().to_owned();
        geometry.indices = Some(self.part(corners, geometry.indices, place));
        primitive.keep_sets(&[0, 1]);
        Ok(())
    }

    /// The accessor of a part that another one declares.
    fn part(&mut self, part: Part, declared: Option<usize>, place: String) -> usize {
        let Self { accessors, known } = self;
        *known.entry((part, declared)).or_insert_with(|| {
            let accessor = match declared {
                Some(declared) => accessors[declared].as_part(part, place),
                None => Accessor::of_part(part, place, Component::U32, Shape::Scalar),
            };
            accessors.push(accessor);
            accessors.len() - 1
        })
    }
}
