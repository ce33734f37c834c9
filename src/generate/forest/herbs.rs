//! What grows on the ground of a forest: grass, flowers, ferns.

use super::piece::Piece;
use crate::generate::random::Random;
use crate::math::DVec3;

/// Triangles of a blade of grass.
const BLADE: u64 = 5;
/// Triangles of a flower: five petals, a middle and a stem.
const FLOWER: u64 = 7;
/// Fronds of a fern.
const FRONDS: u64 = 9;

/// How far a tuft reaches, metres.
const REACH: f64 = 0.62;

/// A place within a tuft, and how near to its edge that is, 0 to 1.
fn spot(random: &mut Random) -> (DVec3, f64) {
    let (sin, cos) = libm::sincos(random.between(0.0, std::f64::consts::TAU));
    let out = random.unit().sqrt();
    (DVec3::new(cos, 0.0, sin) * (REACH * out), out)
}

fn heading(random: &mut Random) -> DVec3 {
    let (sin, cos) = libm::sincos(random.between(0.0, std::f64::consts::TAU));
    DVec3::new(cos, 0.0, sin)
}

/// A tuft of grass of exactly so many triangles, of blades of about `high` metres.
pub fn grass(triangles: u64, high: f64, material: usize, seed: u64) -> Piece {
    let (random, mut piece) = (&mut Random::new(seed), Piece::new(material));
    let blades = (triangles / BLADE).max(1) as f64;
    // Few blades are broad: together they cover as much.
    let wide = (0.9 / (blades * high)).clamp(0.006, 0.03);
    for _ in 0..triangles / BLADE {
        blade(&mut piece, high, wide, random);
    }
    for _ in 0..triangles % BLADE {
        let ((foot, _), lean) = (spot(random), heading(random));
        let across = lean.cross(DVec3::Y) * wide;
        let (root, tip) = (DVec3::new(0.35, 0.5, 0.3), DVec3::new(0.8, 0.9, 0.5));
        let corners = [
            piece.corner(foot - across, root),
            piece.corner(foot + across, root),
            piece.corner(foot + DVec3::Y * (0.5 * high) + lean * (0.2 * high), tip),
        ];
        piece.indices.push(corners);
    }
    piece
}

fn blade(piece: &mut Piece, high: f64, wide: f64, random: &mut Random) {
    let (foot, edge) = spot(random);
    let lean = (heading(random) + foot * 0.8).normalize_or(DVec3::X);
    let high = high * random.between(0.45, 1.15) * (1.0 - 0.45 * edge * edge);
    let (bend, across) = (random.between(0.15, 0.75) * high, lean.cross(DVec3::Y) * (0.5 * wide));
    let dry = if random.chance(0.18) { random.between(0.3, 0.9) } else { 0.0 };
    let color = |share: f64| {
        let fresh = DVec3::new(0.25, 0.42, 0.16).lerp(DVec3::new(0.72, 0.95, 0.4), share);
        fresh.lerp(DVec3::new(1.0, 0.85, 0.45), dry * share)
    };
    let at = |share: f64| {
        foot + DVec3::Y * (high * share * (1.0 - 0.25 * share)) + lean * (bend * share * share)
    };
    let mut row = |share: f64, width: f64| {
        let (at, color) = (at(share), color(share));
        [piece.corner(at - across * width, color), piece.corner(at + across * width, color)]
    };
    let rows = [row(0.0, 1.0), row(0.4, 0.9), row(0.75, 0.6)];
    let tip = piece.corner(at(1.0), color(1.0));
    for pair in rows.windows(2) {
        let ([a, b], [d, c]) = (pair[0], pair[1]);
        piece.indices.extend([[a, b, c], [a, c, d]]);
    }
    piece.indices.push([rows[2][0], rows[2][1], tip]);
}

/// A tuft with flowers among the grass, of exactly so many triangles together.
pub fn flowers(triangles: u64, materials: [usize; 2], tint: DVec3, seed: u64) -> Vec<Piece> {
    let flowers = triangles / 3 / FLOWER;
    let random = &mut Random::new(seed);
    let (mut petals, mut green) = (Piece::new(materials[1]), Piece::new(materials[0]));
    for _ in 0..flowers {
        flower(&mut petals, &mut green, tint, random);
    }
    let left = triangles - flowers * FLOWER;
    let tuft = grass(left, 0.24, materials[0], seed ^ 0x51);
    let first = green.positions.len() as u32;
    green.positions.extend(tuft.positions);
    green.colors.extend(tuft.colors);
    green.indices.extend(tuft.indices.iter().map(|corners| corners.map(|i| i + first)));
    [green, petals].into_iter().filter(|piece| !piece.indices.is_empty()).collect()
}

fn flower(petals: &mut Piece, green: &mut Piece, tint: DVec3, random: &mut Random) {
    let (foot, _) = spot(random);
    let lean = heading(random);
    let head = foot + DVec3::Y * random.between(0.2, 0.42) + lean * 0.06;
    let across = lean.cross(DVec3::Y) * 0.004;
    let stem = DVec3::new(0.4, 0.6, 0.25);
    let corners = [foot - across, foot + across, head].map(|corner| green.corner(corner, stem));
    green.indices.push(corners);
    let up = (DVec3::Y + lean * random.between(0.1, 0.8)).normalize();
    let right = up.any_orthonormal_vector();
    let (side, size) = (up.cross(right), random.between(0.02, 0.034));
    for petal in 0..5 {
        let (sin, cos) = libm::sincos(f64::from(petal) * 1.2566 + 0.3);
        let out = right * cos + side * sin;
        let across = up.cross(out) * (0.55 * size);
        let tip = head + out * size;
        let corners = [head, tip - across, tip + across];
        let corners = corners.map(|corner| petals.corner(corner, tint));
        petals.indices.push(corners);
    }
    let yellow = DVec3::new(1.0, 0.72, 0.1);
    let corner = |turn: f64| {
        let (sin, cos) = libm::sincos(turn);
        head + up * 0.004 + (right * cos + side * sin) * (0.45 * size)
    };
    let corners = [0.0, 2.094, 4.189].map(|turn| petals.corner(corner(turn), yellow));
    petals.indices.push(corners);
}

/// A fern of exactly so many triangles.
pub fn fern(triangles: u64, material: usize, seed: u64) -> Piece {
    let (random, mut piece) = (&mut Random::new(seed), Piece::new(material));
    let mut fronds = Vec::new();
    for frond in 0..FRONDS {
        let turn = frond as f64 * 2.4 + random.between(-0.2, 0.2);
        let (sin, cos) = libm::sincos(turn);
        fronds.push((DVec3::new(cos, 0.0, sin), random.between(0.5, 0.85)));
    }
    let leaves = triangles.div_ceil(2);
    let pairs = leaves.div_ceil(FRONDS).div_ceil(2).max(1);
    for leaf in 0..leaves {
        let (out, long) = fronds[(leaf % FRONDS) as usize];
        let number = leaf / FRONDS;
        let share = ((number / 2) as f64 + 0.5) / pairs as f64;
        // A curve by Bézier's three points: up and out, and down again.
        let [middle, end] = [out * 0.35 + DVec3::Y * 0.8, out + DVec3::Y * 0.42];
        let at = (middle * (2.0 * share * (1.0 - share)) + end * (share * share)) * long;
        let along = (middle * (1.0 - share) + (end - middle) * share).normalize_or(out);
        let side = along.cross(DVec3::Y).normalize_or(DVec3::X);
        let side = if number.is_multiple_of(2) { side } else { -side };
        let size = long * 0.3 * libm::pow(1.0 - share, 0.75) * (6.0 * share).min(1.0) + 0.01;
        let pointing = (side + along * 0.35 - DVec3::Y * 0.15).normalize() * size;
        let wide = (0.7 * long / pairs as f64).min(0.3 * size + 0.004);
        let tint = DVec3::new(0.4, 0.65, 0.25).lerp(DVec3::new(0.8, 1.0, 0.42), share);
        let tint = tint * random.between(0.85, 1.0);
        let whole = 2 * leaf + 1 < triangles;
        piece.leaf((at, pointing), along * (0.5 * wide), DVec3::Y * 0.003, tint, whole);
    }
    piece
}
