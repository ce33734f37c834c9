//! Rocks, shrubs, crowns of trees: what is round and not even.

use super::Shape;
use super::detail::circle;
use crate::generate::ground::octaves;
use crate::generate::random::Random;
use crate::generate::tessellation::Tessellation;
use crate::math::DVec3;

/// A ball about the origin with dents.
#[derive(Clone, Debug)]
pub struct Rock {
    /// Half its sizes.
    pub half: DVec3,
    /// Another number, other dents.
    pub seed: u64,
}

/// Rows and columns.
fn grid(level: u32) -> [usize; 2] {
    let columns = (5 + level as usize).min(400);
    [columns.div_ceil(2), columns]
}

impl Rock {
    fn point(&self, out: DVec3) -> DVec3 {
        let dents = octaves(self.seed, out.x * 1.3 + 2.0 * out.y, out.z * 1.3 - out.y, 4);
        out * self.half * (1.0 + 0.16 * dents)
    }
}

impl Shape for Rock {
    fn count(&self, level: u32) -> u64 {
        let [rows, columns] = grid(level);
        (2 * columns * (rows - 1)) as u64
    }

    fn build(&self, level: u32) -> Tessellation {
        let ([rows, columns], mut made) = (grid(level), Tessellation::default());
        let around = circle(columns);
        let mut corner = |out: DVec3| made.vertex(self.point(out), out);
        let [south, north] = [DVec3::NEG_Y, DVec3::Y].map(&mut corner);
        let ring = |row: usize| -> Vec<u32> {
            let (sin, cos) = libm::sincos(std::f64::consts::PI * row as f64 / rows as f64);
            let corner = |&(x, z): &(f64, f64)| corner(DVec3::new(x * sin, -cos, z * sin));
            around.iter().map(corner).collect()
        };
        let rings: Vec<_> = (1..rows).map(ring).collect();
        made.fan(south, &rings[0], false);
        for pair in rings.windows(2) {
            made.band(&pair[0], &pair[1], true);
        }
        made.fan(north, &rings[rings.len() - 1], true);
        made.face_as_triangles();
        made
    }

    fn extent(&self) -> f64 {
        2.0 * self.half.max_element()
    }
}

/// Leaves, a triangle each, about in a ball around the origin: more of them are smaller.
#[derive(Clone, Debug)]
pub struct Foliage {
    /// Half its sizes.
    pub half: DVec3,
    /// Another number, other leaves.
    pub seed: u64,
}

impl Shape for Foliage {
    fn count(&self, level: u32) -> u64 {
        40 + 12 * u64::from(level)
    }

    fn build(&self, level: u32) -> Tessellation {
        let (count, mut made) = (self.count(level), Tessellation::default());
        let random = &mut Random::new(self.seed);
        let size = 1.7 / (count as f64).sqrt() * self.half.max_element();
        for _ in 0..count {
            let mut ball = || loop {
                let mut side = || random.between(-1.0, 1.0);
                let point = DVec3::new(side(), side(), side());
                if (0.01..1.0).contains(&point.length_squared()) {
                    return point;
                }
            };
            // More of them outside than within.
            let (middle, along) = (ball(), ball().normalize());
            let middle = middle / middle.length().sqrt() * self.half;
            let across = along.cross(ball()).normalize_or(along.any_orthonormal_vector());
            let corners = [along * 1.2, across * 0.5 - along * 0.4, -across * 0.5 - along * 0.4];
            let [a, b, c] = corners.map(|corner| middle + corner * size);
            let normal = (b - a).cross(c - a);
            let corners = [a, b, c].map(|corner| made.vertex(corner, normal));
            made.triangle(corners);
        }
        made
    }

    fn extent(&self) -> f64 {
        2.0 * self.half.max_element()
    }
}
