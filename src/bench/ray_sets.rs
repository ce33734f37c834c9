//! Sets of rays over a scene: random, primary, bounce and hostile ones.

use crate::accel::{Accel, Batch, ClosestHit};
use crate::geom::{Triangle, TriangleSource};
use crate::math::{Aabb, Frame, PrimId, Ray, Vec3};

/// A small generator of random numbers with a sequence of its own per index, so that sets can be
/// made in pieces and replayed from any ray.
///
/// M. O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for
/// Random Number Generation", 2014 (PCG-XSH-RR); seeded by splitmix64.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The sequence number `index` of a seed.
    pub fn new(seed: u64, index: u64) -> Self {
        let mut z =
            (seed ^ index.wrapping_mul(0xd1342543de82ef95)).wrapping_add(0x9e3779b97f4a7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58476d1ce4e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d049bb133111eb);
        Self { state: z ^ (z >> 31) }
    }

    /// 32 random bits.
    pub fn bits(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let shifted = (((old >> 18) ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 * (1.0 / 16777216.0)
    }

    /// Below `n`, which is not zero.
    pub fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.bits()) * n as u64) >> 32) as usize
    }

    /// Uniform in the unit cube.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }

    /// Uniform on the unit sphere, by rejection.
    pub fn sphere(&mut self) -> Vec3 {
        loop {
            let v = self.cube() * 2.0 - 1.0;
            let square = v.length_squared();
            if square <= 1.0 && square > 1e-4 {
                return v / square.sqrt();
            }
        }
    }
}

/// The sets that `validate` and the bench know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RaySet {
    /// From and to random points of the scene's box.
    Random,
    /// The same, ending at the second point.
    Shadow,
    /// From a camera outside, row by row.
    Primary,
    /// From where random rays hit, cosine-distributed.
    Bounce,
    /// Everything that trips a traversal.
    Hostile,
}

impl RaySet {
    /// All.
    pub const ALL: [Self; 5] =
        [Self::Random, Self::Shadow, Self::Primary, Self::Bounce, Self::Hostile];

    /// As tables name it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Random => "random",
            Self::Shadow => "shadow",
            Self::Primary => "primary",
            Self::Bounce => "bounce",
            Self::Hostile => "hostile",
        }
    }
}

/// What rays are made over: triangles, their box, and a structure that says what is hit.
pub struct Target<'a> {
    source: &'a dyn TriangleSource,
    bounds: Aabb,
    accel: &'a dyn Accel,
}

impl<'a> Target<'a> {
    /// Rays over `source`; `accel` must be a structure of it.
    pub fn new(source: &'a dyn TriangleSource, accel: &'a dyn Accel) -> Self {
        let ids = (0..source.len()).map(PrimId::from_index);
        let bounds = ids.map(|id| source.triangle(id).bounds()).fold(Aabb::EMPTY, Aabb::union);
        let bounds =
            if bounds.is_empty() { Aabb { min: Vec3::ZERO, max: Vec3::ONE } } else { bounds };
        Self { source, bounds, accel }
    }

    /// `count` rays of a set; the same for the same seed.
    pub fn rays(&self, set: RaySet, count: usize, seed: u64) -> Vec<Ray> {
        let of = |ray: &dyn Fn(&mut Random) -> Ray| {
            (0..count).map(|i| ray(&mut Random::new(seed, i as u64))).collect()
        };
        match set {
            RaySet::Random => of(&|random| self.random(random, false)),
            RaySet::Shadow => of(&|random| self.random(random, true)),
            RaySet::Primary => self.primary(count),
            RaySet::Bounce => self.bounce(count, seed),
            RaySet::Hostile => of(&|random| self.hostile(random)),
        }
    }

    /// Packets of rays between two points each, random in the scene's box; either end of every ray
    /// is jittered in a box of the scene's shape and `incoherence` times its size.
    ///
    /// M. Ernst and G. Greiner, "Multi bounding volume hierarchies", 2008, section 4.
    pub fn packets(&self, incoherence: f32, packets: usize, size: usize, seed: u64) -> Vec<Ray> {
        let region = self.bounds.extent() * incoherence;
        let of_packet = |packet: usize| {
            let mut random = Random::new(seed, packet as u64);
            let (from, to) = (self.point(&mut random), self.point(&mut random));
            (0..size).map(move |_| {
                let from = from + region * (random.cube() - 0.5);
                let to = to + region * (random.cube() - 0.5);
                Ray::new(from, to - from, 0.0, f32::INFINITY)
            })
        };
        (0..packets).flat_map(of_packet).collect()
    }

    fn point(&self, random: &mut Random) -> Vec3 {
        self.bounds.min + self.bounds.extent() * random.cube()
    }

    fn random(&self, random: &mut Random, segment: bool) -> Ray {
        let (from, to) = (self.point(random), self.point(random));
        Ray::new(from, to - from, 0.0, if segment { 1.0 } else { f32::INFINITY })
    }

    /// A square picture of about `count` pixels from outside.
    fn primary(&self, count: usize) -> Vec<Ray> {
        let (centre, radius) = (self.bounds.centre(), self.bounds.extent().length() * 0.5);
        let eye = centre + Vec3::new(0.5, 0.35, 0.8).normalize() * radius * 1.6;
        let forward = (centre - eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
        let up = right.cross(forward);
        let size = (count as f64).sqrt().ceil().max(1.0) as usize;
        let at = |i: usize| (i as f32 + 0.5) / size as f32 * 2.0 - 1.0;
        (0..count)
            .map(|i| {
                let direction = forward + (right * at(i % size) - up * at(i / size)) * 0.55;
                Ray::new(eye, direction.normalize_or_zero(), 0.0, f32::INFINITY)
            })
            .collect()
    }

    fn bounce(&self, count: usize, seed: u64) -> Vec<Ray> {
        let first = self.rays(RaySet::Random, count, seed ^ 0x5eed);
        let mut hits = vec![ClosestHit::MISS; count];
        self.accel.tracer().closest_hits(&Batch::new(&first), &mut hits);
        let bounced = first.iter().zip(&hits).enumerate().filter(|(_, (_, hit))| hit.is_hit());
        bounced
            .map(|(i, (ray, hit))| {
                let hit_triangle = PrimId(self.source.number(hit.triangle) as u32);
                let normal = self.source.triangle(hit_triangle).double_area();
                let normal = normal.normalize_or(Vec3::Y);
                let normal = if normal.dot(ray.direction()) > 0.0 { -normal } else { normal };
                let direction = normal + Random::new(!seed, i as u64).sphere() * 0.9999;
                let lift = normal * (self.bounds.extent().max_element() * 1e-5);
                Ray::new(ray.at(hit.t) + lift, direction.normalize(), 0.0, f32::INFINITY)
            })
            .collect()
    }

    fn some_triangle(&self, random: &mut Random) -> Triangle {
        match self.source.len() {
            0 => Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Y },
            n => self.source.triangle(PrimId::from_index(random.below(n))),
        }
    }

    /// A point on a triangle: a vertex, a point of an edge or one inside.
    fn on(triangle: &Triangle, random: &mut Random) -> Vec3 {
        let Triangle { a, b, c } = *triangle;
        match random.below(4) {
            0 => a,
            1 => a.midpoint(b),
            2 => b + (c - b) * random.unit(),
            _ => a + (b - a) * (random.unit() * 0.5) + (c - a) * (random.unit() * 0.5),
        }
    }

    /// Aimed at vertices and edges, along axes, in planes of triangles, from vertices, from far
    /// away and from bounds of triangles; with signed zeros, tiny, huge, infinite and NaN parts.
    fn hostile(&self, random: &mut Random) -> Ray {
        let triangle = self.some_triangle(random);
        let other = self.some_triangle(random);
        let target = Self::on(&triangle, random);
        let extent = self.bounds.extent().max_element();
        let from = match random.below(8) {
            0 => Self::on(&other, random),
            1 => Self::on(&triangle, random),
            2 => self.bounds.centre() + random.sphere() * extent * 100.0,
            3 => self.bounds.centre() + random.sphere() * extent * 1e4,
            4 => target + Vec3::AXES[random.below(3)] * extent * (random.unit() - 0.5),
            5 => Vec3::new(other.a.x, self.point(random).y, other.bounds().max.z),
            _ => self.point(random),
        };
        let mut direction = target - from;
        let t_max = [1.0, f32::INFINITY, f32::INFINITY, 1e30, 0.999_999_9][random.below(5)];
        match random.below(8) {
            0 => direction = direction.normalize_or_zero(),
            1 => direction[random.below(3)] = [0.0, -0.0][random.below(2)],
            2 => {
                let axis = random.below(3);
                direction = Vec3::AXES[axis].copysign(direction);
                direction[(axis + 1) % 3] *= 0.0;
            }
            3 => direction[random.below(3)] *= [1e-30, 1e-38, 1e-42][random.below(3)],
            4 => direction *= [1e-12, 1e12][random.below(2)],
            5 => {
                direction =
                    Frame::from_normal((triangle.b - triangle.a).normalize_or(Vec3::X)).normal;
            }
            6 if random.below(50) == 0 => {
                direction[random.below(3)] = [f32::NAN, f32::INFINITY][random.below(2)];
            }
            _ => {}
        }
        Ray::new(from, direction, [0.0, 0.0, 1e-3][random.below(3)], t_max)
    }
}

/// Rays as rows of origin, `t_min`, direction and `t_max`, the form of files.
pub fn to_rows(rays: &[Ray]) -> Vec<f32> {
    let row = |ray: &Ray| {
        let (o, d) = (ray.origin(), ray.direction());
        [o.x, o.y, o.z, ray.t_min(), d.x, d.y, d.z, ray.t_max()]
    };
    rays.iter().flat_map(row).collect()
}

/// The rays of such rows.
pub fn from_rows(rows: &[f32]) -> impl Iterator<Item = Ray> {
    rows.chunks_exact(8)
        .map(|r| Ray::new(Vec3::new(r[0], r[1], r[2]), Vec3::new(r[4], r[5], r[6]), r[3], r[7]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::build;
    use crate::geom::TriangleList;
    use crate::simd::Isa;
    use std::sync::Arc;

    #[test]
    fn packets_lose_their_coherence_by_degrees() {
        let triangle = Triangle { a: Vec3::ZERO, b: Vec3::X * 8.0, c: Vec3::new(2.0, 4.0, 2.0) };
        let source = Arc::new(TriangleList(vec![triangle]));
        let spec = "brute".parse().expect("in the table");
        let accel = build(&spec, source.clone(), Isa::Portable).expect("one triangle");
        let target = Target::new(&*source, &*accel);
        let spread = |incoherence: f32| {
            let rays = target.packets(incoherence, 3, 64, 1);
            assert_eq!(rays.len(), 3 * 64);
            let of_packet = |rays: &[Ray]| {
                let points = rays.iter().map(|ray| Aabb { min: ray.origin(), max: ray.origin() });
                points.fold(Aabb::EMPTY, Aabb::union).extent()
            };
            rays.chunks(64).map(of_packet).fold(Vec3::ZERO, Vec3::max)
        };
        assert_eq!(spread(0.0), Vec3::ZERO);
        for incoherence in [0.01, 0.5, 1.0] {
            let share = spread(incoherence) / (Vec3::new(8.0, 4.0, 2.0) * incoherence);
            assert!(share.min_element() > 0.7 && share.max_element() < 1.001, "{share}");
        }
    }
}
