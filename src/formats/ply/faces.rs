//! The elements `face` and `tristrips`: polygons and strips of triangles.

use std::collections::HashMap;
use std::path::Path;

use super::header::{Element, Kind, Scalar};
use super::values::{Problem, Values, list_length, possible_rows, skip};
use super::vertices::upright;
use crate::formats::LoadError;
use crate::formats::triangulate::{Intricate, Triangulator};
use crate::geom::Mesh;
use crate::math::{Vec2, Vec3};

/// The faces of a file. Triangles, which are nearly all there is, take no more than they will in
/// the mesh.
#[derive(Default)]
pub(super) struct Faces {
    triangles: Vec<[u32; 3]>,
    /// Of each other face how many triangles come before it, and its number of corners.
    polygons: Vec<(usize, u32)>,
    /// The vertices of the polygons, one after the other.
    corners: Vec<u32>,
    /// Where corners have texture coordinates of their own (as MeshLab writes them), those, by the
    /// numbers of `corners`; there all faces are polygons.
    wedges: Vec<Option<Vec2>>,
    /// Faces of fewer than three corners.
    pub small: u64,
}

impl Faces {
    /// Reads an element of faces over `vertices` vertices. Names of properties that nothing is done
    /// with go to `left_out`.
    ///
    /// # Errors
    /// Rows that are cut off or no numbers, vertices that are not there.
    pub fn read(
        &mut self,
        element: &Element,
        vertices: u64,
        values: &mut impl Values,
        file: &Path,
        left_out: &mut Vec<String>,
    ) -> Result<(), LoadError> {
        let (indices, wedges) = roles(element, file, left_out)?;
        if wedges.is_none() {
            self.triangles.reserve_exact(possible_rows(values, element, 3));
        }
        let (mut face, mut uvs) = (Vec::new(), Vec::new());
        for number in 0..element.count {
            face.clear();
            uvs.clear();
            let mut row = || {
                for (index, property) in element.properties.iter().enumerate() {
                    match property.kind {
                        Kind::List(count, item) if indices == Some(index) => {
                            corners(values, count, item, vertices, &mut face)?;
                        }
                        Kind::List(count, item) if wedges == Some(index) => {
                            coordinates(values, count, item, &mut uvs)?;
                        }
                        kind => skip(values, kind)?,
                    }
                }
                if wedges.is_some() && !uvs.is_empty() && uvs.len() != face.len() {
                    return Err(format!(
                        "has {} texture coordinates for {} corners",
                        uvs.len(),
                        face.len()
                    ));
                }
                Ok(())
            };
            row().map_err(|problem: Problem| values.error(file, "face", number, &problem))?;
            values.end_row();
            self.add(&face, &uvs, wedges.is_some());
        }
        Ok(())
    }

    fn add(&mut self, face: &[u32], uvs: &[Vec2], has_wedges: bool) {
        match *face {
            [] | [_] | [_, _] => self.small += 1,
            [a, b, c] if !has_wedges => self.triangles.push([a, b, c]),
            _ => {
                self.polygons.push((self.triangles.len(), face.len() as u32));
                if has_wedges {
                    self.wedges.resize(self.corners.len(), None);
                    self.wedges.extend(uvs.iter().copied().map(Some));
                }
                self.corners.extend_from_slice(face);
            }
        }
    }

    /// Reads an element of strips: each further vertex makes a triangle with the two before it,
    /// -1 begins anew (as the Stanford repository has them).
    ///
    /// # Errors
    /// As [`Faces::read`].
    pub fn read_strips(
        &mut self,
        element: &Element,
        vertices: u64,
        values: &mut impl Values,
        file: &Path,
        left_out: &mut Vec<String>,
    ) -> Result<(), LoadError> {
        let (indices, _) = roles(element, file, left_out)?;
        for number in 0..element.count {
            let mut row = || {
                for (index, property) in element.properties.iter().enumerate() {
                    match property.kind {
                        Kind::List(count, item) if indices == Some(index) => {
                            self.strip(values, count, item, vertices)?;
                        }
                        kind => skip(values, kind)?,
                    }
                }
                Ok(())
            };
            row().map_err(|problem: Problem| values.error(file, "tristrips", number, &problem))?;
            values.end_row();
        }
        Ok(())
    }

    fn strip(
        &mut self,
        values: &mut impl Values,
        count: Scalar,
        item: Scalar,
        vertices: u64,
    ) -> Result<(), Problem> {
        let (mut last, mut length) = ([0; 2], 0_u32);
        for _ in 0..list_length(values, count)? {
            let index = values.number(item)?;
            if index == -1.0 {
                length = 0;
                continue;
            }
            let next = vertex(index, vertices)?;
            let [a, b] = last;
            if length >= 2 && a != b && b != next && next != a {
                self.triangles.push(if length % 2 == 0 { [a, b, next] } else { [b, a, next] });
            }
            (last, length) = ([b, next], length + 1);
        }
        Ok(())
    }

    /// Gives the mesh its triangles, in the file's order, and parts its vertices where their
    /// corners have different texture coordinates.
    ///
    /// # Errors
    /// [`Intricate`].
    pub fn finish(mut self, mesh: &mut Mesh) -> Result<(), Intricate> {
        if !self.wedges.is_empty() {
            self.part_vertices(mesh);
        }
        if self.polygons.is_empty() {
            mesh.indices = self.triangles;
            return Ok(());
        }
        let mut triangulator = Triangulator::new(self.corners.len());
        let total = self.triangles.len() + self.corners.len() - 2 * self.polygons.len();
        let mut all = Vec::with_capacity(total);
        let (mut points, mut pieces): (Vec<Vec3>, Vec<_>) = (Vec::new(), Vec::new());
        let (mut done, mut rest) = (0, &self.corners[..]);
        for &(before, count) in &self.polygons {
            all.extend_from_slice(&self.triangles[done..before]);
            done = before;
            let (corners, others) = rest.split_at(count as usize);
            rest = others;
            points.clear();
            points.extend(corners.iter().map(|&corner| mesh.positions[corner as usize]));
            pieces.clear();
            triangulator.cut(&points, &mut pieces)?;
            all.extend(pieces.iter().map(|piece| piece.map(|corner| corners[corner as usize])));
        }
        all.extend_from_slice(&self.triangles[done..]);
        mesh.indices = all;
        Ok(())
    }

    /// Whether there are corners without texture coordinates beside others that have some.
    pub fn lack_coordinates(&self, mesh: &Mesh) -> bool {
        let each_has = self.triangles.is_empty()
            && self.wedges.len() == self.corners.len()
            && self.wedges.iter().all(Option::is_some);
        self.wedges.iter().any(Option::is_some) && !each_has && mesh.uvs[0].is_empty()
    }

    /// Makes a vertex of each pair of vertex and texture coordinates that occurs; corners that have
    /// none of their own, as those of strips, have those of their vertices.
    fn part_vertices(&mut self, mesh: &mut Mesh) {
        self.wedges.resize(self.corners.len(), None);
        let of_vertices = std::mem::take(&mut mesh.uvs[0]);
        let mut known = HashMap::new();
        let mut sources: Vec<u32> = Vec::new();
        let mut uvs = Vec::new();
        let mut part = |corner: &mut u32, uv: Option<Vec2>| {
            let uv = uv.or_else(|| of_vertices.get(*corner as usize).copied()).unwrap_or_default();
            let key = (*corner, uv.x.to_bits(), uv.y.to_bits());
            *corner = *known.entry(key).or_insert_with(|| {
                sources.push(*corner);
                uvs.push(uv);
                (sources.len() - 1) as u32
            });
        };
        self.corners.iter_mut().zip(&self.wedges).for_each(|(corner, &uv)| part(corner, uv));
        self.triangles.iter_mut().flatten().for_each(|corner| part(corner, None));
        mesh.positions = duplicate_shared(&mesh.positions, &sources);
        mesh.normals = duplicate_shared(&mesh.normals, &sources);
        mesh.colors = duplicate_shared(&mesh.colors, &sources);
        mesh.uvs[0] = uvs;
    }
}

fn duplicate_shared<T: Copy>(all: &[T], sources: &[u32]) -> Vec<T> {
    if all.is_empty() {
        return Vec::new();
    }
    sources.iter().map(|&source| all[source as usize]).collect()
}

/// Which properties are the lists of vertices and of texture coordinates.
///
/// # Errors
/// Rows without a list of vertices: which, if they had no property at all, would also take no room
/// in the file, however many it declares.
fn roles(
    element: &Element,
    file: &Path,
    left_out: &mut Vec<String>,
) -> Result<(Option<usize>, Option<usize>), LoadError> {
    let mut roles = (None, None);
    for (index, property) in element.properties.iter().enumerate() {
        match (property.name.as_str(), property.kind) {
            ("vertex_indices" | "vertex_index", Kind::List(..)) if roles.0.is_none() => {
                roles.0 = Some(index);
            }
            ("texcoord", Kind::List(..)) => roles.1 = Some(index),
            _ => left_out.push(property.name.clone()),
        }
    }
    if roles.0.is_none() && element.count > 0 {
        let message = "has no list called vertex_indices or vertex_index";
        return Err(LoadError::invalid(file, format!("element {}", element.name), message));
    }
    Ok(roles)
}

#[inline]
fn corners(
    values: &mut impl Values,
    count: Scalar,
    item: Scalar,
    vertices: u64,
    face: &mut Vec<u32>,
) -> Result<(), Problem> {
    for _ in 0..list_length(values, count)? {
        face.push(vertex(values.number(item)?, vertices)?);
    }
    Ok(())
}

#[inline]
fn vertex(index: f64, vertices: u64) -> Result<u32, Problem> {
    if index >= 0.0 && index < vertices as f64 && index.fract() == 0.0 {
        Ok(index as u32)
    } else {
        Err(format!("refers to vertex {index} of {vertices}"))
    }
}

fn coordinates(
    values: &mut impl Values,
    count: Scalar,
    item: Scalar,
    uvs: &mut Vec<Vec2>,
) -> Result<(), Problem> {
    let length = list_length(values, count)?;
    if !length.is_multiple_of(2) {
        return Err(format!("{length} numbers are no texture coordinates, which are pairs"));
    }
    for _ in 0..length / 2 {
        let u = values.number(item)?;
        uvs.push(upright(u, values.number(item)?));
    }
    Ok(())
}
