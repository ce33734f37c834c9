//! Meshes of the polygons of an OBJ file.

use std::collections::HashMap;

use super::geometry::{Corner, Geometry, NONE, Part};
use crate::formats::triangulate::{Intricate, Triangulator, newell};
use crate::geom::Mesh;
use crate::math::{DVec3, Vec2, Vec3};
use crate::texture::srgb_to_linear;

/// The mesh of each part that has polygons, with the part's number.
///
/// # Errors
/// [`Intricate`].
pub(super) fn build(geometry: &Geometry) -> Result<Vec<(usize, Mesh)>, Intricate> {
    let corners = geometry.parts.iter().map(|part| part.corners.len()).sum();
    let mut triangulator = Triangulator::new(corners);
    let filled = geometry.parts.iter().enumerate().filter(|(_, part)| !part.polygons.is_empty());
    filled
        .map(|(number, part)| {
            Ok((number, Builder::new(geometry, part).build(part, &mut triangulator)?))
        })
        .collect()
}

/// A corner as a vertex: position, texture coordinate, and normal or, above 2^32, the polygon whose
/// own normal it takes.
type Key = (u32, u32, u64);

struct Builder<'a> {
    geometry: &'a Geometry,
    has_uvs: bool,
    has_normals: bool,
    vertices: HashMap<Key, u32>,
    mesh: Mesh,
}

impl<'a> Builder<'a> {
    fn new(geometry: &'a Geometry, part: &Part) -> Self {
        let has_uvs = part.corners.iter().any(|corner| corner.uv != NONE);
        let has_normals = part.corners.iter().any(|corner| normal(geometry, corner).is_some());
        let mesh = Mesh { name: part.name.clone(), ..Mesh::default() };
        Self { geometry, has_uvs, has_normals, vertices: HashMap::new(), mesh }
    }

    fn build(mut self, part: &Part, triangulator: &mut Triangulator) -> Result<Mesh, Intricate> {
        let mut rest = &part.corners[..];
        let (mut points, mut triangles, mut ids) = (Vec::new(), Vec::new(), Vec::new());
        for (polygon, &count) in part.polygons.iter().enumerate() {
            let (corners, others) = rest.split_at(count as usize);
            rest = others;
            points.clear();
            points.extend(corners.iter().map(|c| self.geometry.positions[c.position as usize]));
            triangles.clear();
            triangulator.cut(&points, &mut triangles)?;
            ids.clear();
            for corner in corners {
                let id = self.vertex(corner, polygon, &points);
                ids.push(id);
            }
            let indexed = triangles.iter().map(|triangle| triangle.map(|i| ids[i as usize]));
            self.mesh.indices.extend(indexed);
        }
        Ok(self.mesh)
    }

    fn vertex(&mut self, corner: &Corner, polygon: usize, points: &[Vec3]) -> u32 {
        let given = normal(self.geometry, corner);
        let normal_key = match given {
            Some(_) => u64::from(corner.normal),
            None if self.has_normals => (1 << 32) + polygon as u64,
            None => u64::from(NONE),
        };
        let Self { geometry, mesh, .. } = self;
        *self.vertices.entry((corner.position, corner.uv, normal_key)).or_insert_with(|| {
            mesh.positions.push(geometry.positions[corner.position as usize]);
            if let Some(color) = geometry.colors.get(corner.position as usize) {
                let linear = color.to_array().map(srgb_to_linear);
                mesh.colors.push(Vec3::from_array(linear).extend(1.0));
            }
            if self.has_uvs {
                let uv = geometry.uvs.get(corner.uv as usize).copied().unwrap_or_default();
                // The first row of an image is its upper one.
                mesh.uvs[0].push(Vec2::new(uv.x, 1.0 - uv.y));
            }
            if self.has_normals {
                let own = || newell(points).normalize_or(DVec3::Z).as_vec3();
                mesh.normals.push(given.unwrap_or_else(own));
            }
            (mesh.positions.len() - 1) as u32
        })
    }
}

/// The file's normal at a corner, if it gives one that is not zero.
fn normal(geometry: &Geometry, corner: &Corner) -> Option<Vec3> {
    geometry.normals.get(corner.normal as usize).copied().filter(|normal| *normal != Vec3::ZERO)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::parse::parse;
    use super::super::remarks::Remarks;
    use super::*;
    use crate::files::Meter;

    fn meshes(text: &str) -> Vec<Mesh> {
        let file = Path::new("a.obj");
        let geometry =
            parse(text.as_bytes(), file, &mut Remarks::new(file), &Meter::default()).unwrap();
        build(&geometry).unwrap().into_iter().map(|(_, mesh)| mesh).collect()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn corners_alike_are_one_vertex() {
        let mesh = &meshes(&format!("{SQUARE}f 1 2 3\nf 1 3 4\n"))[0];
        assert_eq!(mesh.positions.len(), 4);
        assert_eq!(mesh.indices, [[0, 1, 2], [0, 2, 3]]);
        assert!(mesh.normals.is_empty() && mesh.uvs[0].is_empty());
    }

    #[test]
    fn texture_coordinates_are_turned_over_and_part_vertices() {
        let text = format!("{SQUARE}vt 0 0\nvt 0.25 1\nf 1/1 2/1 3/2\nf 1/2 3/2 4\n");
        let mesh = &meshes(&text)[0];
        assert_eq!(mesh.positions.len(), 5);
        let upper = Vec2::new(0.25, 0.0);
        assert_eq!(mesh.uvs[0], [Vec2::Y, Vec2::Y, upper, upper, Vec2::Y]);
    }

    #[test]
    fn corners_without_a_normal_take_their_polygons() {
        let text = format!("{SQUARE}v 0 0 5\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1 3 4\nf 1 4 5\n");
        let mesh = &meshes(&text)[0];
        assert_eq!(mesh.positions.len(), 9);
        assert_eq!(mesh.normals[..3], [Vec3::X; 3]);
        assert_eq!(mesh.normals[3..6], [Vec3::Z; 3]);
        assert_eq!(mesh.normals[6..], [Vec3::X; 3]);
    }

    #[test]
    fn colours_of_vertices_become_linear() {
        let mesh = &meshes("v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 0 0 1 1\nf 1 2 3\n")[0];
        let expected =
            [Vec3::new(1.0, srgb_to_linear(0.5), 0.0), Vec3::ONE, Vec3::Z].map(|c| c.extend(1.0));
        assert_eq!(mesh.colors, expected);
        assert!(meshes(&format!("{SQUARE}f 1 2 3\n"))[0].colors.is_empty());
    }

    #[test]
    fn groups_without_faces_make_no_mesh() {
        assert_eq!(meshes(&format!("g empty\n{SQUARE}g full\nf 1 2 3\ng\n")).len(), 1);
        assert!(meshes("").is_empty());
    }
}
