//! Meshes: triangles with what is needed to shade them.

use crate::math::{Aabb, Vec2, Vec3, Vec4};

/// A list of triangles over shared vertices, in the space of its own.
///
/// Loaders check that every index is below the number of positions, that positions are finite and
/// that each attribute is absent (empty) or as long as `positions`.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// What the file calls it; for messages.
    pub name: String,
    /// Vertex positions.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals; empty: flat shading.
    pub normals: Vec<Vec3>,
    /// Unit tangents, `w` the sign of the bitangent; empty: from the texture coordinates.
    pub tangents: Vec<Vec4>,
    /// The first two sets of texture coordinates, each possibly empty.
    pub uvs: [Vec<Vec2>; 2],
    /// The sets after them, for materials that look up more than two; each possibly empty.
    pub more_uvs: Vec<Vec<Vec2>>,
    /// Linear colours and alpha that multiply the material's base colour; empty: white.
    pub colors: Vec<Vec4>,
    /// Three vertices a triangle, counter-clockwise seen from the front.
    pub indices: Vec<[u32; 3]>,
}

impl Mesh {
    /// The box of all positions that a triangle uses.
    pub fn bounds(&self) -> Aabb {
        let corners = self.indices.iter().flatten();
        Aabb::of_points(corners.map(|&i| self.positions[i as usize]))
    }

    /// All sets of texture coordinates, by their numbers.
    pub fn uv_sets(&self) -> impl Iterator<Item = &[Vec2]> {
        self.uvs.iter().chain(&self.more_uvs).map(Vec::as_slice)
    }

    /// A set of texture coordinates; empty if there is none of that number.
    #[inline]
    pub fn uv_set(&self, number: usize) -> &[Vec2] {
        match self.uvs.get(number) {
            Some(set) => set,
            None => self.more_uvs.get(number - self.uvs.len()).map_or(&[], Vec::as_slice),
        }
    }

    /// The positions that triangles use, each once.
    pub fn used_positions(&self) -> Vec<Vec3> {
        let mut is_used = vec![false; self.positions.len()];
        for &i in self.indices.iter().flatten() {
            is_used[i as usize] = true;
        }
        let used = self.positions.iter().zip(is_used).filter(|(_, used)| *used);
        used.map(|(&position, _)| position).collect()
    }

    /// Appends a copy of each vertex in `sources`; attributes that are absent stay so.
    pub fn repeat_vertices(&mut self, sources: &[u32]) {
        fn repeat<T: Copy>(all: &mut Vec<T>, sources: &[u32]) {
            if !all.is_empty() {
                all.reserve_exact(sources.len());
                for &source in sources {
                    all.push(all[source as usize]);
                }
            }
        }
        repeat(&mut self.positions, sources);
        repeat(&mut self.normals, sources);
        repeat(&mut self.tangents, sources);
        self.uvs.iter_mut().chain(&mut self.more_uvs).for_each(|set| repeat(set, sources));
        repeat(&mut self.colors, sources);
    }

    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        size_of_val(&*self.positions)
            + size_of_val(&*self.normals)
            + size_of_val(&*self.tangents)
            + size_of_val(&*self.colors)
            + self.uv_sets().map(size_of_val).sum::<usize>()
            + size_of_val(&*self.indices)
    }
}
