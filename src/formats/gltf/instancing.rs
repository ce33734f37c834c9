//! Many copies of one node's mesh (EXT_mesh_gpu_instancing).

use glam::{DAffine3, DQuat, DVec3};

use super::json::{Fault, Object};
use super::notices::Notices;
use super::read::Storage;

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

    /// Where the copies stand, relative to the node.
    ///
    /// # Errors
    /// Attributes of different lengths, numbers that are not finite, more than `most` copies.
    pub fn placements(&self, storage: &Storage, most: usize) -> Result<Vec<DAffine3>, Fault> {
        let counts = || self.accessors().map(|index| storage.accessor(index).count);
        let count = counts().next().unwrap_or(0);
        if counts().any(|other| other != count) {
            let message = "its attributes have different numbers of elements";
            return Err(Fault::new(self.place.clone(), message));
        }
        if count > most as u64 {
            let message = format!("{count} copies are too many; {most} more at most");
            return Err(Fault::new(self.place.clone(), message));
        }
        storage.reserve(&self.place, count * size_of::<DAffine3>() as u64)?;
        let translations = vectors(storage, self.translations, [0.0; 3], count)?;
        let rotations = vectors(storage, self.rotations, [0.0, 0.0, 0.0, 1.0], count)?;
        let scales = vectors(storage, self.scales, [1.0; 3], count)?;
        let parts = translations.into_iter().zip(rotations).zip(scales).enumerate();
        parts
            .map(|(number, ((translation, rotation), scale))| {
                let turn = DQuat::from_array(rotation.map(f64::from));
                let length = turn.length();
                let placement = DAffine3::from_scale_rotation_translation(
                    DVec3::from_array(scale.map(f64::from)),
                    turn * (1.0 / length),
                    DVec3::from_array(translation.map(f64::from)),
                );
                if length < 1e-6 || !placement.is_finite() {
                    let message = format!(
                        "copy {number} has no place: a number is not finite, or \
                        its rotation is zero"
                    );
                    return Err(Fault::new(self.place.clone(), message));
                }
                Ok(placement)
            })
            .collect()
    }
}

fn vectors<const N: usize>(
    storage: &Storage,
    accessor: Option<usize>,
    default: [f32; N],
    count: u64,
) -> Result<Vec<[f32; N]>, Fault> {
    match accessor {
        Some(accessor) => storage.vectors::<N>(accessor),
        None => Ok(vec![default; count as usize]),
    }
}
