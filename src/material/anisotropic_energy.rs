//! How much a stretched microfacet lobe reflects in all; see [`super::energy`].
//!
//! The table is indexed by the roots of both alphas and of the cosine. Each entry is the greatest
//! albedo of any azimuth, factor by factor, so that compensation never adds too much, but for the
//! table's own error: 2% between two alphas of a mirror.

use std::sync::LazyLock;

use super::anisotropic_ggx::Lobe;
use super::energy::{Albedo, locate_cell};
use super::fresnel;
use super::ggx::MIN_ALPHA;
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Entries along each alpha's axis, and along that of the cosine.
const N: usize = 12;
const COLUMNS: usize = 16;

/// By cosine.
type Cells = [Albedo; COLUMNS];

/// By the greater alpha, then by the smaller one: rows with their averages.
static TABLE: LazyLock<Vec<(Cells, Albedo)>> = LazyLock::new(|| {
    let alpha = |k: usize| {
        let root = k as f32 / (N - 1) as f32;
        (root * root).max(MIN_ALPHA)
    };
    let mut rows = Vec::with_capacity(N * N);
    for along in 0..N {
        for across in 0..N {
            // Beyond the diagonal an entry only serves to interpolate to.
            let lobe = Lobe { along: alpha(along), across: alpha(across) };
            let cells = std::array::from_fn(|column| {
                let root = column as f32 / (COLUMNS - 1) as f32;
                greatest_albedo(&lobe, root * root)
            });
            rows.push((cells, average(&cells)));
        }
    }
    rows
});

/// The position of two alphas in the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Number of the row of the lesser neighbours of both.
    first: usize,
    along_t: f32,
    across_t: f32,
}

impl Row {
    /// The position of a pair of alphas.
    pub fn of(along: f32, across: f32) -> Self {
        let place = |alpha: f32| locate_cell::<N>(alpha.sqrt() * (N - 1) as f32);
        let ((i, along_t), (j, across_t)) = (place(along), place(across));
        Self { first: i * N + j, along_t, across_t }
    }

    fn mix(&self, value: impl Fn(&(Cells, Albedo)) -> Albedo) -> Albedo {
        let at = |k: usize| value(&TABLE[self.first + k]);
        let below = at(0).mix(at(1), self.across_t);
        below.mix(at(N).mix(at(N + 1), self.across_t), self.along_t)
    }

    /// The albedo seen from a direction of that cosine.
    pub fn at(&self, cos: f32) -> Albedo {
        let (j, t) = locate_cell::<COLUMNS>(cos.sqrt() * (COLUMNS - 1) as f32);
        self.mix(|(cells, _)| cells[j].mix(cells[j + 1], t))
    }

    /// The albedo under light from all directions alike.
    pub fn average(&self) -> Albedo {
        self.mix(|(_, average)| *average)
    }
}

/// The integral of `4 t³ * albedo` over the cosine's root t, by Simpson's rule in both halves of
/// each interval of the piecewise linear table.
fn average(cells: &Cells) -> Albedo {
    let cube = |t: f32| t * t * t;
    let width = 1.0 / (COLUMNS - 1) as f32;
    let (mut f0, mut f90) = (0.0, 0.0);
    for (k, pair) in cells.windows(2).enumerate() {
        for half in 0..2 {
            let from = 0.5 * half as f32;
            for (share, weight) in [(0.0, 1.0), (0.25, 4.0), (0.5, 1.0)] {
                let t = from + share;
                let albedo = pair[0].mix(pair[1], t);
                let factor = 4.0 * cube((k as f32 + t) * width) * weight * width / 12.0;
                f0 += albedo.f0 * factor;
                f90 += albedo.f90 * factor;
            }
        }
    }
    Albedo { f0, f90 }
}

fn greatest_albedo(lobe: &Lobe, cos: f32) -> Albedo {
    const AZIMUTHS: usize = 5;
    let sin = (1.0 - cos * cos).sqrt();
    let mut greatest = Albedo::default();
    for azimuth in 0..AZIMUTHS {
        let way = warp::unit_circle(0.25 * azimuth as f32 / (AZIMUTHS - 1) as f32);
        let albedo = reflection_albedo(lobe, Vec3::new(sin * way.x, sin * way.y, cos));
        greatest.f0 = greatest.f0.max(albedo.f0);
        greatest.f90 = greatest.f90.max(albedo.f90);
    }
    greatest
}

fn reflection_albedo(lobe: &Lobe, wo: Vec3) -> Albedo {
    const TURNS: usize = 24;
    const CAPS: usize = 20;
    let (mut f0, mut f90) = (0.0, 0.0);
    for cap in 0..CAPS {
        // Dense in the distribution's tail, where lobes meet the horizon.
        let rest = (cap as f32 + 0.5) / CAPS as f32;
        let weight = 2.0 * rest / (CAPS * TURNS) as f32;
        for turn in 0..TURNS {
            let u = Vec2::new((turn as f32 + 0.5) / TURNS as f32, 1.0 - rest * rest);
            let h = lobe.sample_visible_normal(wo, u);
            let along = wo.dot(h);
            let wi = h * (2.0 * along) - wo;
            if wi.z > 0.0 {
                let (visible, grazing) = (lobe.masking(wi), fresnel::schlick_weight(along));
                f0 += weight * visible * (1.0 - grazing);
                f90 += weight * visible * grazing;
            }
        }
    }
    Albedo { f0, f90 }
}
