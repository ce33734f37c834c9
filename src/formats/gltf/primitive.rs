//! From a primitive's accessors to a mesh (glTF 2.0, 3.7.2).

use super::json::Fault;
use super::mesh::{Geometry, Mode, Primitive};
use super::notices::Notices;
use super::read::Storage;
use crate::formats::repair;
use crate::geom::{self, Mesh};
use crate::math::{Vec2, Vec3, Vec4};
use crate::scene::TextureRef;

/// Builds the mesh of a primitive.
///
/// # Errors
/// Positions that are infinite or not numbers, attributes of different lengths, indices beyond the
/// vertices.
pub fn build(
    primitive: &Primitive,
    name: &str,
    storage: &Storage,
    notices: &mut Notices,
) -> Result<Mesh, Fault> {
    let Primitive { place, geometry, .. } = primitive;
    let vertices = storage.accessor(geometry.positions).count;
    let reader = Reader { place, storage, vertices };

    let mut positions = reader.attribute(Some(geometry.positions), "POSITION", Vec3::from_array)?;
    let mut normals = reader.attribute(geometry.normals, "NORMAL", Vec3::from_array)?;
    let mut tangents = reader.attribute(geometry.tangents, "TANGENT", Vec4::from_array)?;
    let mut sets = geometry.uvs.iter().zip(&primitive.kept_sets).map(|(&accessor, set)| {
        reader.attribute(accessor, &format!("TEXCOORD_{set}"), Vec2::from_array)
    });
    let uvs = [sets.next().transpose()?, sets.next().transpose()?].map(Option::unwrap_or_default);
    let more_uvs = sets.collect::<Result<Vec<_>, _>>()?;
    let colors = reader.colors(geometry.colors)?;
    reader.morph(geometry, &mut positions, &mut normals, &mut tangents)?;
    if let Some(at) = positions.iter().position(|p| !p.is_finite()) {
        let accessor = &storage.accessor(geometry.positions).place;
        let message = format!("position {at} is infinite or not a number");
        return Err(Fault::new(accessor.clone(), message));
    }
    let indices = reader.triangles(geometry, notices)?;

    let name = name.to_owned();
    let mut mesh = Mesh { name, positions, normals, tangents, uvs, more_uvs, colors, indices };
    repair(&mut mesh, place, &primitive.kept_sets, notices);
    Ok(mesh)
}

/// Gives a mesh that has normals and texture coordinates the tangents that a normal map is meant
/// for which is looked up as `map` says.
///
/// # Errors
/// If that takes more memory than the file can justify.
pub fn add_tangents(
    mesh: &mut Mesh,
    map: &TextureRef,
    place: &str,
    storage: &Storage,
) -> Result<(), Fault> {
    // For each vertex its tangent, for each corner at most another vertex.
    let bytes = mesh.positions.len() as u64 * 16 + mesh.indices.len() as u64 * 3 * 48;
    storage.reserve(place, bytes)?;
    let uvs = mesh.uv_set(map.uv_set as usize);
    let uvs: Vec<Vec2> = uvs.iter().map(|&uv| map.transform(uv)).collect();
    geom::add_tangents(mesh, &uvs);
    Ok(())
}

struct Reader<'a> {
    place: &'a str,
    storage: &'a Storage<'a>,
    vertices: u64,
}

impl Reader<'_> {
    /// An attribute of all vertices; absent: empty.
    fn attribute<const N: usize, T>(
        &self,
        accessor: Option<usize>,
        name: &str,
        convert: fn([f32; N]) -> T,
    ) -> Result<Vec<T>, Fault> {
        let Some(accessor) = accessor else { return Ok(Vec::new()) };
        let count = self.storage.accessor(accessor).count;
        if count != self.vertices {
            let place = format!("{}/attributes/{name}", self.place);
            let message = format!("has {count} elements for {} positions", self.vertices);
            return Err(Fault::new(place, message));
        }
        let vectors = self.storage.vectors::<N>(accessor)?;
        Ok(vectors.into_iter().map(convert).collect())
    }

    /// Linear colours of three or four numbers; alpha is one where there is none.
    fn colors(&self, accessor: Option<usize>) -> Result<Vec<Vec4>, Fault> {
        let has_alpha = accessor.is_some_and(|at| self.storage.accessor(at).is_vector(4));
        if has_alpha {
            self.attribute(accessor, "COLOR_0", Vec4::from_array)
        } else {
            self.attribute(accessor, "COLOR_0", |[r, g, b]| Vec4::new(r, g, b, 1.0))
        }
    }

    /// Adds the displacements of the morph targets in their resting pose.
    fn morph(
        &self,
        geometry: &Geometry,
        positions: &mut [Vec3],
        normals: &mut [Vec3],
        tangents: &mut [Vec4],
    ) -> Result<(), Fault> {
        for &(weight, [position, normal, tangent]) in &geometry.targets {
            let weight = f32::from_bits(weight);
            let moves = |accessor, name| {
                let all = self.attribute(accessor, name, Vec3::from_array)?;
                Ok::<_, Fault>(all.into_iter().map(move |displacement| displacement * weight))
            };
            for (position, by) in positions.iter_mut().zip(moves(position, "POSITION")?) {
                *position += by;
            }
            for (normal, by) in normals.iter_mut().zip(moves(normal, "NORMAL")?) {
                *normal += by;
            }
            for (tangent, by) in tangents.iter_mut().zip(moves(tangent, "TANGENT")?) {
                *tangent += by.extend(0.0);
            }
        }
        Ok(())
    }

    fn triangles(
        &self,
        geometry: &Geometry,
        notices: &mut Notices,
    ) -> Result<Vec<[u32; 3]>, Fault> {
        let Some(accessor) = geometry.indices else {
            let count = u32::try_from(self.vertices)
                .map_err(|_| Fault::new(self.place, "has 2^32 vertices or more"))?;
            self.reserve_triangles(geometry.mode, self.vertices)?;
            return Ok(self.assemble(geometry.mode, count as usize, |i| i as u32, notices));
        };
        let indices = self.storage.indices(accessor)?;
        if let Some(at) = indices.iter().position(|&index| u64::from(index) >= self.vertices) {
            let accessor = &self.storage.accessor(accessor).place;
            let message =
                format!("index {at} refers to vertex {} of {}", indices[at], self.vertices);
            return Err(Fault::new(accessor.clone(), message));
        }
        self.reserve_triangles(geometry.mode, indices.len() as u64)?;
        Ok(self.assemble(geometry.mode, indices.len(), |i| indices[i], notices))
    }

    fn reserve_triangles(&self, mode: Mode, corners: u64) -> Result<(), Fault> {
        let triangles = if mode == Mode::Triangles { corners / 3 } else { corners };
        self.storage.reserve(self.place, triangles.saturating_mul(12))
    }

    /// Triangles of `count` corners, each wound as the first (3.7.2.1).
    fn assemble(
        &self,
        mode: Mode,
        count: usize,
        vertex: impl Fn(usize) -> u32,
        notices: &mut Notices,
    ) -> Vec<[u32; 3]> {
        let corners = |a, b, c| [vertex(a), vertex(b), vertex(c)];
        let complete = if mode == Mode::Triangles { count.is_multiple_of(3) } else { count > 2 };
        if !complete {
            notices.add(self.place, "its last triangle is not complete and is left out");
        }
        match mode {
            Mode::Triangles => {
                (0..count / 3).map(|i| corners(3 * i, 3 * i + 1, 3 * i + 2)).collect()
            }
            Mode::Strip => (0..count.saturating_sub(2))
                .map(|i| corners(i, i + 1 + i % 2, i + 2 - i % 2))
                .collect(),
            Mode::Fan => (0..count.saturating_sub(2)).map(|i| corners(i + 1, i + 2, 0)).collect(),
        }
    }
}

/// Makes normals and tangents unit vectors, replaces those that cannot be, and coordinates of
/// textures and colours that are not numbers.
fn repair(mesh: &mut Mesh, place: &str, kept_sets: &[u32], notices: &mut Notices) {
    if repair::normals(mesh) {
        notices.add(
            format!("{place}/attributes/NORMAL"),
            "some normals have no direction; those of the faces take their place",
        );
    }

    let mut whole = true;
    for tangent in &mut mesh.tangents {
        let sign = if tangent.w < 0.0 { -1.0 } else { 1.0 };
        match repair::unit(tangent.truncate()) {
            Some(unit) => *tangent = unit.extend(sign),
            None => whole = false,
        }
    }
    if !whole {
        let message = "some tangents have no direction; all are made from texture coordinates";
        notices.add(format!("{place}/attributes/TANGENT"), message);
        mesh.tangents = Vec::new();
    }

    for (uvs, set) in mesh.uvs.iter_mut().chain(&mut mesh.more_uvs).zip(kept_sets) {
        if repair::uvs(uvs) {
            let place = format!("{place}/attributes/TEXCOORD_{set}");
            notices.add(place, "some texture coordinates are no numbers; 0 takes their place");
        }
    }
    if repair::colors(&mut mesh.colors) {
        let place = format!("{place}/attributes/COLOR_0");
        notices.add(place, "some colours are not within 0 to 1; the nearer of them is used");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assemble(mode: Mode, count: usize) -> (Vec<[u32; 3]>, usize) {
        let storage = Storage::new(Vec::new(), Vec::new(), Vec::new());
        let reader = Reader { place: "/p", storage: &storage, vertices: 100 };
        let mut notices = Notices::default();
        let triangles = reader.assemble(mode, count, |i| i as u32, &mut notices);
        (triangles, notices.finish(std::path::Path::new("a")).len())
    }

    #[test]
    fn strips_and_fans_wind_like_their_first_triangle() {
        assert_eq!(assemble(Mode::Strip, 5), (vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]], 0));
        assert_eq!(assemble(Mode::Fan, 5), (vec![[1, 2, 0], [2, 3, 0], [3, 4, 0]], 0));
        assert_eq!(assemble(Mode::Triangles, 6), (vec![[0, 1, 2], [3, 4, 5]], 0));
    }

    #[test]
    fn incomplete_triangles_are_left_out_and_told() {
        assert_eq!(assemble(Mode::Triangles, 5), (vec![[0, 1, 2]], 1));
        assert_eq!(assemble(Mode::Strip, 2), (Vec::new(), 1));
        assert_eq!(assemble(Mode::Fan, 0), (Vec::new(), 1));
    }

    #[test]
    fn a_tangent_without_a_direction_takes_all_with_it() {
        let mut mesh = Mesh {
            tangents: vec![Vec4::new(2.0, 0.0, 0.0, -3.0), Vec4::ZERO],
            uvs: [vec![Vec2::ONE; 2], vec![Vec2::NAN, Vec2::ONE]],
            more_uvs: vec![vec![Vec2::ONE, Vec2::NAN]],
            ..Mesh::default()
        };
        let mut notices = Notices::default();
        repair(&mut mesh, "/p", &[0, 4, 7], &mut notices);
        assert!(mesh.tangents.is_empty());
        assert_eq!(mesh.uvs[1], [Vec2::ZERO, Vec2::ONE]);
        assert_eq!(mesh.more_uvs[0], [Vec2::ONE, Vec2::ZERO]);
        let said = notices.finish(std::path::Path::new("a"));
        assert_eq!(said[1].place, "a: /p/attributes/TEXCOORD_4");
        assert!(said[1].message.ends_with("(and at one other place)"), "{}", said[1].message);
    }
}
