//! Many copies of one node's mesh (EXT_mesh_gpu_instancing).

use glam::{DAffine3, DQuat, DVec3};

use super::json::{Fault, Object};
use super::notices::Notices;
use super::read::Storage;
use super::rows::Rows;

/// The accessors of the copies' placements, relative to the node; those that are absent change
/// nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instancing {
    /// The pointer to the attributes.
    place: String,
    translations: Option<usize>,
    rotations: Option<usize>,
    scales: Option<usize>,
}

impl Instancing {
    /// Reads the extension of a node, if it has it; `accessors` is how many there are.
    pub fn read(
        node: &Object,
        accessors: usize,
        notices: &mut Notices,
    ) -> Result<Option<Self>, Fault> {
        let Some(extension) = node.extension("EXT_mesh_gpu_instancing")? else { return Ok(None) };
        let attributes =
            extension.object("attributes")?.ok_or_else(|| extension.absent("attributes"))?;
        for (name, _) in attributes.members() {
            attributes.reference(name, "accessor", accessors)?;
            // What begins with an underscore is the application's own.
            if !name.starts_with('_') && !["TRANSLATION", "ROTATION", "SCALE"].contains(&&**name) {
                notices.add(attributes.at(name), "is no attribute of copies, and is left out");
            }
        }
        let attribute = |name| attributes.reference(name, "accessor", accessors);
        Ok(Some(Self {
            place: attributes.place().to_owned(),
            translations: attribute("TRANSLATION")?,
            rotations: attribute("ROTATION")?,
            scales: attribute("SCALE")?,
        }))
    }

    /// All accessors that it reads.
    pub fn accessors(&self) -> impl Iterator<Item = usize> {
        [self.translations, self.rotations, self.scales].into_iter().flatten()
    }

    /// The copies, in the file's buffers.
    ///
    /// # Errors
    /// Attributes of different lengths, or of another type than the extension asks for.
    pub fn copies<'s>(&'s self, storage: &'s Storage) -> Result<Copies<'s>, Fault> {
        let counts = || self.accessors().map(|index| storage.accessor(index).count);
        let count = counts().next().unwrap_or(0);
        if counts().any(|other| other != count) {
            let message = "its attributes have different numbers of elements";
            return Err(Fault::new(self.place.clone(), message));
        }
        Ok(Copies {
            place: &self.place,
            count,
            translations: rows(storage, self.translations, [0.0; 3])?,
            rotations: rows(storage, self.rotations, [0.0, 0.0, 0.0, 1.0])?,
            scales: rows(storage, self.scales, [1.0; 3])?,
        })
    }
}

/// Where the copies of a node stand, read from the file's buffers one by one.
#[derive(Debug)]
pub struct Copies<'s> {
    /// The pointer to the attributes.
    pub place: &'s str,
    /// How many there are.
    pub count: u64,
    translations: Rows<'s, 3>,
    rotations: Rows<'s, 4>,
    scales: Rows<'s, 3>,
}

impl Copies<'_> {
    /// Where a copy stands, relative to the node.
    ///
    /// # Errors
    /// Numbers that are not finite, a rotation that is none.
    pub fn placement(&self, number: usize) -> Result<DAffine3, Fault> {
        let turn = DQuat::from_array(self.rotations.get(number).map(f64::from));
        let length = turn.length();
        let placement = DAffine3::from_scale_rotation_translation(
            DVec3::from_array(self.scales.get(number).map(f64::from)),
            turn * (1.0 / length),
            DVec3::from_array(self.translations.get(number).map(f64::from)),
        );
        if length < 1e-6 || !placement.is_finite() {
            let message = format!(
                "copy {number} has no place: a number is not finite, or its rotation is zero"
            );
            return Err(Fault::new(self.place, message));
        }
        Ok(placement)
    }
}

fn rows<'s, const N: usize>(
    storage: &'s Storage,
    accessor: Option<usize>,
    default: [f32; N],
) -> Result<Rows<'s, N>, Fault> {
    accessor.map_or(Ok(Rows::Constant(default)), |accessor| storage.rows(accessor))
}
