//! The kinds of things in a forest, and how many triangles each has.

use serde_json::Value;

use super::herbs;
use super::piece::Piece;
use super::stone::stone;
use super::trees::{birch, bush, oak, spruce};
use crate::generate::material::plain;
use crate::math::DVec3;

/// What grows in which surroundings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Sort {
    /// A broad tree.
    Oak,
    /// A slim tree.
    Birch,
    /// A conifer.
    Spruce,
    /// A bush.
    Bush,
    /// A fern.
    Fern,
    /// Grass with flowers.
    Flowers,
    /// Grass.
    Grass,
    /// A stone.
    Stone,
}

/// A kind: of its sort the first, the second, and so on.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// What it is.
    pub sort: Sort,
    /// Which of its sort.
    pub number: u64,
    /// Triangles that it has.
    pub triangles: u64,
}

/// Of each sort how many kinds there are, and the share of the triangles that each has.
const SORTS: [(Sort, u64, u64); 8] = [
    (Sort::Oak, 3, 120),
    (Sort::Birch, 2, 90),
    (Sort::Spruce, 3, 140),
    (Sort::Bush, 2, 30),
    (Sort::Fern, 2, 12),
    (Sort::Flowers, 2, 10),
    (Sort::Grass, 3, 10),
    (Sort::Stone, 3, 8),
];

/// The ground's share of the triangles.
const GROUND: u64 = 90;

/// Materials by their place in the list.
const SOIL: usize = 0;
const BARK: usize = 1;
const BIRCH_BARK: usize = 2;
const LEAF: usize = 3;
const NEEDLE: usize = 4;
const HERB: usize = 5;
const PETAL: usize = 6;
const ROCK: usize = 7;

/// glTF's materials; colours of vertices multiply theirs.
pub fn materials() -> Vec<Value> {
    let mut all = vec![
        plain("soil", [0.3, 0.29, 0.27], 0.0, 0.95),
        plain("bark", [0.2, 0.145, 0.1], 0.0, 0.9),
        plain("birch bark", [0.78, 0.76, 0.72], 0.0, 0.7),
        plain("leaf", [0.24, 0.33, 0.075], 0.0, 0.55),
        plain("needle", [0.16, 0.24, 0.1], 0.0, 0.6),
        plain("herb", [0.2, 0.3, 0.055], 0.0, 0.6),
        plain("petal", [0.85, 0.85, 0.85], 0.0, 0.7),
        plain("stone", [0.5, 0.5, 0.5], 0.0, 0.85),
    ];
    for leaf in [LEAF, NEEDLE, HERB, PETAL] {
        all[leaf]["doubleSided"] = true.into();
    }
    all
}

/// The material of the ground.
pub const fn ground_material() -> usize {
    SOIL
}

/// The kinds of a forest of so many unique triangles, and how many are left for the ground.
pub fn kinds(triangles: u64) -> (Vec<Kind>, u64) {
    let all: u64 = SORTS.iter().map(|(_, count, share)| count * share).sum::<u64>() + GROUND;
    let share = |share: u64| (u128::from(triangles) * u128::from(share) / u128::from(all)) as u64;
    let mut kinds = Vec::new();
    for (sort, count, own) in SORTS {
        kinds.extend((0..count).map(|number| Kind { sort, number, triangles: share(own) }));
    }
    (kinds, share(GROUND))
}

impl Kind {
    /// Its triangles.
    pub fn build(&self, seed: u64) -> Vec<Piece> {
        let Self { sort, number, triangles } = *self;
        let seed = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(sort as u64 * 64 + number);
        match sort {
            Sort::Oak => oak(number, [BARK, LEAF]).grow(triangles, seed),
            Sort::Birch => birch(number, [BIRCH_BARK, LEAF]).grow(triangles, seed),
            Sort::Spruce => spruce(number, [BARK, NEEDLE]).grow(triangles, seed),
            Sort::Bush => bush(number, [BARK, LEAF]).grow(triangles, seed),
            Sort::Fern => vec![herbs::fern(triangles, HERB, seed)],
            Sort::Flowers => {
                let violet = DVec3::new(0.42, 0.3, 0.85);
                let tint = [DVec3::new(0.95, 0.95, 0.92), violet][number as usize % 2];
                herbs::flowers(triangles, [HERB, PETAL], tint, seed)
            }
            Sort::Grass => {
                let high = [0.42, 0.3, 0.22][number as usize % 3];
                vec![herbs::grass(triangles, high, HERB, seed)]
            }
            Sort::Stone => vec![stone(triangles, ROCK, seed)],
        }
    }

    /// Whether it can have any number of triangles.
    pub fn is_exact(&self) -> bool {
        self.sort != Sort::Stone
    }
}
