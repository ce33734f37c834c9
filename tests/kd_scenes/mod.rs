//! Small scenes and rays chosen to break a kd-tree.

use std::sync::Arc;

use dapple::geom::{Triangle, TriangleList, TriangleSource};
use dapple::math::{PrimId, Ray, Vec3};

/// A small generator of numbers (Marsaglia's xorshift, 64 bits).
pub struct Random(pub u64);

impl Random {
    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / 16_777_216.0
    }

    fn index(&mut self, count: usize) -> usize {
        ((self.unit() * count as f32) as usize).min(count - 1)
    }

    /// Uniform in the cube [-1, 1)^3.
    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

/// Triangles of a size, scattered in a cube of edge 2.
pub fn soup(count: usize, size: f32, seed: u64) -> Vec<Triangle> {
    let mut random = Random(seed);
    let mut triangle = || {
        let at = random.vector();
        let mut corner = || at + random.vector() * size;
        Triangle { a: corner(), b: corner(), c: corner() }
    };
    (0..count).map(|_| triangle()).collect()
}

/// A grid of `n` by `n` squares in the plane y = `y`, of edge 2.
fn sheet(n: usize, y: f32) -> Vec<Triangle> {
    let at = |i: usize, j: usize| {
        Vec3::new(i as f32 / n as f32 * 2.0 - 1.0, y, j as f32 / n as f32 * 2.0 - 1.0)
    };
    let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    squares
        .flat_map(|(i, j)| {
            let [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [Triangle { a: p, b: q, c: r }, Triangle { a: p, b: r, c: s }]
        })
        .collect()
}

/// A cube of `n` by `n` squares a face: every plane of the tree has triangles in it.
fn cube(n: usize) -> Vec<Triangle> {
    let top = sheet(n, 1.0);
    let turn =
        |f: fn(Vec3) -> Vec3| top.iter().map(move |t| Triangle { a: f(t.a), b: f(t.b), c: f(t.c) });
    turn(|p| p)
        .chain(turn(|p| -p))
        .chain(turn(|p| Vec3::new(p.y, p.x, p.z)))
        .chain(turn(|p| Vec3::new(-p.y, p.x, p.z)))
        .chain(turn(|p| Vec3::new(p.x, p.z, p.y)))
        .chain(turn(|p| Vec3::new(p.x, p.z, -p.y)))
        .collect()
}

fn moved(triangles: &[Triangle], scale: f32, by: Vec3) -> Vec<Triangle> {
    let f = |p: Vec3| p * scale + by;
    triangles.iter().map(|t| Triangle { a: f(t.a), b: f(t.b), c: f(t.c) }).collect()
}

/// The scenes by name.
pub fn scenes() -> Vec<(&'static str, Arc<dyn TriangleSource>)> {
    let long: Vec<_> = soup(300, 1.0, 7)
        .into_iter()
        .map(|t| Triangle { b: t.a + (t.b - t.a) * 1e-3, ..t })
        .collect();
    let points: Vec<_> =
        soup(50, 0.1, 9).into_iter().map(|t| Triangle { b: t.a, c: t.a, ..t }).collect();
    let mixed: Vec<_> = soup(400, 0.2, 3).into_iter().chain(sheet(8, 0.25)).collect();
    let far = Vec3::new(148_376.0, 1234.0, -223_423.0);
    let all = [
        ("soup", soup(1500, 0.08, 1)),
        ("large triangles", soup(150, 0.9, 2)),
        ("needles", long),
        ("cube", cube(6)),
        ("sheet", sheet(20, 0.0)),
        ("sheets", (0..5).flat_map(|i| sheet(5, i as f32 * 0.25)).collect()),
        ("mixed", mixed),
        ("nothing", Vec::new()),
        ("one", soup(1, 0.5, 4)),
        ("copies", vec![soup(1, 0.5, 5)[0]; 2000]),
        ("points", points),
        ("far away", moved(&cube(4), 1.0, far)),
        ("tiny", moved(&soup(500, 0.2, 6), 1e-20, Vec3::ZERO)),
        ("tiny, moved", moved(&cube(4), 1e-3, Vec3::ONE)),
        ("smallest", moved(&cube(2), 1e-38, Vec3::ZERO)),
        ("huge", moved(&soup(500, 0.2, 8), 1e20, Vec3::ZERO)),
        ("largest", moved(&cube(3), 3e38, Vec3::ZERO)),
        (
            "a speck and a giant",
            moved(&cube(3), 1e-6, Vec3::ONE).into_iter().chain(cube(2)).collect(),
        ),
    ];
    all.into_iter()
        .map(|(name, list)| (name, Arc::new(TriangleList(list)) as Arc<dyn TriangleSource>))
        .collect()
}

/// Rays of all kinds at a scene: random, along axes, at vertices and edges, inside triangles'
/// planes, from surfaces, from afar, with odd directions and limits.
pub fn hostile_rays(source: &dyn TriangleSource, count: usize) -> Vec<Ray> {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let triangles: Vec<_> =
        (0..source.len()).map(|i| source.triangle(PrimId::from_index(i))).collect();
    let (centre, half) = centre_and_half(&triangles);
    let make = |i: usize, random: &mut Random| {
        let t = pick(&triangles, random);
        let spread = [0.5, 1.0, 3.0, 5.5, 7.0, 40.0, 1e9][random.index(7)];
        let from = centre + random.vector() * (half * spread);
        let w = [random.unit(), random.unit()];
        let inside = t.a + (t.b - t.a) * (w[0] * 0.5) + (t.c - t.a) * (w[1] * 0.5);
        let to = match random.index(4) {
            0 => t.a,
            1 => t.a + (t.b - t.a) * 0.5,
            2 => inside,
            _ => centre + random.vector() * half,
        };
        let limit = if random.index(5) == 0 { 1.0 } else { f32::INFINITY };
        let start = if random.index(6) == 0 { 1e-3 } else { 0.0 };
        let (origin, direction) = match i % 10 {
            0 | 1 => (from, to - from),
            // Along an axis, through a vertex or a point, with zeros of either sign.
            2 | 3 => {
                let mut direction = [0.0, -0.0, 0.0];
                direction.rotate_left(random.index(3));
                let axis = random.index(3);
                direction[axis] = if random.unit() < 0.5 { 1.0 } else { -1.0 };
                let mut origin = to;
                origin[axis] = from[axis];
                (origin, Vec3::from(direction))
            }
            // From a surface, or a vertex, into any direction.
            4 => (to, random.vector()),
            // In the plane of a triangle.
            5 => (inside - (t.b - t.a) * 3.0, t.b - t.a),
            6 => (t.c + (t.c - t.a), t.a - t.c),
            // Two components, the third zero or denormal.
            7 => {
                let mut direction = to - from;
                direction[random.index(3)] = [0.0, -0.0, 1e-42, -1e-40][random.index(4)];
                (from, direction)
            }
            // Between vertices: origins in planes and on edges.
            8 => (t.b, pick(&triangles, random).c - t.b),
            _ => {
                let stride = [1e-25, 1e-10, 1e10, 1e25][random.index(4)];
                (from, (to - from).normalize_or_zero() * stride)
            }
        };
        Ray::new(origin, direction, start, limit)
    };
    odd_rays().into_iter().chain((0..count).map(|i| make(i, &mut random))).take(count).collect()
}

/// The middle of all triangles, and half of their largest extent.
fn centre_and_half(triangles: &[Triangle]) -> (Vec3, f32) {
    let mut low = Vec3::splat(f32::MAX);
    let mut high = Vec3::splat(f32::MIN);
    for t in triangles {
        low = low.min(t.bounds().min);
        high = high.max(t.bounds().max);
    }
    if triangles.is_empty() {
        (Vec3::ZERO, 1.0)
    } else {
        (low * 0.5 + high * 0.5, (high * 0.5 - low * 0.5).max_element())
    }
}

/// One of the triangles at random; where there are none, one of its own.
fn pick(triangles: &[Triangle], random: &mut Random) -> Triangle {
    if triangles.is_empty() {
        return Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Y };
    }
    triangles[random.index(triangles.len())]
}

/// Rays that miss everything, each for another reason.
fn odd_rays() -> [Ray; 6] {
    [
        Ray::MISS,
        Ray::new(Vec3::splat(f32::NAN), Vec3::X, 0.0, 1.0),
        Ray::new(Vec3::ZERO, Vec3::ZERO, 0.0, 1.0),
        Ray::new(Vec3::ZERO, Vec3::X, 2.0, 1.0),
        Ray::new(Vec3::ZERO, Vec3::X, 0.0, -1.0),
        Ray::new(Vec3::splat(3e38), Vec3::NEG_ONE, 0.0, f32::INFINITY),
    ]
}
