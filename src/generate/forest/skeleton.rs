//! Trunks, boughs and twigs: shoots that grow from shoots, level by level, as in J. Weber and
//! J. Penn, "Creation and rendering of realistic trees" (1995), with fewer parameters.

use super::piece::Piece;
use crate::generate::random::Random;
use crate::math::{DQuat, DVec3};

/// From one child to the next around its parent: what divides a circle most evenly.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// How shoots of a level grow.
#[derive(Clone, Copy, Debug)]
pub struct Level {
    /// Pieces of a shoot, where there are triangles enough.
    pub steps: f64,
    /// Sides of its section, likewise.
    pub sides: f64,
    /// How much its direction changes by chance from piece to piece.
    pub wander: f64,
    /// How much it turns upwards, or below zero downwards.
    pub rise: f64,
    /// Shoots that grow from it.
    pub children: usize,
    /// The share of its length before the first of these.
    pub bare: f64,
    /// Angle between it and its first child, and its last, radians.
    pub angle: [f64; 2],
    /// Length of a child as a share of its own.
    pub ratio: f64,
    /// Radius of a child as a share of its own there.
    pub thin: f64,
    /// Whether children grow to the left and the right alone.
    pub fan: bool,
}

/// How a plant grows.
#[derive(Clone, Copy, Debug)]
pub struct Habit {
    /// Of the trunk, metres.
    pub height: f64,
    /// Of the trunk at its foot, metres.
    pub radius: f64,
    /// From the trunk outwards; shoots of the last level are twigs.
    pub levels: &'static [Level],
    /// Length of the boughs by the share of the crown below them.
    pub crown: fn(f64) -> f64,
}

/// A shoot as it is drawn.
#[derive(Clone, Debug)]
pub struct Limb {
    points: Vec<DVec3>,
    /// At the foot; it tapers to a point.
    radius: f64,
    sides: usize,
}

/// What leaves grow from.
#[derive(Clone, Copy, Debug)]
pub struct Twig {
    /// Where it begins.
    pub from: DVec3,
    /// Where it ends.
    pub to: DVec3,
}

/// A plant without its leaves.
#[derive(Clone, Debug, Default)]
pub struct Skeleton {
    limbs: Vec<Limb>,
    /// Where leaves are.
    pub twigs: Vec<Twig>,
}

/// A shoot about to grow.
#[derive(Clone, Copy)]
struct Bud {
    at: DVec3,
    along: DVec3,
    length: f64,
    radius: f64,
    level: usize,
}

impl Skeleton {
    /// Grows a plant at the origin; `detail` is how finely, about 1.
    pub fn grow(habit: &Habit, detail: f64, random: &mut Random) -> Self {
        let mut grown = Self::default();
        let lean = DVec3::new(random.between(-0.06, 0.06), 1.0, random.between(-0.06, 0.06));
        let trunk = Bud {
            at: DVec3::new(0.0, -0.04 * habit.height, 0.0),
            along: lean.normalize(),
            length: habit.height * 1.04,
            radius: habit.radius,
            level: 0,
        };
        grown.shoot(habit, detail, trunk, random);
        grown
    }

    /// Adds stems that stand around the origin, each as a plant of its own.
    pub fn grow_stems(habit: &Habit, stems: usize, detail: f64, random: &mut Random) -> Self {
        let mut grown = Self::default();
        for stem in 0..stems {
            let (sin, cos) = libm::sincos(stem as f64 * GOLDEN_ANGLE);
            let out = DVec3::new(cos, 0.0, sin);
            let bud = Bud {
                at: out * random.between(0.02, 0.2) - DVec3::Y * 0.06,
                along: (DVec3::Y + out * random.between(0.15, 0.75)).normalize(),
                length: habit.height * random.between(0.7, 1.1),
                radius: habit.radius,
                level: 0,
            };
            grown.shoot(habit, detail, bud, random);
        }
        grown
    }

    fn shoot(&mut self, habit: &Habit, detail: f64, bud: Bud, random: &mut Random) {
        let level = habit.levels[bud.level];
        let steps = ((level.steps * detail) as usize).max(2);
        let points = bend(&bud, &level, steps, random);
        let is_last = bud.level + 1 == habit.levels.len();
        if is_last {
            let pairs = points.windows(2);
            self.twigs.extend(pairs.map(|pair| Twig { from: pair[0], to: pair[1] }));
        }
        let spin = random.between(0.0, 6.0);
        for child in 0..if is_last { 0 } else { level.children } {
            let share = (child as f64 + random.between(0.2, 0.8)) / level.children as f64;
            let (at, along) = on(&points, level.bare + (1.0 - level.bare) * share);
            let crown = if bud.level == 0 { (habit.crown)(share) } else { 1.0 - 0.55 * share };
            let angle = level.angle[0] + (level.angle[1] - level.angle[0]) * share;
            let angle = angle + random.between(-0.12, 0.12);
            let around = spin + child as f64 * GOLDEN_ANGLE + random.between(-0.3, 0.3);
            let out = if level.fan {
                let side = along.cross(DVec3::Y).normalize_or(DVec3::X);
                (if child.is_multiple_of(2) { side } else { -side })
                    + DVec3::Y * random.between(-0.2, 0.1)
            } else {
                DQuat::from_axis_angle(along, around) * along.any_orthonormal_vector()
            };
            let (sin, cos) = libm::sincos(angle);
            let next = Bud {
                at,
                along: (along * cos + out.normalize() * sin).normalize(),
                length: bud.length * level.ratio * crown * random.between(0.75, 1.15),
                radius: bud.radius * level.thin * (1.0 - 0.6 * share),
                level: bud.level + 1,
            };
            self.shoot(habit, detail, next, random);
        }
        let sides = ((level.sides * detail) as usize).max(3);
        self.limbs.push(Limb { points, radius: bud.radius, sides });
    }

    /// The limbs as tapered tubes of at most `most` triangles, the thickest first.
    pub fn bark(mut self, most: u64, material: usize, color: fn(DVec3) -> DVec3) -> Piece {
        let mut piece = Piece::new(material);
        self.limbs.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        let mut left = most;
        for limb in &self.limbs {
            let count = limb.count();
            if count > left {
                break;
            }
            left -= count;
            limb.draw(&mut piece, color);
        }
        piece
    }
}

/// The points of a shoot.
fn bend(bud: &Bud, level: &Level, steps: usize, random: &mut Random) -> Vec<DVec3> {
    let (mut at, mut along) = (bud.at, bud.along);
    let mut points = vec![at];
    for _ in 0..steps {
        let mut side = || random.between(-level.wander, level.wander);
        let wander = DVec3::new(side(), side(), side());
        let share = 1.0 / steps as f64;
        along = (along + wander + DVec3::Y * level.rise * share).normalize_or(DVec3::Y);
        at += along * bud.length * share;
        points.push(at);
    }
    points
}

/// A point of a line of points by its share of the length, and the direction there.
fn on(points: &[DVec3], share: f64) -> (DVec3, DVec3) {
    let place = share.clamp(0.0, 1.0) * (points.len() - 1) as f64;
    let piece = (place as usize).min(points.len() - 2);
    let (from, to) = (points[piece], points[piece + 1]);
    (from.lerp(to, place - piece as f64), (to - from).normalize_or(DVec3::Y))
}

impl Limb {
    fn count(&self) -> u64 {
        (self.sides * (2 * (self.points.len() - 2) + 1)) as u64
    }

    fn draw(&self, piece: &mut Piece, color: fn(DVec3) -> DVec3) {
        let last = self.points.len() - 1;
        let mut across = DVec3::X;
        let mut rings: Vec<Vec<u32>> = Vec::with_capacity(last);
        for (i, &at) in self.points[..last].iter().enumerate() {
            let along = (self.points[i + 1] - at).normalize_or(DVec3::Y);
            across =
                (across - along * along.dot(across)).normalize_or(along.any_orthonormal_vector());
            let side = along.cross(across);
            let share = i as f64 / last as f64;
            // Wider where it leaves its parent, as roots and collars are.
            let collar = if i == 0 { 1.25 } else { 1.0 };
            let radius = self.radius * collar * (1.0 - 0.8 * share);
            let corner = |k: usize| {
                let turn = std::f64::consts::TAU * k as f64 / self.sides as f64;
                let (sin, cos) = libm::sincos(turn);
                let out = across * cos + side * sin;
                piece.smooth_corner(at + out * radius, out, color(at))
            };
            rings.push((0..self.sides).map(corner).collect());
        }
        let end = self.points[last];
        let along = (end - self.points[last - 1]).normalize_or(DVec3::Y);
        let tip = piece.smooth_corner(end, along, color(end));
        let next = |k: usize| (k + 1) % self.sides;
        for pair in rings.windows(2) {
            for k in 0..self.sides {
                let (a, b) = (pair[0][k], pair[0][next(k)]);
                let (c, d) = (pair[1][next(k)], pair[1][k]);
                piece.indices.extend([[a, b, c], [a, c, d]]);
            }
        }
        let ring = &rings[last - 1];
        piece.indices.extend((0..self.sides).map(|k| [ring[k], ring[next(k)], tip]));
    }
}
