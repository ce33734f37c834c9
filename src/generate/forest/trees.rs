//! Kinds of trees and bushes.

use super::foliage::Foliage;
use super::piece::Piece;
use super::skeleton::{Habit, Level, Skeleton};
use crate::generate::random::Random;
use crate::math::DVec3;

/// A kind of tree or bush.
#[derive(Clone, Copy, Debug)]
pub struct Woody {
    /// How it grows.
    pub habit: Habit,
    /// What leaves it has.
    pub foliage: Foliage,
    /// Stems from the ground.
    pub stems: usize,
    /// Colour of the bark at a point, relative to its material.
    pub bark: fn(DVec3) -> DVec3,
    /// Materials of bark and leaves.
    pub materials: [usize; 2],
}

/// The share of a plant's triangles that its wood may take.
const WOOD: f64 = 0.34;

impl Woody {
    /// One of exactly so many triangles: its wood and its leaves.
    pub fn grow(&self, triangles: u64, seed: u64) -> Vec<Piece> {
        let random = &mut Random::new(seed);
        let detail = (triangles as f64 / 30_000.0).sqrt().sqrt().clamp(0.4, 1.6);
        let skeleton = match self.stems {
            1 => Skeleton::grow(&self.habit, detail, random),
            stems => Skeleton::grow_stems(&self.habit, stems, detail, random),
        };
        let twigs = skeleton.twigs.clone();
        let most = (triangles as f64 * WOOD) as u64;
        let wood = skeleton.bark(most, self.materials[0], self.bark);
        let left = triangles - wood.indices.len() as u64;
        let leaves = self.foliage.grow(&twigs, left, self.materials[1], random);
        [wood, leaves].into_iter().filter(|piece| !piece.indices.is_empty()).collect()
    }
}

const PLAIN: Level = Level {
    steps: 4.0,
    sides: 3.0,
    wander: 0.12,
    rise: 0.0,
    children: 0,
    bare: 0.0,
    angle: [0.9, 0.6],
    ratio: 0.5,
    thin: 0.6,
    fan: false,
};

const BROADLEAF: &[Level] = &[
    Level {
        steps: 10.0,
        sides: 11.0,
        wander: 0.1,
        rise: 0.2,
        children: 17,
        bare: 0.24,
        angle: [1.25, 0.5],
        ratio: 0.46,
        thin: 0.62,
        ..PLAIN
    },
    Level {
        steps: 7.0,
        sides: 7.0,
        wander: 0.2,
        rise: 0.35,
        children: 9,
        bare: 0.22,
        ratio: 0.48,
        ..PLAIN
    },
    Level { wander: 0.24, rise: 0.2, children: 6, bare: 0.2, ratio: 0.5, ..PLAIN },
    Level { steps: 3.0, wander: 0.25, ..PLAIN },
];

const BIRCH: &[Level] = &[
    Level {
        steps: 14.0,
        sides: 10.0,
        wander: 0.055,
        rise: 0.25,
        children: 26,
        bare: 0.3,
        angle: [1.0, 0.5],
        ratio: 0.27,
        thin: 0.42,
        ..PLAIN
    },
    Level {
        steps: 7.0,
        sides: 5.0,
        wander: 0.1,
        rise: -0.35,
        children: 8,
        bare: 0.2,
        angle: [0.7, 0.6],
        ratio: 0.5,
        ..PLAIN
    },
    // Twigs that hang.
    Level { steps: 5.0, wander: 0.1, rise: -1.9, ..PLAIN },
];

const SPRUCE: &[Level] = &[
    Level {
        steps: 16.0,
        sides: 10.0,
        wander: 0.012,
        rise: 0.1,
        children: 130,
        bare: 0.1,
        angle: [1.85, 0.75],
        ratio: 0.23,
        thin: 0.2,
        ..PLAIN
    },
    Level {
        steps: 6.0,
        sides: 4.0,
        wander: 0.04,
        rise: 0.35,
        children: 15,
        bare: 0.12,
        angle: [0.95, 0.75],
        ratio: 0.34,
        thin: 0.4,
        fan: true,
    },
    Level { steps: 2.0, wander: 0.05, rise: -0.25, ..PLAIN },
];

const BUSH: &[Level] = &[
    Level {
        steps: 5.0,
        sides: 5.0,
        wander: 0.16,
        rise: 0.25,
        children: 8,
        bare: 0.25,
        angle: [0.9, 0.6],
        ratio: 0.45,
        ..PLAIN
    },
    Level { wander: 0.2, children: 4, bare: 0.2, ratio: 0.5, ..PLAIN },
    Level { steps: 2.0, wander: 0.2, ..PLAIN },
];

/// Widest in the middle.
fn round_crown(share: f64) -> f64 {
    libm::pow(libm::sin(std::f64::consts::PI * (0.2 + 0.74 * share)), 0.6)
}

fn tall_crown(share: f64) -> f64 {
    libm::pow(libm::sin(std::f64::consts::PI * (0.25 + 0.7 * share)), 0.8)
}

/// Widest at the foot, pointed at the top.
fn cone(share: f64) -> f64 {
    libm::pow(1.0 - share, 0.85) * 0.93 + 0.07
}

/// Darker in bands of chance.
fn plain_bark(at: DVec3) -> DVec3 {
    let band = libm::sin(at.y * 23.0 + 5.0 * libm::sin(at.x * 31.0 + at.z * 17.0));
    DVec3::splat(0.8 + 0.14 * band)
}

/// White, with dark bands, and dark at the foot and in the twigs.
fn birch_bark(at: DVec3) -> DVec3 {
    let band = libm::sin(at.y * 9.0 + 3.0 * libm::sin(at.y * 2.3));
    let away = (at.x * at.x + at.z * at.z).sqrt();
    let dark = DVec3::new(0.16, 0.12, 0.1);
    if band > 0.86 || at.y < 0.35 || away > 0.9 {
        return dark;
    }
    DVec3::new(0.95, 0.92, 0.86)
}

const OAK_LEAVES: Foliage = Foliage {
    area: 190.0,
    slender: 0.55,
    longest: 0.42,
    widest: 0.75,
    forward: 0.7,
    upward: 1.0,
    droop: 0.15,
    tints: [DVec3::new(0.3, 0.5, 0.2), DVec3::new(0.85, 1.0, 0.5)],
};

/// A broad tree; `number` tells one from the other.
pub fn oak(number: u64, materials: [usize; 2]) -> Woody {
    let height = [10.5, 12.5, 9.0][number as usize % 3];
    let habit = Habit { height, radius: 0.032 * height, levels: BROADLEAF, crown: round_crown };
    let gold = [DVec3::new(0.75, 0.4, 0.12), DVec3::new(1.0, 0.72, 0.2)];
    let tints = if number % 3 == 2 { gold } else { OAK_LEAVES.tints };
    let foliage = Foliage { tints, ..OAK_LEAVES };
    Woody { habit, foliage, stems: 1, bark: plain_bark, materials }
}

/// A slim white tree.
pub fn birch(number: u64, materials: [usize; 2]) -> Woody {
    let height = [13.0, 11.0][number as usize % 2];
    let habit = Habit { height, radius: 0.0125 * height, levels: BIRCH, crown: tall_crown };
    let foliage = Foliage {
        area: 75.0,
        slender: 0.65,
        longest: 0.3,
        upward: 0.4,
        droop: 0.6,
        tints: [DVec3::new(0.6, 0.72, 0.22), DVec3::new(1.0, 0.95, 0.4)],
        ..OAK_LEAVES
    };
    Woody { habit, foliage, stems: 1, bark: birch_bark, materials }
}

/// A conifer.
pub fn spruce(number: u64, materials: [usize; 2]) -> Woody {
    let height = [16.5, 13.0, 8.0][number as usize % 3];
    let habit = Habit { height, radius: 0.0155 * height, levels: SPRUCE, crown: cone };
    let foliage = Foliage {
        area: 11.0 * height,
        slender: 0.16,
        longest: 0.5,
        widest: 0.55,
        forward: 1.5,
        upward: 0.8,
        droop: 0.1,
        tints: [DVec3::new(0.35, 0.5, 0.35), DVec3::new(0.75, 0.95, 0.6)],
    };
    Woody { habit, foliage, stems: 1, bark: plain_bark, materials }
}

/// A bush.
pub fn bush(number: u64, materials: [usize; 2]) -> Woody {
    let height = [1.5, 1.0][number as usize % 2];
    let habit = Habit { height, radius: 0.022, levels: BUSH, crown: round_crown };
    let red = [DVec3::new(0.62, 0.2, 0.1), DVec3::new(1.0, 0.5, 0.18)];
    let foliage = Foliage {
        area: 5.0 * height * height,
        longest: 0.16,
        tints: if number % 2 == 1 { red } else { OAK_LEAVES.tints },
        ..OAK_LEAVES
    };
    Woody { habit, foliage, stems: 9, bark: plain_bark, materials }
}
