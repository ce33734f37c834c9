//! Tables of how much light microfacet lobes reflect in all, computed once by quadrature.
//!
//! A lobe of one bounce between microfacets loses what bounces twice or more. The tables tell what
//! is lost, to be added again, and what a coat reflects, to be taken from what lies below.
//!
//! Tables are indexed by the square roots of alpha and of the cosine, where the albedo is smooth
//! enough for 32 by 32 entries; those of glass stand in [`super::glass_energy`]. Averages are
//! those of the interpolated table itself, so that compensation closes to rounding wherever the
//! table is exact.

use std::sync::LazyLock;

use super::{fresnel, ggx};
use crate::math::{Vec2, Vec3};

/// Entries along each axis of [`Albedos`].
const N: usize = 32;

/// Directional albedos of the GGX reflection lobe under Schlick's Fresnel term.
pub struct Albedos {
    /// By roughness, then by cosine.
    cells: [[Albedo; N]; N],
    /// Of each row: the cosine-weighted average over the hemisphere.
    averages: [Albedo; N],
}

/// The albedo as a linear function of `f0` and `f90`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Albedo {
    /// Factor of `f0`.
    pub f0: f32,
    /// Factor of `f90`.
    pub f90: f32,
}

impl Albedo {
    /// The lobe's albedo for grey `f0` and `f90`.
    #[inline]
    pub fn of(self, f0: f32, f90: f32) -> f32 {
        f0 * self.f0 + f90 * self.f90
    }

    /// The share that a white lobe loses; at least zero.
    #[inline]
    pub fn loss(self) -> f32 {
        (1.0 - self.f0 - self.f90).max(0.0)
    }

    /// Linear interpolation.
    #[inline]
    pub fn mix(self, other: Self, t: f32) -> Self {
        Self { f0: self.f0 + (other.f0 - self.f0) * t, f90: self.f90 + (other.f90 - self.f90) * t }
    }
}

/// An alpha's position between two rows of [`Albedos`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row(f32);

impl Row {
    /// The position of `alpha`.
    #[inline]
    pub fn of(alpha: f32) -> Self {
        Self(alpha.sqrt() * (N - 1) as f32)
    }

    /// The position, in rows.
    #[inline]
    pub fn place(self) -> f32 {
        self.0
    }
}

static ALBEDOS: LazyLock<Box<Albedos>> = LazyLock::new(|| Box::new(Albedos::compute()));

impl Albedos {
    /// Entries along each axis.
    pub const SIDE: usize = N;

    /// `f0` and `f90` of an entry, counted along the rows, and of the next.
    #[inline(always)]
    pub fn pair(&self, place: usize) -> [f32; 4] {
        let cells = self.cells.as_flattened();
        let (a, b) = (cells[place], cells[place + 1]);
        [a.f0, a.f90, b.f0, b.f90]
    }

    /// The table. The first call computes it.
    #[inline]
    pub fn get() -> &'static Self {
        &ALBEDOS
    }

    /// The albedo seen from a direction of that cosine.
    #[inline]
    pub fn at(&self, row: Row, cos: f32) -> Albedo {
        let (i, row_t) = locate_cell::<N>(row.0);
        let (j, t) = locate_cell::<N>(cos.sqrt() * (N - 1) as f32);
        let (below, above) = (&self.cells[i], &self.cells[i + 1]);
        let below = below[j].mix(below[j + 1], t);
        below.mix(above[j].mix(above[j + 1], t), row_t)
    }

    /// The albedo under light from all directions alike.
    #[inline]
    pub fn average(&self, row: Row) -> Albedo {
        let (i, t) = locate_cell::<N>(row.0);
        self.averages[i].mix(self.averages[i + 1], t)
    }

    fn compute() -> Self {
        let cells: [[Albedo; N]; N] = std::array::from_fn(|row| {
            let alpha = node_alpha(row, N);
            std::array::from_fn(|column| reflection_albedo(alpha, node_cos(column, N)))
        });
        Self { averages: cells.map(|row| average(&row)), cells }
    }
}

/// The interval of an axis of `M` entries that holds `x`, and the position in it, 0 to 1.
#[inline]
pub fn locate_cell<const M: usize>(x: f32) -> (usize, f32) {
    // Through i32, the one conversion that is one instruction.
    let index = (x as i32).clamp(0, M as i32 - 2);
    (index as usize, (x - index as f32).min(1.0))
}

pub(super) fn node_alpha(row: usize, count: usize) -> f32 {
    let root = row as f32 / (count - 1) as f32;
    (root * root).max(ggx::MIN_ALPHA)
}

pub(super) fn node_cos(column: usize, count: usize) -> f32 {
    let root = column as f32 / (count - 1) as f32;
    root * root
}

fn average(row: &[Albedo; N]) -> Albedo {
    let [f0, f90] = cosine_average::<N, 2>(|column| [row[column].f0, row[column].f90]);
    Albedo { f0, f90 }
}

/// The averages over the hemisphere, weighted by the cosine, of `K` values that are linear between
/// `M` columns, at even distances by the root of the cosine.
///
/// The integral of `2 cos * value` over the cosine is that of `4 t³ * value` over its root t.
pub(super) fn cosine_average<const M: usize, const K: usize>(
    values: impl Fn(usize) -> [f32; K],
) -> [f32; K] {
    let weights = |column: usize| {
        let (a, b) = (column as f64 / (M - 1) as f64, (column + 1) as f64 / (M - 1) as f64);
        let power = |x: f64, n: i32| (0..n).fold(1.0, |product, _| product * x);
        let whole = power(b, 4) - power(a, 4);
        let moment = 0.8 * (power(b, 5) - power(a, 5));
        let right = (moment - a * whole) / (b - a);
        (whole - right, right)
    };
    let mut sums = [0.0; K];
    for column in 0..M - 1 {
        let (left, right) = weights(column);
        let (here, next) = (values(column), values(column + 1));
        for (sum, (here, next)) in sums.iter_mut().zip(here.into_iter().zip(next)) {
            *sum += left * f64::from(here) + right * f64::from(next);
        }
    }
    sums.map(|sum| sum as f32)
}

/// Calls `put` with the cosines of directions into which microfacets reflect light from `wo`, the
/// weight of each, and the share of light that is reflected so and not masked. The weights add up
/// to one.
pub(super) fn each_reflection(alpha: f32, wo: Vec3, mut put: impl FnMut(f32, f64, Albedo)) {
    // Half a turn will do, by symmetry.
    const TURNS: usize = 12;
    const CAPS: usize = 40;
    for cap in 0..CAPS {
        // Dense in the distribution's tail, where lobes meet the horizon.
        let rest = (cap as f32 + 0.5) / CAPS as f32;
        let weight = f64::from(2.0 * rest) / (CAPS * TURNS) as f64;
        for turn in 0..TURNS {
            let x = 0.5 * (turn as f32 + 0.5) / TURNS as f32;
            let h = ggx::sample_visible_normal(wo, alpha, Vec2::new(x, 1.0 - rest * rest));
            let along = wo.dot(h);
            let cos = (2.0 * along * h.z - wo.z).max(0.0);
            let visible = ggx::masking(cos, alpha * alpha);
            let fresnel = fresnel::schlick_weight(along);
            let albedo = Albedo { f0: visible * (1.0 - fresnel), f90: visible * fresnel };
            put(cos, weight, albedo);
        }
    }
}

fn reflection_albedo(alpha: f32, cos: f32) -> Albedo {
    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let (mut f0, mut f90) = (0.0_f64, 0.0_f64);
    each_reflection(alpha, wo, |_, weight, albedo| {
        f0 += weight * f64::from(albedo.f0);
        f90 += weight * f64::from(albedo.f90);
    });
    Albedo { f0: f0 as f32, f90: f90 as f32 }
}
