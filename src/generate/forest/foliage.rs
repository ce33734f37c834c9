//! Leaves and needles.

use super::piece::Piece;
use super::skeleton::Twig;
use crate::generate::random::Random;
use crate::math::DVec3;

/// What leaves are like. Few leaves are large and many are small: the area of all stays the same
/// while they are not too long.
#[derive(Clone, Copy, Debug)]
pub struct Foliage {
    /// Of all leaves of a plant, square metres.
    pub area: f64,
    /// Width as a share of the length.
    pub slender: f64,
    /// The longest that a leaf may be, metres.
    pub longest: f64,
    /// The widest that it then may be, as a share of its length.
    pub widest: f64,
    /// How much leaves point as their twig does.
    pub forward: f64,
    /// How much they face upwards.
    pub upward: f64,
    /// How much their tips hang.
    pub droop: f64,
    /// Two colours, between which each leaf has its own.
    pub tints: [DVec3; 2],
}

/// A direction of chance, not of unit length.
fn any_direction(random: &mut Random) -> DVec3 {
    let mut side = || random.between(-1.0, 1.0);
    DVec3::new(side(), side(), side())
}

impl Foliage {
    /// Leaves along twigs, of exactly so many triangles.
    pub fn grow(
        &self,
        twigs: &[Twig],
        triangles: u64,
        material: usize,
        random: &mut Random,
    ) -> Piece {
        let mut piece = Piece::new(material);
        let lengths: Vec<f64> = twigs.iter().map(|twig| twig.from.distance(twig.to)).collect();
        let all: f64 = lengths.iter().sum();
        let leaves = triangles.div_ceil(2);
        let share = self.area / leaves.max(1) as f64;
        let long = (2.0 * share / self.slender).sqrt().min(self.longest);
        let wide = (2.0 * share / long).min(self.widest * long);
        let (mut twig, mut passed) = (0, 0.0);
        for leaf in 0..leaves {
            let at = (leaf as f64 + random.unit()) / leaves as f64 * all;
            while twig + 1 < twigs.len() && passed + lengths[twig] < at {
                passed += lengths[twig];
                twig += 1;
            }
            let Twig { from, to } = twigs[twig];
            let place = ((at - passed) / lengths[twig].max(1e-9)).clamp(0.0, 1.0);
            let whole = 2 * leaf + 1 < triangles;
            let size = random.between(0.75, 1.25);
            self.leaf(&mut piece, (from, to), place, [long * size, wide * size], whole, random);
        }
        piece
    }

    fn leaf(
        &self,
        piece: &mut Piece,
        (from, to): (DVec3, DVec3),
        place: f64,
        [long, wide]: [f64; 2],
        whole: bool,
        random: &mut Random,
    ) {
        let twig = (to - from).normalize_or(DVec3::Y);
        let along = twig * self.forward + any_direction(random) - DVec3::Y * self.droop;
        let along = along.normalize_or(twig);
        let face = any_direction(random) + DVec3::Y * self.upward;
        let across = along.cross(face).normalize_or(along.any_orthonormal_vector());
        let lift = across.cross(along) * wide * random.between(0.05, 0.3);
        // Leaves within a crown are older and darker than those at the ends of twigs.
        let [dark, light] = self.tints;
        let tint = dark.lerp(light, (random.unit() * 0.7 + 0.3 * place).min(1.0));
        let tint = tint * random.between(0.82, 1.0);
        piece.leaf((from.lerp(to, place), along * long), across * (0.5 * wide), lift, tint, whole);
    }
}
