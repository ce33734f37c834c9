//! Tables of the light that is lost between rough glass and layers on its outside.
//!
//! From outside light is lost as over anything: what the glass reflects to where layers let less
//! through than they have let in. From inside what the layers keep of what leaves is lost, but for
//! what [`super::cover`] throws back facet by facet.
//!
//! Both are linear in the curve of what layers keep, which falls with the cosine. So a table holds,
//! for directions of view at its nodes on either side, what values of that curve are multiplied by:
//! one table does for all layers.

use std::f32::consts::FRAC_PI_2;
use std::sync::OnceLock;

use super::boundary::Boundary;
use super::energy::{locate_cell, node_alpha};
use super::form::BsdfForm;
use super::fresnel;
use super::ggx;
use super::glass_energy::{GlassRow, SLICES, each_facet, eta_of_slice, locate_slice};
use super::glass_multiple;
use super::layer_columns::{COLUMNS, Curve, column_cos, locate_column};
use super::layer_losses::BASES;
use super::params::SurfaceParams;
use super::rough_dielectric::leaving_cos;
use crate::math::Vec3;

/// Directions of view on either side.
const NODES: usize = 49;
/// Where among those inside total reflection begins: at one of them.
const EDGE: f32 = 0.5;

/// Of one alpha and one index.
#[derive(Debug)]
struct Table {
    /// Outside and inside: rows for each node, and one for the average over the hemisphere.
    sides: [Vec<Curve>; 2],
}

/// What a table is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// All that is lost, where reflectances are those of the index.
    Plain,
    /// Of that, what was scattered once.
    Once,
    /// The same, if all were reflected on the outside and all passed from inside that is not
    /// totally reflected.
    Whole,
}

/// Rough glass under layers.
#[derive(Clone, Copy, Debug)]
pub(super) struct GlassLosses {
    /// Rows by alpha with their weights.
    rows: [(usize, f32); 2],
    /// The lesser of two slices by index, and the place between them.
    slice: (usize, f32),
    boundary: Boundary,
}

/// Which side of a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Outside,
    Inside,
}

impl Side {
    /// That of a direction.
    pub fn of(w: Vec3) -> Self {
        if w.z < 0.0 { Self::Inside } else { Self::Outside }
    }

    /// The cosine of a node, or between nodes, 0 to 1; `ior` is the index inside over that outside.
    ///
    /// Inside they are dense where total reflection begins, and that is at [`EDGE`] of all indices,
    /// so that one may interpolate between these.
    fn cos_at(self, place: f32, ior: f32) -> f32 {
        let ior = ior.max(1.0);
        match self {
            Self::Outside => place * place,
            Self::Inside if place < EDGE => {
                let rest = 1.0 - place / EDGE;
                let sin = (1.0 - rest * rest) / ior;
                (1.0 - sin * sin).sqrt()
            }
            Self::Inside => {
                let cos = libm::cosf((place - EDGE) / (1.0 - EDGE) * FRAC_PI_2).max(0.0);
                critical_cos(ior) * cos * cos
            }
        }
    }

    /// The nodes between which a cosine is, and where.
    fn locate(self, cos: f32, ior: f32) -> (usize, f32) {
        let (ior, cos) = (ior.max(1.0), cos.clamp(0.0, 1.0));
        let critical = critical_cos(ior);
        let place = match self {
            Self::Outside => cos.sqrt(),
            Self::Inside if cos > critical => {
                let rest = 1.0 - ior * (1.0 - cos * cos).sqrt();
                EDGE * (1.0 - rest.max(0.0).sqrt())
            }
            Self::Inside => {
                let root = (cos / critical.max(1e-6)).min(1.0).sqrt();
                EDGE + (1.0 - EDGE) * libm::acosf(root) / FRAC_PI_2
            }
        };
        locate_cell::<NODES>(place * (NODES - 1) as f32)
    }
}

/// The cosine inside at which total reflection begins.
fn critical_cos(ior: f32) -> f32 {
    (1.0 - 1.0 / (ior * ior)).max(0.0).sqrt()
}

impl GlassLosses {
    /// Those of a boundary, which lies between two rows by alpha with their weights.
    pub fn new(boundary: &Boundary, rows: [(usize, f32); 2]) -> Self {
        Self { rows, slice: locate_slice(boundary.ior), boundary: *boundary }
    }

    /// The share of light from a direction that is lost.
    pub fn at(&self, side: Side, cos: f32, kept: &Curve) -> Vec3 {
        let (j, t) = side.locate(cos, self.boundary.ior);
        self.colored(side, Some(cos), &[(j, 1.0 - t), (j + 1, t)], kept)
    }

    /// The average of that over the hemisphere.
    pub fn average(&self, side: Side, kept: &Curve) -> Vec3 {
        self.colored(side, None, &[(NODES, 1.0)], kept)
    }

    fn colored(&self, side: Side, cos: Option<f32>, nodes: &[(usize, f32)], kept: &Curve) -> Vec3 {
        let of = |kind| self.integrate(kind, side, nodes, kept);
        let plain = of(Kind::Plain);
        let Some([constant, slope]) = self.boundary.told() else {
            return Vec3::splat(plain.max(0.0));
        };
        let once = of(Kind::Once);
        let whole = match side {
            Side::Outside => constant,
            Side::Inside => Vec3::ONE - constant - slope,
        };
        let again = Again::relative_to_plain(&self.boundary, side, cos) * (plain - once);
        (whole * of(Kind::Whole) + slope * once + again).clamp(Vec3::ZERO, Vec3::ONE)
    }

    fn integrate(&self, kind: Kind, side: Side, nodes: &[(usize, f32)], kept: &Curve) -> f32 {
        let mut factors = [0.0; COLUMNS];
        let (slice, t) = self.slice;
        for (row, row_weight) in self.rows {
            for (slice, slice_weight) in [(slice, 1.0 - t), (slice + 1, t)] {
                let table = table(kind, row, slice);
                for &(node, share) in nodes {
                    let weight = row_weight * slice_weight * share;
                    for (sum, factor) in factors.iter_mut().zip(&table.sides[side as usize][node]) {
                        *sum += weight * factor;
                    }
                }
            }
        }
        dot(&factors, kept)
    }
}

/// The sum of products, in an order that suits vectors.
pub(super) fn dot(a: &Curve, b: &Curve) -> f32 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    for (a, b) in a.chunks(LANES).zip(b.chunks(LANES)) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums.iter().sum()
}

/// What the average over the hemisphere, weighted by the cosine, multiplies by values at `M` nodes
/// between which it is linear.
fn average_weights<const M: usize>(cos: impl Fn(f32) -> f32) -> [f32; M] {
    const STEPS: usize = 16;
    let mut weights = [0.0_f64; M];
    for node in 0..M - 1 {
        for step in 0..STEPS {
            let at = |step: f32| (node as f32 + step / STEPS as f32) / (M - 1) as f32;
            let [from, to] = [step as f32, step as f32 + 1.0].map(|step| f64::from(cos(at(step))));
            let (t, share) = ((step as f64 + 0.5) / STEPS as f64, (to * to - from * from).abs());
            weights[node] += share * (1.0 - t);
            weights[node + 1] += share * t;
        }
    }
    weights.map(|weight| weight as f32)
}

/// What the average of a curve over the hemisphere multiplies it by.
pub(super) fn column_weights() -> &'static Curve {
    static WEIGHTS: OnceLock<Curve> = OnceLock::new();
    WEIGHTS.get_or_init(|| average_weights(|root| root * root))
}

/// Each is computed on first use, in some milliseconds; they take 49 KB.
static TABLES: [[[OnceLock<Table>; SLICES]; BASES]; 3] =
    [const { [const { [const { OnceLock::new() }; SLICES] }; BASES] }; 3];

fn table(kind: Kind, row: usize, slice: usize) -> &'static Table {
    let new = || Table::new(kind, node_alpha(row, BASES), eta_of_slice(slice));
    TABLES[kind as usize][row][slice].get_or_init(new)
}

/// Adds to what the curve's value at a cosine is multiplied by.
fn add(row: &mut Curve, cos: f32, share: f32) {
    let (j, t) = locate_column(cos);
    row[j] += share * (1.0 - t);
    row[j + 1] += share * t;
}

/// What comes back outside of the light that is lost between facets.
struct Again<'a> {
    boundary: &'a Boundary,
    /// Tables for light from outside and from inside.
    rows: [GlassRow; 2],
    averages: [Vec3; 2],
}

impl<'a> Again<'a> {
    fn new(boundary: &'a Boundary) -> Self {
        let rows = [boundary.ior, 1.0 / boundary.ior].map(|eta| GlassRow::of(boundary.alpha, eta));
        Self { boundary, rows, averages: rows.map(|row| boundary.loss(row.average())) }
    }

    /// The share of light from a direction, or of all light from a side.
    fn share(&self, side: Side, cos: Option<f32>) -> Vec3 {
        let (boundary, [outside, inside]) = (self.boundary, self.averages);
        let row = &self.rows[side as usize];
        let loss = boundary.loss(cos.map_or_else(|| row.average(), |cos| row.at(cos)));
        let ior = boundary.ior;
        match side {
            Side::Outside => {
                loss * (Vec3::ONE - glass_multiple::across(boundary, ior, [outside, inside]))
            }
            Side::Inside => loss * glass_multiple::across(boundary, 1.0 / ior, [inside, outside]),
        }
    }

    /// How many times as much it is as if reflectances were those of the index.
    fn relative_to_plain(boundary: &Boundary, side: Side, cos: Option<f32>) -> Vec3 {
        let plain = boundary.as_plain();
        let [found, plain] = [boundary, &plain].map(|glass| Again::new(glass).share(side, cos));
        found / plain.max(Vec3::splat(glass_multiple::LEAST_LOSS))
    }
}

/// Glass of one boundary, for which a table is computed.
struct Glass<'a> {
    kind: Kind,
    again: Again<'a>,
    /// What outside columns lose between facets, times the weight of each in the average, and over
    /// that.
    lost: Curve,
}

impl<'a> Glass<'a> {
    fn new(kind: Kind, boundary: &'a Boundary) -> Self {
        let again = Again::new(boundary);
        let average = again.averages[0].x;
        let mut lost = [0.0; COLUMNS];
        if kind == Kind::Plain && average > glass_multiple::LEAST_LOSS {
            lost = *column_weights();
            for (column, weight) in lost.iter_mut().enumerate() {
                let loss = boundary.loss(again.rows[0].at(column_cos(column))).x;
                *weight *= loss / average;
            }
        }
        Self { kind, again, lost }
    }

    fn outside(&self, cos: f32) -> Curve {
        let mut row = [0.0; COLUMNS];
        let (wo, Boundary { alpha, ior, .. }) = (direction(cos), *self.again.boundary);
        each_facet(alpha, wo, |h, weight| {
            let along = wo.dot(h);
            let there = 2.0 * along * h.z - wo.z;
            if there > 0.0 && there < wo.z {
                let (reflectance, _) = fresnel::dielectric(along, ior);
                let reflectance = if self.kind == Kind::Whole { 1.0 } else { reflectance };
                let share = weight as f32 * reflectance * self.masking(there);
                add(&mut row, there, share);
                add(&mut row, wo.z, -share);
            }
        });
        let again = self.again.share(Side::Outside, Some(cos)).x;
        for (column, lost) in self.lost.iter().enumerate() {
            if column_cos(column) < wo.z {
                row[column] += again * lost;
                add(&mut row, wo.z, -again * lost);
            }
        }
        row
    }

    fn inside(&self, cos: f32) -> Curve {
        let again = self.again.share(Side::Inside, Some(cos)).x;
        let mut row = self.lost.map(|lost| again * lost);
        let Boundary { alpha, ior, .. } = *self.again.boundary;
        let (wo, eta) = (direction(cos), 1.0 / ior);
        each_facet(alpha, wo, |h, weight| {
            let along = wo.dot(h);
            let (reflectance, cos_t) = fresnel::dielectric(along, eta);
            let leaving = |cos: f32| leaving_cos(cos, h.z, along, eta, cos_t);
            let (here, mirrored) = (leaving(wo.z), 2.0 * along * h.z - wo.z);
            if reflectance >= 1.0 || here <= 0.0 {
                return;
            }
            let passes = if self.kind == Kind::Whole { 1.0 } else { 1.0 - reflectance };
            let share = weight as f32 * passes;
            add(&mut row, here, share * self.masking(here));
            let there = leaving(mirrored);
            if mirrored > 0.0 && there > 0.0 {
                let thrown_back = self.masking(mirrored) * self.masking(here.min(there));
                add(&mut row, here.max(there), -share * thrown_back);
            }
        });
        row
    }

    fn masking(&self, cos: f32) -> f32 {
        let alpha = self.again.boundary.alpha;
        ggx::masking(cos, alpha * alpha)
    }
}

/// A direction at a cosine. At the horizon itself limits are taken from close by.
fn direction(cos: f32) -> Vec3 {
    let cos = cos.max(1e-4);
    Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}

impl Table {
    fn new(kind: Kind, alpha: f32, ior: f32) -> Self {
        let params = SurfaceParams { ior, roughness: alpha.sqrt(), ..SurfaceParams::default() };
        let boundary = Boundary::new(&params, BsdfForm::Conserving);
        let glass = Glass::new(kind, &boundary);
        let sides = [Side::Outside, Side::Inside].map(|side| {
            let cos_at = |place| side.cos_at(place, ior);
            let row = |node| {
                let cos = cos_at(node as f32 / (NODES - 1) as f32);
                match side {
                    Side::Outside => glass.outside(cos),
                    Side::Inside => glass.inside(cos),
                }
            };
            let mut rows: Vec<Curve> = (0..NODES).map(row).collect();
            let weights: [f32; NODES] = average_weights(cos_at);
            let average = std::array::from_fn(|column| {
                rows.iter().zip(weights).map(|(row, weight)| weight * row[column]).sum()
            });
            rows.push(average);
            rows
        });
        Self { sides }
    }
}
