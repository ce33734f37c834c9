//! Vertices as places of copies.

use std::path::Path;

use glam::{DAffine3, DQuat, DVec3};

use super::header::{self, Encoding, Header, Kind};
use super::values::{Ascii, Binary, Problem, Values, possible_rows, skip, skip_rows};
use crate::formats::LoadError;

/// What a property is for: an index into a row's numbers.
const NAMES: [&str; 14] = [
    "x", "y", "z", "nx", "ny", "nz", "qx", "qy", "qz", "qw", "scale", "scale_x", "scale_y",
    "scale_z",
];

/// What a row has where the file tells nothing.
const DEFAULTS: [f64; NAMES.len()] =
    [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0];

/// Properties that come together or not at all.
const GROUPS: [(&str, std::ops::Range<usize>); 3] =
    [("nx, ny, nz", 3..6), ("qx, qy, qz, qw", 6..10), ("scale_x, scale_y, scale_z", 11..14)];

/// The vertices of a file, each of which says where a copy stands: `x y z`; `scale`, and `scale_x
/// scale_y scale_z`; a quaternion `qx qy qz qw`, or else a normal `nx ny nz`, to which +Y is turned
/// the shortest way. Scale comes first, then rotation, then translation.
#[derive(Debug)]
pub struct Points {
    bytes: Vec<u8>,
    header: Header,
    /// Of each property its kind and its index into `NAMES`.
    slots: Vec<(Kind, Option<usize>)>,
    /// Whether the file has quaternions.
    turned: bool,
}

impl Points {
    /// Reads a file's contents; `path` is for messages.
    ///
    /// # Errors
    /// What is wrong with the header, or that there are no such properties.
    pub fn read(path: &Path, bytes: Vec<u8>) -> Result<Self, LoadError> {
        let header = header::read(&bytes, path)?;
        let mut has = [false; NAMES.len()];
        let vertices = header.elements.iter().find(|element| element.name == "vertex");
        let properties = vertices.map_or(&[][..], |element| &element.properties);
        let slots = properties.iter().map(|property| {
            let slot = match property.kind {
                Kind::One(_) => NAMES.iter().position(|name| *name == property.name),
                Kind::List(..) => None,
            };
            (property.kind, slot.filter(|&slot| !std::mem::replace(&mut has[slot], true)))
        });
        let slots = slots.collect();
        let refused = |message: String| Err(LoadError::invalid(path, "", message));
        if !has[..3].iter().all(|&has| has) {
            return refused("has no vertices with x, y and z".to_owned());
        }
        for (names, group) in GROUPS {
            let there = has[group.clone()].iter().filter(|&&has| has).count();
            if there != 0 && there != group.len() {
                return refused(format!("its vertices have some of {names}, not all"));
            }
        }
        Ok(Self { bytes, header, slots, turned: has[6] })
    }

    /// How many there are at most: what the header promises and the file can hold.
    pub fn most(&self) -> u64 {
        let body = &self.bytes[self.header.length..];
        let rows = |element| match self.header.encoding {
            Encoding::Ascii => possible_rows(&Ascii::new(body, 0, 0), element, 0),
            Encoding::Little | Encoding::Big => {
                possible_rows(&Binary::new(body, false), element, 0)
            }
        };
        let vertices = self.header.elements.iter().find(|element| element.name == "vertex");
        vertices.map_or(0, rows) as u64
    }

    /// Gives each vertex's place to `place`, in the order of the file.
    ///
    /// # Errors
    /// A place that is none, or what `place` complains of, with the vertex.
    pub fn each(
        &self,
        path: &Path,
        place: &mut dyn FnMut(&DAffine3) -> Result<(), String>,
    ) -> Result<(), LoadError> {
        let (body, elements) = (&self.bytes[self.header.length..], &self.header.elements);
        match self.header.encoding {
            Encoding::Ascii => {
                let rows = elements.iter().fold(0, |sum: u64, it| sum.saturating_add(it.count));
                self.walk(Ascii::new(body, self.header.lines, rows), path, place)
            }
            Encoding::Little => self.walk(Binary::new(body, false), path, place),
            Encoding::Big => self.walk(Binary::new(body, true), path, place),
        }
    }

    fn walk(
        &self,
        mut values: impl Values,
        path: &Path,
        place: &mut dyn FnMut(&DAffine3) -> Result<(), String>,
    ) -> Result<(), LoadError> {
        for element in &self.header.elements {
            if element.name != "vertex" {
                skip_rows(&mut values, element, path)?;
                continue;
            }
            for number in 0..element.count {
                let stands = self.row(&mut values).and_then(|row| self.stands(&row));
                stands
                    .and_then(|stands| place(&stands))
                    .map_err(|problem| values.error(path, "vertex", number, &problem))?;
                values.end_row();
            }
            break;
        }
        Ok(())
    }

    fn row(&self, values: &mut impl Values) -> Result<[f64; NAMES.len()], Problem> {
        let mut row = DEFAULTS;
        for &(kind, slot) in &self.slots {
            match (kind, slot) {
                (Kind::One(kind), Some(slot)) => row[slot] = values.number(kind)?,
                _ => skip(values, kind)?,
            }
        }
        Ok(row)
    }

    fn stands(&self, row: &[f64; NAMES.len()]) -> Result<DAffine3, Problem> {
        if !row.iter().all(|number| number.is_finite()) {
            return Err("a number is not finite".to_owned());
        }
        let rotation = if self.turned {
            let quaternion = DQuat::from_slice(&row[6..10]);
            if quaternion.length() < 1e-6 {
                return Err("its rotation is none: its length is 0".to_owned());
            }
            quaternion.normalize()
        } else {
            let up = DVec3::from_slice(&row[3..6]).try_normalize();
            let up = up.ok_or("its normal has no direction")?;
            DQuat::from_rotation_arc(DVec3::Y, up)
        };
        let scale = DVec3::from_slice(&row[11..14]) * row[10];
        let translation = DVec3::from_slice(&row[..3]);
        Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translation))
    }
}
