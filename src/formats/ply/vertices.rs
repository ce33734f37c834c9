//! The element `vertex`: positions, and by the names in use normals, texture coordinates and
//! colours.

use std::path::Path;

use super::header::{Element, Kind, Scalar};
use super::values::{Problem, Values, possible_rows, skip};
use crate::formats::LoadError;
use crate::geom::Mesh;
use crate::math::{Vec2, Vec3, Vec4};
use crate::texture::srgb_to_linear;

/// What a property is for: an index into a row's numbers, three each for position and normal, two
/// for texture coordinates, four for the colour.
const NAMES: [&[&str]; 12] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx", "normal_x"],
    &["ny", "normal_y"],
    &["nz", "normal_z"],
    &["u", "s", "texture_u", "texture_s"],
    &["v", "t", "texture_v", "texture_t"],
    &["red", "r", "diffuse_red"],
    &["green", "g", "diffuse_green"],
    &["blue", "b", "diffuse_blue"],
    &["alpha", "a", "diffuse_alpha"],
];

const NORMAL: usize = 3;
const UV: usize = 6;
const COLOR: usize = 8;
const ALPHA: usize = 11;

/// Where the numbers of a row go.
struct Columns {
    /// Of each property its kind and its index into `NAMES`.
    slots: Vec<(Kind, Option<usize>)>,
    /// Of each index into `NAMES` the type, if the file has it.
    kinds: [Option<Scalar>; NAMES.len()],
}

impl Columns {
    fn new(element: &Element) -> Self {
        let mut kinds = [None; NAMES.len()];
        let slots = element.properties.iter().map(|property| {
            let name = property.name.as_str();
            let slot = match property.kind {
                // The first of several names for one thing counts.
                Kind::One(kind) => NAMES
                    .iter()
                    .position(|names| names.contains(&name))
                    .filter(|&slot| kinds[slot].replace(kind).is_none()),
                Kind::List(..) => None,
            };
            (property.kind, slot)
        });
        let slots = slots.collect();
        Self { slots, kinds }
    }

    /// Whether all of some numbers are there.
    fn has(&self, slots: std::ops::Range<usize>) -> bool {
        self.kinds[slots].iter().all(Option::is_some)
    }

    /// Reads a row.
    #[inline]
    fn read(&self, values: &mut impl Values) -> Result<[f64; NAMES.len()], Problem> {
        let mut row = [0.0; NAMES.len()];
        for &(kind, slot) in &self.slots {
            match (kind, slot) {
                (Kind::One(kind), Some(slot)) => row[slot] = values.number(kind)?,
                _ => skip(values, kind)?,
            }
        }
        Ok(row)
    }
}

/// Reads all vertices into a mesh without triangles. Normals are as in the file. Names of
/// properties that nothing is done with go to `left_out`.
///
/// # Errors
/// Rows that are cut off or no numbers, positions that are missing or not finite.
pub(super) fn read(
    element: &Element,
    values: &mut impl Values,
    file: &Path,
    left_out: &mut Vec<String>,
) -> Result<Mesh, LoadError> {
    let columns = Columns::new(element);
    if !columns.has(0..3) {
        return Err(LoadError::invalid(file, "element vertex", "has no properties x, y and z"));
    }
    if element.count > u64::from(u32::MAX) {
        let message = format!("{} vertices are too many; {} at most", element.count, u32::MAX);
        return Err(LoadError::invalid(file, "element vertex", message));
    }
    for (property, (_, slot)) in element.properties.iter().zip(&columns.slots) {
        if slot.is_none() {
            left_out.push(property.name.clone());
        }
    }
    let rows = possible_rows(values, element, 0);
    let has = [NORMAL..UV, UV..COLOR, COLOR..ALPHA].map(|slots| columns.has(slots));
    let [has_normals, has_uvs, has_colors] = has;
    let room = |has: bool| if has { rows } else { 0 };
    let mut mesh = Mesh {
        positions: Vec::with_capacity(rows),
        normals: Vec::with_capacity(room(has_normals)),
        uvs: [Vec::with_capacity(room(has_uvs)), Vec::new()],
        colors: Vec::with_capacity(room(has_colors)),
        ..Mesh::default()
    };
    let decoders = columns.kinds.map(|kind| kind.map(Decoder::new));
    for number in 0..element.count {
        let row = columns
            .read(values)
            .map_err(|problem| values.error(file, "vertex", number, &problem))?;
        values.end_row();
        let vector = |first: usize| Vec3::from_array([0, 1, 2].map(|k| row[first + k] as f32));
        let position = vector(0);
        if !position.is_finite() {
            let problem = "its position is infinite or not a number";
            return Err(values.error(file, "vertex", number, problem));
        }
        mesh.positions.push(position);
        if has_normals {
            mesh.normals.push(vector(NORMAL));
        }
        if has_uvs {
            mesh.uvs[0].push(upright(row[UV], row[UV + 1]));
        }
        if has_colors {
            let color = |k: usize| decoders[k].as_ref().map_or(1.0, |d| d.color(row[k]));
            let alpha = decoders[ALPHA].as_ref().map_or(1.0, |d| d.share(row[ALPHA]));
            mesh.colors.push(Vec4::new(color(COLOR), color(COLOR + 1), color(COLOR + 2), alpha));
        }
    }
    Ok(mesh)
}

/// Texture coordinates of the file, whose v counts upwards.
pub(super) fn upright(u: f64, v: f64) -> Vec2 {
    Vec2::new(u as f32, (1.0 - v) as f32)
}

/// Colours of whole numbers are as bright as a screen shows them (sRGB), those with fractions are
/// proportional to light.
struct Decoder {
    most: f64,
    table: Vec<f32>,
}

impl Decoder {
    fn new(kind: Scalar) -> Self {
        let most = kind.range().map_or(1.0, |(_, high)| high);
        let decoded = |i: u8| srgb_to_linear(f32::from(i) / 255.0);
        let table = if kind == Scalar::U8 { (0..=u8::MAX).map(decoded).collect() } else { vec![] };
        Self { most, table }
    }

    /// 0 to 1; what is not a number is 0.
    fn share(&self, stored: f64) -> f32 {
        let share = stored / self.most;
        if share > 0.0 { share.min(1.0) as f32 } else { 0.0 }
    }

    fn color(&self, stored: f64) -> f32 {
        match self.table.get(stored as usize) {
            Some(&linear) => linear,
            None if self.most > 1.0 => srgb_to_linear(self.share(stored)),
            None => self.share(stored),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_srgb_and_fractions_are_linear() {
        let color = |kind, stored| Decoder::new(kind).color(stored);
        assert_eq!(color(Scalar::U8, 255.0), 1.0);
        assert_eq!(color(Scalar::U8, 188.0), srgb_to_linear(188.0 / 255.0));
        assert_eq!(color(Scalar::U16, 188.0 * 257.0), srgb_to_linear(188.0 / 255.0));
        assert_eq!(color(Scalar::F32, 0.5), 0.5);
        assert_eq!([7.0, -1.0, f64::NAN].map(|x| color(Scalar::F32, x)), [1.0, 0.0, 0.0]);
        assert_eq!(Decoder::new(Scalar::U8).share(51.0), 0.2);
    }
}
