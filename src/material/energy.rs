//! Tables of how much light microfacet lobes reflect in all, computed once by quadrature.
//!
//! A lobe of one bounce between microfacets loses what bounces twice or more. The tables tell what
//! is lost, to be added again, and what a coat reflects, to be taken from what lies below.
//!
//! Tables are indexed by the square roots of alpha and of the cosine, where the albedo is smooth
//! enough for 32 by 32 entries, and by `(eta - 1) / (eta + 1)` for glass. Averages are those of the
//! interpolated table itself, so that compensation closes to rounding wherever the table is exact.

use std::sync::{LazyLock, OnceLock};

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

fn node_alpha(row: usize, count: usize) -> f32 {
    let root = row as f32 / (count - 1) as f32;
    (root * root).max(ggx::MIN_ALPHA)
}

fn node_cos(column: usize, count: usize) -> f32 {
    let root = column as f32 / (count - 1) as f32;
    root * root
}

/// The integral of `2 cos * albedo` over the cosine, that is of `4 t³ * albedo` over its root t,
/// in which the table is piecewise linear.
fn average(row: &[Albedo; N]) -> Albedo {
    let weights = |column: usize| {
        let (a, b) = (column as f64 / (N - 1) as f64, (column + 1) as f64 / (N - 1) as f64);
        let power = |x: f64, n: i32| (0..n).fold(1.0, |product, _| product * x);
        let whole = power(b, 4) - power(a, 4);
        let moment = 0.8 * (power(b, 5) - power(a, 5));
        let right = (moment - a * whole) / (b - a);
        (whole - right, right)
    };
    let (mut f0, mut f90) = (0.0, 0.0);
    for column in 0..N - 1 {
        let (left, right) = weights(column);
        f0 += left * f64::from(row[column].f0) + right * f64::from(row[column + 1].f0);
        f90 += left * f64::from(row[column].f90) + right * f64::from(row[column + 1].f90);
    }
    Albedo { f0: f0 as f32, f90: f90 as f32 }
}

/// The mean of `value` over the normals that `wo` sees.
fn mean_over_visible_normals(wo: Vec3, alpha: f32, value: impl Fn(Vec3) -> Albedo) -> Albedo {
    // Half a turn will do, by symmetry.
    const TURNS: usize = 12;
    const CAPS: usize = 40;
    let (mut f0, mut f90) = (0.0_f64, 0.0_f64);
    for cap in 0..CAPS {
        // Dense in the distribution's tail, where lobes meet the horizon.
        let rest = (cap as f32 + 0.5) / CAPS as f32;
        let weight = f64::from(2.0 * rest) / (CAPS * TURNS) as f64;
        for turn in 0..TURNS {
            let x = 0.5 * (turn as f32 + 0.5) / TURNS as f32;
            let u = Vec2::new(x, 1.0 - rest * rest);
            let Albedo { f0: a, f90: b } = value(ggx::sample_visible_normal(wo, alpha, u));
            f0 += weight * f64::from(a);
            f90 += weight * f64::from(b);
        }
    }
    Albedo { f0: f0 as f32, f90: f90 as f32 }
}

fn reflection_albedo(alpha: f32, cos: f32) -> Albedo {
    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    mean_over_visible_normals(wo, alpha, |h| {
        let along = wo.dot(h);
        let visible = ggx::masking((2.0 * along * h.z - wo.z).max(0.0), alpha * alpha);
        let weight = fresnel::schlick_weight(along);
        Albedo { f0: visible * (1.0 - weight), f90: visible * weight }
    })
}

/// Entries of a [`Slice`] along each axis.
const G: usize = 16;
/// Slices, over `(eta - 1) / (eta + 1)` from -1/2 (an index of 1/3) to 1 (infinity).
const SLICES: usize = 49;
const SLICES_PER_UNIT: f32 = 32.0;

/// The albedo of one bounce on rough, colourless glass: what it reflects and what it transmits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GlassAlbedo {
    /// With the reflectances of its index.
    pub exact: f32,
    /// If all light passed that is not totally reflected.
    clear: f32,
    /// What is added to that if all of it were reflected instead.
    mirrored: f32,
}

impl GlassAlbedo {
    /// The albedo where a facet reflects `constant + slope * F` instead of F, the reflectance of
    /// the index. Total reflection stays total.
    pub fn of(self, constant: f32, slope: f32) -> f32 {
        self.clear + constant * self.mirrored + slope * (self.exact - self.clear)
    }

    fn mix(self, other: Self, t: f32) -> Self {
        let lerp = |a: f32, b: f32| a + (b - a) * t;
        Self {
            exact: lerp(self.exact, other.exact),
            clear: lerp(self.clear, other.clear),
            mirrored: lerp(self.mirrored, other.mirrored),
        }
    }
}

/// Those of one index: by roughness, then by cosine.
type Slice = [[GlassAlbedo; G]; G];

/// Each is computed on first use: a scene's few kinds of glass need few of them.
static GLASS: [OnceLock<Box<Slice>>; SLICES] = [const { OnceLock::new() }; SLICES];

fn glass_slice(index: usize) -> &'static Slice {
    GLASS[index].get_or_init(|| {
        let ratio = (index as f32 / SLICES_PER_UNIT - 0.5).min(0.9999);
        let eta = (1.0 + ratio) / (1.0 - ratio);
        Box::new(std::array::from_fn(|row| {
            let alpha = node_alpha(row, G);
            std::array::from_fn(|column| glass_albedo(alpha, node_cos(column, G), eta))
        }))
    })
}

/// The albedo of rough glass for a direction of cosine `cos`; `eta` is the index behind over that
/// before the boundary.
pub fn rough_glass(alpha: f32, cos: f32, eta: f32) -> GlassAlbedo {
    let ratio = (eta - 1.0) / (eta + 1.0);
    let (k, index_t) = locate_cell::<SLICES>(((ratio + 0.5) * SLICES_PER_UNIT).max(0.0));
    let (i, row_t) = locate_cell::<G>(alpha.sqrt() * (G - 1) as f32);
    let (j, column_t) = locate_cell::<G>(cos.sqrt() * (G - 1) as f32);
    let at = |slice: &Slice| {
        let row = |row: &[GlassAlbedo; G]| row[j].mix(row[j + 1], column_t);
        row(&slice[i]).mix(row(&slice[i + 1]), row_t)
    };
    at(glass_slice(k)).mix(at(glass_slice(k + 1)), index_t)
}

fn glass_albedo(alpha: f32, cos: f32, eta: f32) -> GlassAlbedo {
    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    // A facet's reflectance, and what is left of what it reflects and of what it refracts.
    let facet = |h: Vec3| {
        let along = wo.dot(h);
        let (reflectance, cos_t) = fresnel::dielectric(along, eta);
        let masking = |cos: f32| ggx::masking(cos.max(0.0), alpha * alpha);
        let reflected = masking(2.0 * along * h.z - wo.z);
        (reflectance, reflected, masking(wo.z / eta - (along / eta - cos_t) * h.z))
    };
    let exact = mean_over_visible_normals(wo, alpha, |h| {
        let (reflectance, reflected, refracted) = facet(h);
        Albedo { f0: reflectance * reflected, f90: (1.0 - reflectance) * refracted }
    });
    let ends = mean_over_visible_normals(wo, alpha, |h| match facet(h) {
        (reflectance, reflected, _) if reflectance >= 1.0 => Albedo { f0: reflected, f90: 0.0 },
        (_, reflected, refracted) => Albedo { f0: refracted, f90: reflected - refracted },
    });
    GlassAlbedo { exact: exact.f0 + exact.f90, clear: ends.f0, mirrored: ends.f90 }
}
