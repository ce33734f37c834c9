//! Meshes whose vertices move.

use super::{Mesh, Triangle};
use crate::math::{Aabb, Vec3, Vec4};

/// The vertices of a mesh at some times while the shutter is open; between them they go straight.
#[derive(Clone, Debug)]
pub struct Deformation {
    /// In order, from 0 to 1, at least two.
    keys: Vec<VertexKey>,
}

/// The vertices of a mesh at a time: as many as the mesh has.
#[derive(Clone, Debug, Default)]
pub struct VertexKey {
    /// The time, from 0 to 1.
    pub time: f64,
    /// See [`Mesh::positions`].
    pub positions: Vec<Vec3>,
    /// See [`Mesh::normals`].
    pub normals: Vec<Vec3>,
    /// See [`Mesh::tangents`].
    pub tangents: Vec<Vec4>,
}

impl VertexKey {
    /// What moves of a mesh.
    pub fn of(mesh: Mesh, time: f64) -> Self {
        let Mesh { positions, normals, tangents, .. } = mesh;
        Self { time, positions, normals, tangents }
    }
}

impl Deformation {
    /// Of keys in order; `None` if there are fewer than two.
    pub fn new(keys: Vec<VertexKey>) -> Option<Self> {
        (keys.len() > 1).then_some(Self { keys })
    }

    /// The keys.
    pub fn keys(&self) -> &[VertexKey] {
        &self.keys
    }

    /// The box of some vertices at all times.
    pub fn bounds(&self, vertices: &(impl Iterator<Item = u32> + Clone)) -> Aabb {
        let of_key = |key: &VertexKey| {
            let vertices = vertices.clone();
            Aabb::of_points(vertices.map(|vertex| key.positions[vertex as usize]))
        };
        self.keys.iter().map(of_key).fold(Aabb::EMPTY, Aabb::union)
    }

    #[inline]
    fn between(&self, time: f32) -> Between<'_> {
        let time = f64::from(time);
        let last = self.keys.len() - 2;
        let after = self.keys.partition_point(|key| key.time <= time);
        let before = after.saturating_sub(1).min(last);
        let (from, to) = (&self.keys[before], &self.keys[before + 1]);
        let part = (time - from.time) / (to.time - from.time);
        Between { from, to, part: part.clamp(0.0, 1.0) as f32 }
    }
}

#[derive(Clone, Copy, Debug)]
struct Between<'a> {
    from: &'a VertexKey,
    to: &'a VertexKey,
    part: f32,
}

/// A mesh at a time.
#[derive(Clone, Copy, Debug)]
pub struct Posed<'a> {
    /// All that does not move of it.
    pub mesh: &'a Mesh,
    between: Option<Between<'a>>,
}

impl<'a> Posed<'a> {
    /// A mesh at a `time` from 0 to 1; one without a deformation is the same at all of them.
    #[inline(always)]
    pub fn new(mesh: &'a Mesh, deformation: Option<&'a Deformation>, time: f32) -> Self {
        Self { mesh, between: deformation.map(|deformation| deformation.between(time)) }
    }

    /// Where a vertex is.
    #[inline(always)]
    pub fn position(&self, vertex: usize) -> Vec3 {
        match &self.between {
            None => self.mesh.positions[vertex],
            Some(Between { from, to, part }) => {
                mix(from.positions[vertex], to.positions[vertex], *part)
            }
        }
    }

    /// The vertices of a triangle.
    #[inline]
    pub fn triangle(&self, index: u32) -> Triangle {
        let [a, b, c] = self.mesh.indices[index as usize].map(|i| self.position(i as usize));
        Triangle { a, b, c }
    }

    /// Whether it has normals.
    #[inline(always)]
    pub fn has_normals(&self) -> bool {
        !self.mesh.normals.is_empty()
    }

    /// The normal of a vertex, not quite a unit vector.
    #[inline(always)]
    pub fn normal(&self, vertex: usize) -> Vec3 {
        match &self.between {
            None => self.mesh.normals[vertex],
            Some(Between { from, to, part }) => {
                mix(from.normals[vertex], to.normals[vertex], *part)
            }
        }
    }

    /// The tangent of a vertex.
    #[inline(always)]
    pub fn tangent(&self, vertex: usize) -> Vec4 {
        match &self.between {
            None => self.mesh.tangents[vertex],
            Some(Between { from, to, part }) => {
                let (from, to) = (from.tangents[vertex], to.tangents[vertex]);
                mix(from.truncate(), to.truncate(), *part).extend(from.w)
            }
        }
    }
}

/// Between two points: in each coordinate between theirs, but for a rounding.
#[inline(always)]
fn mix(from: Vec3, to: Vec3, part: f32) -> Vec3 {
    from * (1.0 - part) + to * part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_go_straight_from_key_to_key() {
        let mesh = Mesh { positions: vec![Vec3::ZERO], ..Mesh::default() };
        let key =
            |time, x| VertexKey { time, positions: vec![Vec3::X * x], ..VertexKey::default() };
        let moving = Deformation::new(vec![key(0.0, 0.0), key(0.5, 2.0), key(1.0, 0.0)]);
        let moving = moving.expect("has keys");
        for (time, x) in [(0.0, 0.0), (0.25, 1.0), (0.5, 2.0), (0.75, 1.0), (1.0, 0.0)] {
            assert_eq!(Posed::new(&mesh, Some(&moving), time).position(0), Vec3::X * x, "{time}");
        }
        let bounds = moving.bounds(&[0].into_iter());
        assert_eq!((bounds.min, bounds.max), (Vec3::ZERO, Vec3::X * 2.0));
        assert!(Deformation::new(vec![key(0.0, 0.0)]).is_none());
    }
}
