//! Meshes whose vertices move.

use super::{Mesh, Triangle, own_box};
use crate::math::{Aabb, Vec3, Vec4};

/// 2^-20, of the coordinates of the keys on both sides: bounds the errors of a vertex between them.
/// That is off by less than four roundings, at each of two times, and `part` by one of its own.
const BETWEEN_KEYS: f32 = 1.0 / 1_048_576.0;

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

    /// Bytes of its keys.
    pub fn heap_bytes(&self) -> usize {
        let of_key = |key: &VertexKey| {
            let vertices = size_of_val(&*key.positions) + size_of_val(&*key.normals);
            size_of::<VertexKey>() + vertices + size_of_val(&*key.tangents)
        };
        self.keys.iter().map(of_key).sum()
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

    /// The box that holds the [`own_box`] of a triangle from one time to another.
    ///
    /// Vertices go straight between the two and the keys that lie within, and the planes of the
    /// box as far out as theirs; with room for what they are rounded.
    pub fn own_box(&self, corners: [u32; 3], [from, to]: [f32; 2]) -> Aabb {
        let at_key = |key: &VertexKey| {
            let [a, b, c] = corners.map(|corner| key.positions[corner as usize]);
            Triangle { a, b, c }
        };
        let at = |time| {
            let between = self.between(time);
            let [a, b, c] = corners.map(|corner| between.position(corner as usize));
            Triangle { a, b, c }
        };
        let (first, last) = (self.before(from), self.before(to) + 1);
        let keys = &self.keys[first..=last];
        let of_keys = keys.iter().map(|key| own_box(&at_key(key))).fold(Aabb::EMPTY, Aabb::union);
        let within = &keys[1..keys.len() - 1];
        let boxes = within.iter().map(|key| own_box(&at_key(key)));
        let all = boxes.fold(own_box(&at(from)).union(own_box(&at(to))), Aabb::union);
        let room = of_keys.min.abs().max(of_keys.max.abs()) * BETWEEN_KEYS;
        Aabb { min: all.min - room, max: all.max + room }
    }

    /// By how much vertices leave the straight lines between where they are at two times, along any
    /// axis, in between; with room for what they are rounded.
    pub fn bend(&self, corners: [u32; 3], [from, to]: [f32; 2]) -> f32 {
        let ends = [from, to].map(|time| self.between(time));
        let (first, last) = (self.before(from), self.before(to) + 1);
        let mut bend = 0.0_f32;
        for key in &self.keys[first..=last] {
            let part = (key.time - f64::from(from)) / f64::from(to - from);
            for corner in corners.map(|corner| corner as usize) {
                let (at, [from, to]) =
                    (key.positions[corner], ends.map(|end| end.position(corner)));
                let within = (0.0..=1.0).contains(&part);
                let straight = if within { mix(from, to, part as f32) } else { at };
                let room = at.abs().max_element() * BETWEEN_KEYS;
                bend = bend.max((at - straight).abs().max_element() + 2.0 * room);
            }
        }
        bend
    }

    /// The number of the key before a time, which is not the last one.
    #[inline]
    fn before(&self, time: f32) -> usize {
        let after = self.keys.partition_point(|key| key.time <= f64::from(time));
        after.saturating_sub(1).min(self.keys.len() - 2)
    }

    #[inline]
    fn between(&self, time: f32) -> Between<'_> {
        let before = self.before(time);
        let (from, to) = (&self.keys[before], &self.keys[before + 1]);
        let part = (f64::from(time) - from.time) / (to.time - from.time);
        Between { from, to, part: part.clamp(0.0, 1.0) as f32 }
    }
}

#[derive(Clone, Copy, Debug)]
struct Between<'a> {
    from: &'a VertexKey,
    to: &'a VertexKey,
    part: f32,
}

impl Between<'_> {
    #[inline(always)]
    fn position(&self, vertex: usize) -> Vec3 {
        mix(self.from.positions[vertex], self.to.positions[vertex], self.part)
    }
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
            Some(between) => between.position(vertex),
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

    #[test]
    fn a_box_holds_a_triangle_from_one_time_to_another_and_little_more() {
        let corner = |number: f32, time: f32| {
            let angle = 3.0 * time + number;
            Vec3::new(libm::cosf(angle), 100.0 * time - 40.0, libm::sinf(2.0 * angle))
        };
        let key = |time: f32| VertexKey {
            time: f64::from(time),
            positions: [0.0, 0.1, 0.2].map(|number| corner(number, time)).to_vec(),
            ..VertexKey::default()
        };
        let moving = Deformation::new([0.0, 0.3, 0.35, 0.7, 1.0].map(key).to_vec());
        let moving = moving.expect("has keys");
        let mesh = Mesh { indices: vec![[0, 1, 2]], ..Mesh::default() };
        for span in [[0.0, 1.0], [0.25, 0.5], [0.375, 0.4375], [0.9375, 1.0], [0.3, 0.3]] {
            let held = moving.own_box([0, 1, 2], span);
            let mut tight = Aabb::EMPTY;
            for step in 0..=1000 {
                let time = span[0] + (span[1] - span[0]) * (step as f32 / 1000.0);
                let own = own_box(&Posed::new(&mesh, Some(&moving), time).triangle(0));
                assert_eq!(held.union(own), held, "{span:?}, {time}");
                tight = tight.union(own);
            }
            let room = (held.max - tight.max).max(tight.min - held.min).max_element();
            assert!(room < 0.01, "{span:?}: {room}");
        }
    }

    #[test]
    fn vertices_bend_by_what_they_leave_a_straight_line_at_keys_between() {
        let key = |time: f64, y: f32| VertexKey {
            time,
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(0.0, y, 0.0)],
            ..VertexKey::default()
        };
        let moving = Deformation::new(vec![key(0.0, 0.0), key(0.5, 3.0), key(1.0, 4.0)]);
        let moving = moving.expect("has keys");
        let is_about = |span, expected: f32| {
            let bend = moving.bend([0, 1, 2], span);
            assert!((0.0..1e-4).contains(&(bend - expected)), "{span:?}: {bend}");
        };
        is_about([0.0, 1.0], 1.0);
        is_about([0.25, 0.75], 0.5);
        is_about([0.0, 0.5], 0.0);
        is_about([0.5, 0.75], 0.0);
        assert!(moving.bend([0, 1, 0], [0.0, 1.0]) < 1e-4, "those stay");
    }
}
