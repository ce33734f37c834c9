//! Tangents for normal maps that come without: the space that they were baked in.
//!
//! The method is that of M. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, in the
//! form of his library mikktspace with its default threshold, as glTF 2.0 asks (3.7.2.1). Vertices
//! that agree in position, normal and texture coordinates are one. Around each, triangles that are
//! joined by edges and of which the texture is mirrored alike form a group; its tangent is the mean
//! of theirs in the plane of the normal, weighted by the angles at the vertex.
//!
//! What differs: groups are found by joining corners over edges and not by recursion, which a fan
//! of a million triangles would exhaust; and all of it takes O(n log n) on any input. A triangle
//! without area in the texture joins the side of its first neighbour that has some.

use std::collections::HashMap;

use super::Mesh;
use crate::math::{Vec2, Vec3, Vec4};

/// A corner, as three times its triangle's number plus its own.
type Corner = u32;

/// Gives a mesh with normals tangents for a normal map looked up at `uvs`, one for each vertex; `w`
/// is the sign of the bitangent where v of the texture points down, as in glTF. Vertices whose
/// triangles want different tangents are repeated at the end.
///
/// Does nothing where the numbers of corners and vertices together reach 2^32.
///
/// # Panics
/// If there are not as many normals and `uvs` as positions.
pub fn add_tangents(mesh: &mut Mesh, uvs: &[Vec2]) {
    assert!(mesh.normals.len() == mesh.positions.len() && uvs.len() == mesh.positions.len());
    let corners = mesh.indices.len() as u64 * 3;
    if corners + mesh.positions.len() as u64 >= u64::from(u32::MAX) {
        return;
    }
    let tangents = make_corner_tangents(mesh, uvs);
    let mut first: Vec<Option<Vec4>> = vec![None; mesh.positions.len()];
    let mut others: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    let (mut sources, mut repeated) = (Vec::new(), Vec::new());
    for (vertex, tangent) in mesh.indices.iter_mut().flatten().zip(tangents) {
        let known = *first[*vertex as usize].get_or_insert(tangent);
        if known != tangent {
            let key = (*vertex, tangent.to_array().map(f32::to_bits));
            *vertex = *others.entry(key).or_insert_with(|| {
                sources.push(*vertex);
                repeated.push(tangent);
                (first.len() + sources.len() - 1) as u32
            });
        }
    }
    mesh.tangents = Vec::new();
    mesh.repeat_vertices(&sources);
    mesh.tangents = first.into_iter().map(|tangent| tangent.unwrap_or(FALLBACK)).collect();
    mesh.tangents.append(&mut repeated);
}

/// Where nothing tells a direction.
const FALLBACK: Vec4 = Vec4::new(1.0, 0.0, 0.0, 1.0);

/// A triangle in the texture's eyes.
struct Flat {
    /// Along rising u, unit; zero where the triangle has no area in the texture.
    along_u: Vec3,
    /// Whether the texture is not mirrored, v pointing up.
    preserving: bool,
    /// Whether it says nothing itself, but joins others.
    joins_any: bool,
    /// Whether two corners are at one place: it neither has nor joins.
    degenerate: bool,
}

/// Tangents of all corners, in order.
fn make_corner_tangents(mesh: &Mesh, uvs: &[Vec2]) -> Vec<Vec4> {
    let welded = weld(mesh, uvs);
    let mut flats: Vec<Flat> = mesh.indices.iter().map(|&t| flatten(mesh, uvs, t)).collect();
    let edges = join_edges(mesh, &welded, &flats);
    orient_joining(&mut flats, &edges);
    let mut groups = Groups::new(flats.len() * 3);
    for &[a, b] in &edges {
        if flats[triangle(a)].preserving == flats[triangle(b)].preserving {
            // One edge from either side: the beginning of one is the end of the other.
            groups.join(a, after(b));
            groups.join(after(a), b);
        }
    }
    let mut sums = vec![Vec3::ZERO; flats.len() * 3];
    for (number, (&indices, flat)) in mesh.indices.iter().zip(&flats).enumerate() {
        if flat.degenerate || flat.joins_any {
            continue;
        }
        for corner in 0..3 {
            let group = groups.of((3 * number + corner) as u32);
            sums[group as usize] += weigh_corner(mesh, indices, corner, flat.along_u);
        }
    }
    let mut tangents = Vec::with_capacity(sums.len());
    let mut by_vertex: HashMap<u32, Vec4> = HashMap::new();
    for corner in 0..sums.len() as u32 {
        let flat = &flats[triangle(corner)];
        // The library's sign belongs to v that points up.
        let sign = if flat.preserving { -1.0 } else { 1.0 };
        let sum = sums[groups.of(corner) as usize];
        let tangent = sum.try_normalize().map(|tangent| tangent.extend(sign));
        if let (Some(tangent), false) = (tangent, flat.degenerate) {
            by_vertex.entry(welded[vertex(mesh, corner)]).or_insert(tangent);
        }
        tangents.push(tangent);
    }
    // What has no tangent takes that of the vertex in another triangle.
    let borrowed = |corner: usize| by_vertex.get(&welded[vertex(mesh, corner as u32)]).copied();
    let all = tangents.into_iter().enumerate();
    all.map(|(corner, found)| found.or_else(|| borrowed(corner)).unwrap_or(FALLBACK)).collect()
}

fn triangle(corner: Corner) -> usize {
    corner as usize / 3
}

/// The next corner of the same triangle.
fn after(corner: Corner) -> Corner {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

fn vertex(mesh: &Mesh, corner: Corner) -> usize {
    mesh.indices[triangle(corner)][corner as usize % 3] as usize
}

/// Of each vertex the first one that is equal.
fn weld(mesh: &Mesh, uvs: &[Vec2]) -> Vec<u32> {
    let mut known = HashMap::with_capacity(uvs.len());
    let vertices = mesh.positions.iter().zip(&mesh.normals).zip(uvs).enumerate();
    vertices
        .map(|(number, ((p, n), uv))| {
            // Minus zero is zero.
            let key = [p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y].map(|x| (x + 0.0).to_bits());
            *known.entry(key).or_insert(number as u32)
        })
        .collect()
}

fn flatten(mesh: &Mesh, uvs: &[Vec2], indices: [u32; 3]) -> Flat {
    let [a, b, c] = indices.map(|vertex| mesh.positions[vertex as usize]);
    let [s, t, u] = indices.map(|vertex| uvs[vertex as usize]);
    let (to_b, to_c) = (t - s, u - s);
    let double_area = to_b.x * to_c.y - to_b.y * to_c.x;
    let preserving = double_area > 0.0;
    let along_u = ((b - a) * to_c.y - (c - a) * to_b.y) * if preserving { 1.0 } else { -1.0 };
    let along_v = (c - a) * to_b.x - (b - a) * to_c.x;
    let is_something = |x: f32| x.abs() > f32::MIN_POSITIVE;
    let says = is_something(double_area)
        && is_something(along_u.length() / double_area.abs())
        && is_something(along_v.length() / double_area.abs());
    Flat {
        along_u: along_u.normalize_or_zero(),
        preserving,
        joins_any: !says,
        degenerate: a == b || b == c || c == a,
    }
}

/// Pairs of corners at which one edge begins, from its two sides. Where more than two triangles
/// share an edge they are paired in their order.
fn join_edges(mesh: &Mesh, welded: &[u32], flats: &[Flat]) -> Vec<[Corner; 2]> {
    let mut edges = Vec::with_capacity(flats.len() * 3);
    for corner in 0..flats.len() as u32 * 3 {
        if flats[triangle(corner)].degenerate {
            continue;
        }
        let from = welded[vertex(mesh, corner)];
        let to = welded[vertex(mesh, after(corner))];
        edges.push((from.min(to), from.max(to), from > to, corner));
    }
    edges.sort_unstable();
    let mut pairs = Vec::with_capacity(edges.len() / 2);
    for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (there, back) = edge.split_at(edge.partition_point(|half| !half.2));
        pairs.extend(there.iter().zip(back).map(|(there, back)| [there.3, back.3]));
    }
    // By the number of the first triangle, so that what follows depends on no hash or sort.
    pairs.sort_unstable();
    pairs
}

/// Has triangles that say nothing side with their first neighbour that does.
fn orient_joining(flats: &mut [Flat], edges: &[[Corner; 2]]) {
    let mut done: Vec<bool> = flats.iter().map(|flat| !flat.joins_any).collect();
    for &[a, b] in edges {
        let (a, b) = (triangle(a), triangle(b));
        for (from, to) in [(a, b), (b, a)] {
            if done[from] && !done[to] {
                flats[to].preserving = flats[from].preserving;
                done[to] = true;
            }
        }
    }
}

/// What a triangle adds to the tangent at one of its corners.
fn weigh_corner(mesh: &Mesh, indices: [u32; 3], corner: usize, along_u: Vec3) -> Vec3 {
    let at = |k: usize| mesh.positions[indices[(corner + k) % 3] as usize];
    let normal = mesh.normals[indices[corner] as usize];
    let in_plane = |v: Vec3| (v - normal * normal.dot(v)).normalize_or_zero();
    let cos = in_plane(at(1) - at(0)).dot(in_plane(at(2) - at(0))).clamp(-1.0, 1.0);
    in_plane(along_u) * libm::acos(f64::from(cos)) as f32
}

/// Sets of corners (union by the smaller number, with path halving).
struct Groups(Vec<Corner>);

impl Groups {
    fn new(corners: usize) -> Self {
        Self((0..corners as u32).collect())
    }

    /// The corner that stands for its group.
    fn of(&mut self, mut corner: Corner) -> Corner {
        while self.0[corner as usize] != corner {
            let above = self.0[self.0[corner as usize] as usize];
            self.0[corner as usize] = above;
            corner = above;
        }
        corner
    }

    fn join(&mut self, a: Corner, b: Corner) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
    use proptest::prelude::*;

    use super::*;

    /// The library that others use, as the oracle.
    struct Oracle<'a>(&'a Mesh, Vec<Option<[f32; 4]>>);

    impl Oracle<'_> {
        fn vertex(&self, face: usize, corner: usize) -> usize {
            self.0.indices[face][corner] as usize
        }
    }

    impl Geometry for Oracle<'_> {
        fn num_faces(&self) -> usize {
            self.0.indices.len()
        }

        fn num_vertices_of_face(&self, _: usize) -> usize {
            3
        }

        fn position(&self, face: usize, corner: usize) -> [f32; 3] {
            self.0.positions[self.vertex(face, corner)].to_array()
        }

        fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
            self.0.normals[self.vertex(face, corner)].to_array()
        }

        fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
            self.0.uvs[0][self.vertex(face, corner)].to_array()
        }

        fn set_tangent(&mut self, found: Option<TangentSpace>, face: usize, corner: usize) {
            self.1[3 * face + corner] = found.map(|space| space.tangent_encoded());
        }
    }

    /// A bumpy sheet of `side` by `side` squares, its texture mirrored beyond `fold`.
    fn sheet(side: u32, fold: u32, heights: &[f32]) -> Mesh {
        let mut mesh = Mesh::default();
        for y in 0..=side {
            for x in 0..=side {
                let height = heights[(y * (side + 1) + x) as usize % heights.len()];
                mesh.positions.push(Vec3::new(x as f32, y as f32, height));
                let normal = Vec3::new(height - 0.5, 0.3 * height, 1.0).normalize();
                mesh.normals.push(normal);
                let u = if x > fold { 2 * fold as i32 - x as i32 } else { x as i32 };
                mesh.uvs[0].push(Vec2::new(u as f32 * 0.3, y as f32 * 0.2 + 0.1 * height));
            }
        }
        for y in 0..side {
            for x in 0..side {
                let a = y * (side + 1) + x;
                let (b, c, d) = (a + 1, a + side + 1, a + side + 2);
                mesh.indices.extend([[a, b, d], [a, d, c]]);
            }
        }
        mesh
    }

    fn with_tangents(mesh: &Mesh) -> Mesh {
        let (mut made, uvs) = (mesh.clone(), mesh.uvs[0].clone());
        add_tangents(&mut made, &uvs);
        made
    }

    #[test]
    fn a_flat_sheet_has_the_tangent_of_its_texture() {
        let made = with_tangents(&sheet(2, 9, &[0.5]));
        assert_eq!(made.positions.len(), 9);
        assert!(made.tangents.iter().all(|t| t.truncate().distance(Vec3::X) < 0.2 && t.w == -1.0));
    }

    #[test]
    fn vertices_of_a_fold_are_repeated() {
        let mesh = sheet(4, 2, &[0.5]);
        let made = with_tangents(&mesh);
        assert_eq!(made.positions.len(), mesh.positions.len() + 5);
        assert_eq!(made.uvs[0].len(), made.positions.len());
        let signs: Vec<f32> = made.indices.iter().map(|t| made.tangents[t[0] as usize].w).collect();
        assert_eq!(signs[..8], [-1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, 1.0]);
    }

    #[test]
    fn a_fan_of_any_size_is_no_burden() {
        let count = 200_000;
        let mut mesh = Mesh::default();
        for i in 0..=count {
            let angle = i as f32 * std::f32::consts::TAU / count as f32;
            let rim = Vec3::new(libm::cosf(angle), libm::sinf(angle), 0.0);
            mesh.positions.push(if i == 0 { Vec3::ZERO } else { rim });
            mesh.normals.push(Vec3::Z);
            mesh.uvs[0].push(mesh.positions[i as usize].truncate());
        }
        mesh.indices = (1..count).map(|i| [0, i, i + 1]).collect();
        let made = with_tangents(&mesh);
        assert_eq!(made.positions.len(), mesh.positions.len());
        assert!(made.tangents[0].truncate().distance(Vec3::X) < 1e-3);
    }

    proptest! {
        #[test]
        fn tangents_are_those_of_mikktspace(
            heights in prop::collection::vec(0.0_f32..1.0, 3..60),
            side in 1_u32..6,
            fold in 0_u32..6,
        ) {
            let mesh = sheet(side, fold, &heights);
            let made = with_tangents(&mesh);
            let mut oracle = Oracle(&mesh, vec![None; mesh.indices.len() * 3]);
            generate_tangents(&mut oracle).expect("cannot fail");
            for (corner, expected) in oracle.1.iter().enumerate() {
                let [x, y, z, w] = expected.expect("all triangles are whole");
                let found = made.tangents[vertex(&made, corner as u32)];
                prop_assert_eq!(-w, found.w);
                let apart = found.truncate().distance(Vec3::new(x, y, z));
                prop_assert!(apart < 1e-4, "corner {}: {}", corner, apart);
            }
        }

        #[test]
        fn any_triangles_get_finite_tangents(
            points in prop::collection::vec((0_i8..3, 0_i8..3, 0_i8..3, 0_i8..2, 0_i8..2), 1..12),
            indices in prop::collection::vec(prop::array::uniform3(0_u32..12), 0..40),
        ) {
            let mut mesh = Mesh::default();
            for &(x, y, z, u, v) in &points {
                mesh.positions.push(Vec3::new(x.into(), y.into(), z.into()));
                mesh.normals.push([Vec3::X, Vec3::Y, Vec3::Z][z as usize]);
                mesh.uvs[0].push(Vec2::new(u.into(), v.into()));
            }
            let count = points.len() as u32;
            mesh.indices = indices.iter().map(|t| t.map(|vertex| vertex % count)).collect();
            let made = with_tangents(&mesh);
            prop_assert_eq!(made.tangents.len(), made.positions.len());
            prop_assert!(made.tangents.iter().all(|t| t.is_finite() && t.w.abs() == 1.0));
            for (before, after) in mesh.indices.iter().zip(&made.indices) {
                let places = |mesh: &Mesh, t: [u32; 3]| t.map(|i| mesh.positions[i as usize]);
                prop_assert_eq!(places(&mesh, *before), places(&made, *after));
            }
        }
    }
}
