//! Where the copies stand.
//!
//! Points are those of the sequence R2 (M. Roberts, "The unreasonable effectiveness of
//! quasirandom sequences", 2018), laid around the glade: evenly apart, however many there are.
//! Noise thins them out into clearings and gathers trees of a sort in groves.

use super::kinds::{Kind, Sort};
use super::land::{Land, trail};
use crate::generate::ground::noise;
use crate::generate::random::Random;
use crate::math::{DQuat, DVec2, DVec3};

/// Where a copy stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Its foot, metres.
    pub at: [f32; 3],
    /// A quaternion, as normalised 16-bit numbers.
    pub turn: [i16; 4],
    /// Of all its sides.
    pub scale: f32,
}

/// What is spread by one rule: its share of all copies, of a thousand; square metres for each
/// copy; how far from the middle of the trail it stays, metres.
struct Layer {
    share: u64,
    room: f64,
    from_trail: f64,
    sorts: &'static [Sort],
}

const LAYERS: [Layer; 5] = [
    Layer {
        share: 90,
        room: 24.0,
        from_trail: 2.7,
        sorts: &[Sort::Oak, Sort::Birch, Sort::Spruce],
    },
    Layer { share: 60, room: 22.0, from_trail: 1.9, sorts: &[Sort::Bush] },
    Layer { share: 130, room: 4.5, from_trail: 0.9, sorts: &[Sort::Fern, Sort::Flowers] },
    Layer { share: 40, room: 12.0, from_trail: 0.8, sorts: &[Sort::Stone] },
    // All that is left.
    Layer { share: 680, room: 0.45, from_trail: 0.42, sorts: &[Sort::Grass] },
];

/// Where the camera stands at first: nothing high stands between it and the trail.
pub const EYE: DVec2 = DVec2::new(1.1, 15.0);

/// How far the trees reach, metres, of so many copies.
pub fn reach(copies: u64) -> f64 {
    let trees = (copies * LAYERS[0].share / 1000).max(1) as f64;
    (trees * LAYERS[0].room / std::f64::consts::PI).sqrt() + 12.0
}

/// Of each kind where its copies stand; there are `copies` in all.
pub fn spread(kinds: &[Kind], copies: u64, land: &Land, seed: u64) -> Vec<Vec<Stand>> {
    let mut stands: Vec<Vec<Stand>> = vec![Vec::new(); kinds.len()];
    let mut left = copies;
    for (number, layer) in LAYERS.iter().enumerate() {
        let is_last = number + 1 == LAYERS.len();
        let count = if is_last { left } else { copies * layer.share / 1000 };
        left -= count;
        let mut random = Random::new(seed ^ (0x5eed << number));
        let radius = (count as f64 * layer.room / std::f64::consts::PI).sqrt();
        for point in layer.points(count, radius, seed) {
            let kind = layer.kind(kinds, point, seed, &mut random);
            let stand = stand(kinds[kind].sort, point, land, &mut random);
            stands[kind].push(stand);
        }
    }
    stands
}

impl Layer {
    /// So many points within about a radius of the glade.
    fn points(&self, count: u64, radius: f64, seed: u64) -> impl Iterator<Item = DVec2> + '_ {
        let start = Random::new(seed ^ self.share).unit();
        let mut tried = 0_u64;
        // A third is refused.
        let radius = 1.2 * radius + self.from_trail;
        (0..count).map(move |_| {
            loop {
                tried += 1;
                let fraction = |step: f64| (start + tried as f64 * step).fract();
                let out = fraction(0.754_877_666_246_692_7);
                let turn = fraction(0.569_840_290_998_053_2) * std::f64::consts::TAU;
                // The first round fills the disc; later ones go on outside of it.
                let rounds = tried as f64 / (1.5 * count as f64 + 8.0);
                let away = radius * (out * rounds.max(1.0)).sqrt();
                let (sin, cos) = libm::sincos(turn);
                let point = DVec2::new(away * cos, 4.0 + away * sin);
                if self.takes(point, seed) {
                    return point;
                }
            }
        })
    }

    /// Whether something may stand at a point.
    fn takes(&self, point: DVec2, seed: u64) -> bool {
        let DVec2 { x, y: z } = point;
        let edge = 1.0 + 0.35 * noise(seed ^ 0x77, x / 3.1, z / 3.1);
        let beside = (x - trail(z)).abs();
        let near = point.distance(EYE);
        let high = self.room > 20.0;
        // The glade is about the camera and before it.
        let glade = DVec2::new(x / 6.5, (z - 9.0) / 11.0).length();
        if beside < self.from_trail * edge || near < 1.3 || (high && glade < 1.0) {
            return false;
        }
        let clearing = noise(seed ^ 0x91, x / 23.0, z / 23.0);
        match self.sorts[0] {
            Sort::Oak => clearing > -0.6,
            Sort::Fern | Sort::Bush => noise(seed ^ 0x35, x / 5.0, z / 5.0) > -0.25,
            Sort::Stone => noise(seed ^ 0x53, x / 8.0, z / 8.0) > 0.0,
            _ => true,
        }
    }

    /// What stands at a point.
    fn kind(&self, kinds: &[Kind], point: DVec2, seed: u64, random: &mut Random) -> usize {
        let grove = noise(seed ^ 0xa7, point.x / 17.0, point.y / 17.0);
        let grove = grove + random.between(-0.3, 0.3);
        let sort = match self.sorts {
            [only] => *only,
            [first, second] => {
                if grove > 0.1 {
                    *first
                } else {
                    *second
                }
            }
            [oak, birch, spruce, ..] => {
                if grove > 0.08 {
                    *spruce
                } else if grove < -0.25 {
                    *birch
                } else {
                    *oak
                }
            }
            [] => Sort::Grass,
        };
        let first = kinds.iter().position(|kind| kind.sort == sort).unwrap_or(0);
        let count = kinds[first..].iter().take_while(|kind| kind.sort == sort).count();
        first + random.below(count.max(1))
    }
}

fn stand(sort: Sort, point: DVec2, land: &Land, random: &mut Random) -> Stand {
    let DVec2 { x, y: z } = point;
    // How much it follows the slope, its tilt by chance, its scale, and how deep it stands.
    let (slope, tilt, [small, large], depth) = match sort {
        Sort::Oak | Sort::Birch | Sort::Spruce => (0.1, 0.035, [0.7, 1.2], 0.05),
        Sort::Bush => (0.3, 0.1, [0.6, 1.3], 0.03),
        Sort::Fern => (0.6, 0.1, [0.55, 1.15], 0.01),
        Sort::Flowers | Sort::Grass => (1.0, 0.05, [0.75, 1.25], 0.015),
        Sort::Stone => (0.7, 0.3, [0.15, 1.0], 0.0),
    };
    let up = DVec3::Y.lerp(land.normal(x, z), slope);
    let mut side = || random.between(-tilt, tilt);
    let up = (up + DVec3::new(side(), 0.0, side())).normalize();
    let turn = DQuat::from_rotation_arc(DVec3::Y, up)
        * DQuat::from_rotation_y(random.between(0.0, std::f64::consts::TAU));
    let share = random.unit();
    // Large stones are rare.
    let share = if sort == Sort::Stone { share * share * share } else { share };
    let scale = small + (large - small) * share;
    let at = DVec3::new(x, land.height(x, z) - depth * scale, z);
    let short = |number: f64| (number * 32767.0).round() as i16;
    Stand { at: at.as_vec3().to_array(), turn: turn.to_array().map(short), scale: scale as f32 }
}
