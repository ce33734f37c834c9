//! Stones with moss on them.

use super::piece::Piece;
use crate::generate::random::Random;
use crate::generate::shape::{Rock, Shape};
use crate::math::DVec3;

/// A stone of at most so many triangles, and of the fewest that there are if these are more.
pub fn stone(triangles: u64, material: usize, seed: u64) -> Piece {
    let random = &mut Random::new(seed);
    let half = DVec3::new(0.5, random.between(0.26, 0.4), random.between(0.32, 0.48));
    let rock = Rock { half, seed };
    let level = (1..400).take_while(|&level| rock.count(level) <= triangles).last().unwrap_or(0);
    let made = rock.build(level);
    let mut piece = Piece::new(material);
    for vertex in &made.vertices {
        let [at, normal] = [vertex.position, vertex.normal].map(|v| DVec3::from(v.map(f64::from)));
        let moss = ((normal.y - 0.35) * 2.2).clamp(0.0, 1.0) * random.between(0.3, 1.0);
        let grey = DVec3::new(0.62, 0.6, 0.56) * random.between(0.8, 1.0);
        // Flat: stones have faces and edges.
        piece.corner(at, grey.lerp(DVec3::new(0.34, 0.45, 0.14), moss));
    }
    piece.indices = made.indices;
    piece
}
