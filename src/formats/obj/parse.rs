//! The statements of an OBJ file: vertices, polygons, and what they belong to.

use std::collections::HashMap;
use std::path::Path;

use super::geometry::{Corner, Geometry, NONE, Part};
use super::lines::{self, Statement};
use super::remarks::Remarks;
use super::smoothing::{self, Smoothed};
use crate::files::Meter;
use crate::formats::LoadError;
use crate::math::{Vec2, Vec3};

/// Reads an OBJ file.
///
/// # Errors
/// [`LoadError::Line`] at the first malformed statement.
pub(super) fn parse(
    bytes: &[u8],
    file: &Path,
    remarks: &mut Remarks,
    meter: &Meter,
) -> Result<Geometry, LoadError> {
    let mut reader = Reader::default();
    let joins = true;
    lines::for_each(bytes, file, (joins, meter), |s| reader.statement(&s, remarks))?;
    let Geometry { positions, uvs, normals, .. } = &reader.geometry;
    // The earliest of the faces that refer to what the file never defined.
    let ends = [
        reader.ahead[0].beyond(positions.len(), "vertex"),
        reader.ahead[1].beyond(uvs.len(), "texture coordinate"),
        reader.ahead[2].beyond(normals.len(), "normal"),
    ];
    if let Some((line, message)) = ends.into_iter().flatten().min_by_key(|(line, _)| *line) {
        return Err(LoadError::line(file, line, message));
    }
    smoothing::add_normals(&mut reader.geometry, &reader.smoothed);
    Ok(reader.geometry)
}

#[derive(Default)]
struct Reader {
    geometry: Geometry,
    object: String,
    group: String,
    material: Option<usize>,
    /// In `geometry.parts`; none after one of the three above has changed.
    part: Option<usize>,
    parts: HashMap<(String, String, Option<usize>), usize>,
    material_ids: HashMap<String, usize>,
    /// The smoothing group; 0: none.
    smooth: u32,
    /// Polygons that are to get normals.
    smoothed: Vec<Smoothed>,
    /// Of positions, texture coordinates and normals.
    ahead: [Ahead; 3],
}

/// References to what is not defined yet: allowed, if it is defined later in the file. Kept are
/// the ever larger ones, among which is the first that turns out to be wrong.
#[derive(Default)]
struct Ahead(Vec<(u32, usize)>);

impl Ahead {
    fn add(&mut self, index: u32, line: usize) {
        if self.0.last().is_none_or(|&(largest, _)| index > largest) {
            self.0.push((index, line));
        }
    }

    fn beyond(&self, count: usize, what: &str) -> Option<(usize, String)> {
        let &(index, line) = self.0.iter().find(|(index, _)| *index as usize >= count)?;
        let number = u64::from(index) + 1;
        Some((line, format!("face refers to {what} {number} of {count}")))
    }
}

impl Reader {
    fn statement(&mut self, s: &Statement, remarks: &mut Remarks) -> Result<(), String> {
        match s.keyword {
            "v" => self.vertex(s, remarks),
            "vt" => {
                let ([u, v, ..], _) = lines::numbers(s.rest, 1)?;
                push_limited(&mut self.geometry.uvs, Vec2::new(u, v))
            }
            "vn" => {
                let ([x, y, z, ..], _) = lines::numbers(s.rest, 3)?;
                // In f64, where the squares of all f32 neither vanish nor overflow.
                let normal = Vec3::new(x, y, z).as_dvec3().normalize_or_zero().as_vec3();
                if normal == Vec3::ZERO {
                    remarks.add(s.line, "a normal is zero: there the shading is flat");
                }
                push_limited(&mut self.geometry.normals, normal)
            }
            "f" | "fo" => self.face(s, remarks),
            "o" => {
                self.object = lines::name(s.rest);
                self.group.clear();
                self.part = None;
                Ok(())
            }
            "g" => {
                self.group = lines::name(s.rest);
                self.part = None;
                Ok(())
            }
            "usemtl" => {
                self.use_material(lines::name(s.rest), s.line);
                Ok(())
            }
            "mtllib" => {
                let names = String::from_utf8_lossy(s.rest).into_owned();
                self.geometry.libraries.push((s.line, names));
                Ok(())
            }
            "s" => {
                self.smooth = smoothing::group(s.rest);
                Ok(())
            }
            other => {
                remarks.add(s.line, describe_skipped(other));
                Ok(())
            }
        }
    }

    /// Three numbers; where there are six, the last three are the colour that scanners add.
    fn vertex(&mut self, s: &Statement, remarks: &mut Remarks) -> Result<(), String> {
        let ([x, y, z, r, g, b, ..], count) = lines::numbers(s.rest, 3)?;
        let Geometry { positions, colors, .. } = &mut self.geometry;
        if count >= 6 {
            let color = Vec3::new(r, g, b);
            let shown = color.clamp(Vec3::ZERO, Vec3::ONE);
            if shown != color {
                let message = "colours of vertices are not within 0 to 1; the nearer is used";
                remarks.add(s.line, message);
            }
            colors.resize(positions.len(), Vec3::ONE);
            colors.push(shown);
        } else if !colors.is_empty() {
            colors.push(Vec3::ONE);
        }
        push_limited(positions, Vec3::new(x, y, z))
    }

    fn use_material(&mut self, name: String, line: usize) {
        let materials = &mut self.geometry.materials;
        let id = *self.material_ids.entry(name).or_insert_with_key(|name| {
            materials.push((name.clone(), line));
            materials.len() - 1
        });
        self.material = Some(id);
        self.part = None;
    }

    fn face(&mut self, s: &Statement, remarks: &mut Remarks) -> Result<(), String> {
        let part_number = self.part.unwrap_or_else(|| self.enter_part());
        let start = self.geometry.parts[part_number].corners.len();
        for word in lines::words(s.rest) {
            let corner = self.corner(word, s.line)?;
            self.geometry.parts[part_number].corners.push(corner);
        }
        let part = &mut self.geometry.parts[part_number];
        let count = part.corners.len() - start;
        if count < 3 {
            part.corners.truncate(start);
            remarks.add(s.line, "faces of fewer than three corners are skipped");
            return Ok(());
        }
        if self.smooth != 0 && part.corners[start..].iter().any(|corner| corner.normal == NONE) {
            let (group, part) = (self.smooth, part_number);
            self.smoothed.push(Smoothed { group, part, start, count });
        }
        part.polygons.push(count as u32);
        // Meshes number their vertices by u32.
        if part.corners.len() >= NONE as usize {
            return Err("a group has more than 2^32 corners of faces".to_owned());
        }
        Ok(())
    }

    fn enter_part(&mut self) -> usize {
        let key = (self.object.clone(), self.group.clone(), self.material);
        let parts = &mut self.geometry.parts;
        let part = *self.parts.entry(key).or_insert_with_key(|(object, group, material)| {
            let slash = if object.is_empty() || group.is_empty() { "" } else { "/" };
            let name = format!("{object}{slash}{group}");
            let (corners, polygons) = (Vec::new(), Vec::new());
            parts.push(Part { name, material: *material, corners, polygons });
            parts.len() - 1
        });
        self.part = Some(part);
        part
    }

    /// `position`, `position/uv`, `position//normal` or `position/uv/normal`.
    fn corner(&mut self, word: &[u8], line: usize) -> Result<Corner, String> {
        let mut fields = word.split(|&b| b == b'/');
        let Geometry { positions, uvs, normals, .. } = &self.geometry;
        let kinds = [
            (positions.len(), "vertex"),
            (uvs.len(), "texture coordinate"),
            (normals.len(), "normal"),
        ];
        let mut indices = [NONE; 3];
        for (k, (count, what)) in kinds.into_iter().enumerate() {
            let field = fields.next().unwrap_or_default();
            if field.is_empty() && k > 0 {
                continue;
            }
            let number = integer(field).ok_or_else(|| describe_malformed(word))?;
            let index = if number < 0 { count as i64 + number } else { number - 1 };
            if index < 0 || index >= i64::from(NONE) {
                let zero = if number == 0 { ": they count from 1" } else { "" };
                return Err(format!("face refers to {what} {number} of {count}{zero}"));
            }
            if index >= count as i64 {
                self.ahead[k].add(index as u32, line);
            }
            indices[k] = index as u32;
        }
        if fields.next().is_some() {
            return Err(describe_malformed(word));
        }
        let [position, uv, normal] = indices;
        Ok(Corner { position, uv, normal })
    }
}

fn describe_malformed(word: &[u8]) -> String {
    format!("{} is not a corner of a face (v, v/vt, v//vn or v/vt/vn)", lines::quote(word))
}

fn integer(field: &[u8]) -> Option<i64> {
    // Ten digits hold any index that can be valid.
    if field.len() > 20 {
        return None;
    }
    str::from_utf8(field).ok()?.parse().ok()
}

fn push_limited<T>(list: &mut Vec<T>, value: T) -> Result<(), String> {
    if list.len() >= NONE as usize {
        return Err("there are more than 2^32 - 1 vertices".to_owned());
    }
    list.push(value);
    Ok(())
}

/// What to say of a statement that does nothing here.
fn describe_skipped(keyword: &str) -> String {
    match keyword {
        "p" | "l" => "points and lines are skipped".to_owned(),
        "vp" | "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim"
        | "hole" | "scrv" | "sp" | "end" | "con" | "bsp" | "bzp" | "cdc" | "cdp" | "res" => {
            "free-form curves and surfaces are skipped".to_owned()
        }
        other => format!("{other} is not honoured"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

    fn parsed(text: &str) -> Result<(Geometry, Vec<String>), LoadError> {
        let file = Path::new("a.obj");
        let mut remarks = Remarks::new(file);
        let geometry = parse(text.as_bytes(), file, &mut remarks, &Meter::default())?;
        Ok((geometry, remarks.finish().into_iter().map(|notice| notice.message).collect()))
    }

    fn message(text: &str) -> String {
        parsed(text).expect_err("the file is broken").to_string()
    }

    fn positions(part: &Part) -> Vec<u32> {
        part.corners.iter().map(|corner| corner.position).collect()
    }

    #[test]
    fn indices_count_from_both_ends_and_may_point_ahead() {
        let (geometry, _) = parsed(&format!("f 1 2 3\n{TRIANGLE}f -3 -2 -1\n")).unwrap();
        assert_eq!(positions(&geometry.parts[0]), [0, 1, 2, 0, 1, 2]);
    }

    #[test]
    fn references_beyond_the_file_are_found() {
        assert_eq!(
            message(&format!("{TRIANGLE}f 1 2 4\nf 1 2 9\n")),
            "a.obj:4: face refers to vertex 4 of 3"
        );
        // The first line that is wrong, also where a later definition mends an earlier one.
        assert_eq!(
            message(&format!("f 1 2 3\n{TRIANGLE}f 1/1 2/1 3/1\n")),
            "a.obj:5: face refers to texture coordinate 1 of 0"
        );
        assert_eq!(message("f -4 -3 -2"), "a.obj:1: face refers to vertex -4 of 0");
        assert_eq!(
            message(&format!("{TRIANGLE}f 0 1 2")),
            "a.obj:4: face refers to vertex 0 of 3: they count from 1"
        );
        assert!(message(&format!("{TRIANGLE}f 1 2 99999999999")).contains("of 3"));
    }

    #[test]
    fn malformed_statements_are_quoted() {
        assert_eq!(message("v 1 2\n"), "a.obj:1: expected 3 numbers, found 2");
        assert_eq!(message("v 1 2 x"), "a.obj:1: 'x' is not a number");
        assert_eq!(message("v 1 2 inf"), "a.obj:1: 'inf' is not finite");
        let corner = "is not a corner of a face (v, v/vt, v//vn or v/vt/vn)";
        for word in ["a", "1/2/3/4", "/1", "1.5", "1/x"] {
            assert_eq!(
                message(&format!("{TRIANGLE}f {word}")),
                format!("a.obj:4: '{word}' {corner}")
            );
        }
    }

    #[test]
    fn one_part_for_each_object_group_and_material() {
        let (geometry, _) = parsed(&format!(
            "{TRIANGLE}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl a\nf 3 2 1\n\
             o thing\nf 1 2 3\ng left wing\nf 1 2 3\n"
        ))
        .unwrap();
        let parts: Vec<_> =
            geometry.parts.iter().map(|p| (&*p.name, p.material, p.polygons.len())).collect();
        let expected = [
            ("", Some(0), 2),
            ("", Some(1), 1),
            ("thing", Some(0), 1),
            ("thing/left wing", Some(0), 1),
        ];
        assert_eq!(parts, expected);
        assert_eq!(geometry.materials, [("a".to_owned(), 4), ("b".to_owned(), 6)]);
    }

    #[test]
    fn what_is_left_out_is_said_once() {
        let (geometry, remarks) = parsed(&format!(
            "{TRIANGLE}p 1\nl 1 2\ncstype bezier\nsurf 0 1 0 1 1\nf 1 2\nwhatever 3\ns 1\n\
             f 1 2 3\nv 0 0 0 2 0 0\nv 0 0 0 0.5\nvn 0 0 0\n"
        ))
        .unwrap();
        assert_eq!(geometry.positions.len(), 5);
        let white = Vec3::ONE;
        assert_eq!(geometry.colors, [white, white, white, Vec3::X, white]);
        assert_eq!(
            remarks,
            [
                "points and lines are skipped (and 1 more)",
                "free-form curves and surfaces are skipped (and 1 more)",
                "faces of fewer than three corners are skipped",
                "whatever is not honoured",
                "colours of vertices are not within 0 to 1; the nearer is used",
                "a normal is zero: there the shading is flat",
            ]
        );
    }
}
