//! Tables of how much light rough glass reflects and transmits in all, by one bounce between its
//! microfacets; see [`super::energy`].
//!
//! Besides the roots of alpha and of the cosine, a table is indexed by `(eta - 1) / (eta + 1)`.

use std::sync::OnceLock;

use super::energy::{cosine_average, locate_cell, node_alpha, node_cos};
use super::{fresnel, ggx};
use crate::math::{Vec2, Vec3};

/// Entries of a [`Slice`] along each axis.
const G: usize = 32;
/// Slices, over `(eta - 1) / (eta + 1)` from -1/2 (an index of 1/3) to 1 (infinity).
pub(super) const SLICES: usize = 97;
const SLICES_PER_UNIT: f32 = 64.0;

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

    fn parts(self) -> [f32; 3] {
        [self.exact, self.clear, self.mirrored]
    }
}

/// Those of one index.
struct Slice {
    /// By roughness, then by cosine.
    cells: [[GlassAlbedo; G]; G],
    /// Of each row: the cosine-weighted average over the hemisphere.
    averages: [GlassAlbedo; G],
}

/// Each is computed on first use: a scene's few kinds of glass need few of them.
static GLASS: [OnceLock<Box<Slice>>; SLICES] = [const { OnceLock::new() }; SLICES];

fn slice(index: usize) -> &'static Slice {
    GLASS[index].get_or_init(|| {
        let eta = eta_of_slice(index);
        let cells = std::array::from_fn(|row| {
            let alpha = node_alpha(row, G);
            std::array::from_fn(|column| albedo(alpha, node_cos(column, G), eta))
        });
        let averages = cells.map(|row: [GlassAlbedo; G]| {
            let [exact, clear, mirrored] = cosine_average::<G, 3>(|column| row[column].parts());
            GlassAlbedo { exact, clear, mirrored }
        });
        Box::new(Slice { cells, averages })
    })
}

/// The index of a slice.
pub(super) fn eta_of_slice(index: usize) -> f32 {
    let ratio = (index as f32 / SLICES_PER_UNIT - 0.5).min(0.9999);
    (1.0 + ratio) / (1.0 - ratio)
}

/// The slice at or below an index, and the position between it and the next.
pub(super) fn locate_slice(eta: f32) -> (usize, f32) {
    let ratio = (eta - 1.0) / (eta + 1.0);
    locate_cell::<SLICES>(((ratio + 0.5) * SLICES_PER_UNIT).max(0.0))
}

/// Rough glass of one alpha, seen from one of its sides.
#[derive(Clone, Copy)]
pub struct GlassRow {
    slices: [&'static Slice; 2],
    index_t: f32,
    row: usize,
    row_t: f32,
}

impl GlassRow {
    /// `eta` is the index behind over that before the boundary.
    pub fn of(alpha: f32, eta: f32) -> Self {
        let (k, index_t) = locate_slice(eta);
        let (row, row_t) = locate_cell::<G>(alpha.sqrt() * (G - 1) as f32);
        Self { slices: [slice(k), slice(k + 1)], index_t, row, row_t }
    }

    /// The albedo for a direction of cosine `cos`.
    pub fn at(&self, cos: f32) -> GlassAlbedo {
        let (j, t) = locate_cell::<G>(cos.sqrt() * (G - 1) as f32);
        self.mix(|slice, row| slice.cells[row][j].mix(slice.cells[row][j + 1], t))
    }

    /// The albedo under light from all directions alike.
    pub fn average(&self) -> GlassAlbedo {
        self.mix(|slice, row| slice.averages[row])
    }

    fn mix(&self, value: impl Fn(&Slice, usize) -> GlassAlbedo) -> GlassAlbedo {
        let of = |slice| value(slice, self.row).mix(value(slice, self.row + 1), self.row_t);
        let [below, above] = self.slices;
        of(below).mix(of(above), self.index_t)
    }
}

/// Calls `put` with facets that a direction sees and the weight of each; these add up to one.
pub(super) fn each_facet(alpha: f32, wo: Vec3, mut put: impl FnMut(Vec3, f64)) {
    // Half a turn will do, by symmetry.
    const TURNS: usize = 12;
    const CAPS: usize = 48;
    const GOLDEN: f32 = 0.618_034;
    for cap in 0..CAPS {
        // Dense in the distribution's tail, where lobes meet the horizon.
        let rest = (cap as f32 + 0.5) / CAPS as f32;
        let weight = f64::from(2.0 * rest) / (CAPS * TURNS) as f64;
        // Each cap is turned against the last one, since total reflection ends at an edge.
        let start = (cap as f32 * GOLDEN).fract();
        for turn in 0..TURNS {
            let x = 0.5 * (turn as f32 + start) / TURNS as f32;
            put(ggx::sample_visible_normal(wo, alpha, Vec2::new(x, 1.0 - rest * rest)), weight);
        }
    }
}

/// By the mean over the normals that the direction sees.
fn albedo(alpha: f32, cos: f32, eta: f32) -> GlassAlbedo {
    let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let masking = |cos: f32| ggx::masking(cos.max(0.0), alpha * alpha);
    let mut sums = [0.0_f64; 3];
    each_facet(alpha, wo, |h, weight| {
        // A facet's reflectance, and what is left of what it reflects and of what it refracts.
        let along = wo.dot(h);
        let (reflectance, cos_t) = fresnel::dielectric(along, eta);
        let reflected = masking(2.0 * along * h.z - wo.z);
        let refracted = masking(wo.z / eta - (along / eta - cos_t) * h.z);
        let parts = if reflectance >= 1.0 {
            [reflected, reflected, 0.0]
        } else {
            let exact = reflectance * reflected + (1.0 - reflectance) * refracted;
            [exact, refracted, reflected - refracted]
        };
        for (sum, part) in sums.iter_mut().zip(parts) {
            *sum += weight * f64::from(part);
        }
    });
    let [exact, clear, mirrored] = sums.map(|sum| sum as f32);
    GlassAlbedo { exact, clear, mirrored }
}
