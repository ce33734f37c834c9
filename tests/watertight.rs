//! No ray slips through a closed mesh: aimed at its vertices and the middles of its edges, from
//! inside and from outside.

use std::collections::HashMap;
use std::sync::Arc;

use dapple::Isa;
use dapple::accel::{Accel, Batch, ClosestHit, VARIANTS, build};
use dapple::geom::{Triangle, TriangleList};
use dapple::math::{DVec3, Ray, Vec3};
use dapple::testing::Random;

/// An indexed, closed mesh with its vertices rounded to f32.
struct Mesh {
    name: String,
    vertices: Vec<Vec3>,
    faces: Vec<[usize; 3]>,
    /// A curve inside, from which rays start, by a parameter from 0 to 1.
    inside: fn(f32, f32) -> DVec3,
    radius: f32,
    offset: DVec3,
}

fn place(p: DVec3, radius: f32, offset: DVec3) -> Vec3 {
    (p * f64::from(radius) + offset).as_vec3()
}

fn icosphere(levels: usize, radius: f32, offset: DVec3) -> Mesh {
    let phi = f64::midpoint(1.0, 5.0_f64.sqrt());
    let mut points: Vec<DVec3> = Vec::new();
    for (a, b) in [(-1.0, phi), (1.0, phi), (-1.0, -phi), (1.0, -phi)] {
        points.extend([DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)]);
    }
    let points: Vec<DVec3> = points.into_iter().map(DVec3::normalize).collect();
    // Faces: all triples at the edge's distance from each other.
    let near = |a: usize, b: usize| (points[a] - points[b]).length() < 1.1;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    faces.push([a, b, c]);
                }
            }
        }
    }
    let mut points = points;
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let mut middle = |a: usize, b: usize| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    points.push(((points[a] + points[b]) * 0.5).normalize());
                    points.len() - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        faces = finer;
    }
    Mesh {
        name: format!("icosphere of radius {radius} at {offset}"),
        vertices: points.iter().map(|&p| place(p, radius, offset)).collect(),
        faces,
        inside: |a, b| DVec3::new(f64::from(a) - 0.5, f64::from(b) - 0.5, 0.3) * 0.4,
        radius,
        offset,
    }
}

fn torus(n: usize, m: usize, radius: f32, offset: DVec3) -> Mesh {
    let angle = |i: usize, n: usize| i as f64 / n as f64 * std::f64::consts::TAU;
    let vertices = (0..n * m)
        .map(|i| {
            let (a, b) = (angle(i / m, n), angle(i % m, m));
            let ring = 0.7 + 0.3 * libm::cos(b);
            let p = DVec3::new(ring * libm::cos(a), 0.3 * libm::sin(b), ring * libm::sin(a));
            place(p, radius, offset)
        })
        .collect();
    let at = |i: usize, j: usize| (i % n) * m + j % m;
    let faces = (0..n * m)
        .flat_map(|k| {
            let (i, j) = (k / m, k % m);
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh {
        name: format!("torus of radius {radius} at {offset}"),
        vertices,
        faces,
        inside: |a, b| {
            let (a, r) = (f64::from(a) * std::f64::consts::TAU, 0.65 + 0.1 * f64::from(b));
            DVec3::new(r * libm::cos(a), 0.03, r * libm::sin(a))
        },
        radius,
        offset,
    }
}

impl Mesh {
    fn triangles(&self) -> TriangleList {
        let corner = |i: usize| self.vertices[i];
        let triangle =
            |&[a, b, c]: &[usize; 3]| Triangle { a: corner(a), b: corner(b), c: corner(c) };
        TriangleList(self.faces.iter().map(triangle).collect())
    }

    /// A vertex, or the middle of an edge.
    fn aim(&self, random: &mut Random) -> Vec3 {
        let face = self.faces[random.below(self.faces.len())];
        let i = random.below(3);
        let (a, b) = (self.vertices[face[i]], self.vertices[face[(i + 1) % 3]]);
        if random.below(2) == 0 { a } else { (a.as_dvec3() * 0.5 + b.as_dvec3() * 0.5).as_vec3() }
    }

    /// Rays from inside in any direction that passes through such a point, or from outside towards
    /// the inside through one; all of them must hit.
    fn rays(&self, count: usize) -> Vec<Ray> {
        (0..count)
            .map(|i| {
                let random = &mut Random::new(3, i as u64);
                let inside =
                    place((self.inside)(random.unit(), random.unit()), self.radius, self.offset);
                let target = self.aim(random);
                if i % 2 == 0 {
                    return Ray::new(inside, target - inside, 0.0, f32::INFINITY);
                }
                // From beyond the target; it goes on to the inside point and cannot but cross.
                let from = (inside.as_dvec3() + (target - inside).as_dvec3() * 3.0).as_vec3();
                Ray::new(from, inside - from, 0.0, f32::INFINITY)
            })
            .collect()
    }
}

fn meshes() -> Vec<Mesh> {
    let far = DVec3::new(148376.0, 1234.0, -223423.0);
    let mut meshes = Vec::new();
    for (radius, offset) in [(2.0, DVec3::ZERO), (1000.0, DVec3::ZERO), (2.0, far), (1000.0, far)] {
        meshes.push(icosphere(4, radius, offset));
        meshes.push(torus(48, 24, radius, offset));
    }
    meshes
}

fn misses(accel: &dyn Accel, rays: &[Ray]) -> usize {
    let mut hits = vec![ClosestHit::MISS; rays.len()];
    accel.tracer().closest_hits(&Batch::new(rays), &mut hits);
    hits.iter().filter(|hit| !hit.is_hit()).count()
}

#[test]
fn a_million_rays_find_no_gap_in_any_structure() {
    for variant in VARIANTS {
        for mesh in meshes() {
            // Brute force is slow and decides nothing that the others do not; it takes a part.
            let count = if variant.id == "brute" { 4_000 } else { 125_000 };
            let spec = variant.id.parse().expect("in the table");
            let accel =
                build(&spec, Arc::new(mesh.triangles()), Isa::Auto).expect("small meshes build");
            let missed = misses(&*accel, &mesh.rays(count));
            assert_eq!(missed, 0, "{}, {}: of {count} rays", variant.id, mesh.name);
        }
    }
}
