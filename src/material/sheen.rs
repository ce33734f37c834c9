//! Cloth: light that fibres scatter which stand off a surface (KHR_materials_sheen).
//!
//! Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF", 2017, with the fit of the
//! shadowing that the specification gives.

use std::f32::consts::TAU;
use std::sync::LazyLock;

use super::energy::locate_cell;
use super::form::BsdfForm;
use super::sample::mean;
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Below this the distribution is too narrow to be seen.
pub(super) const MIN_ROUGHNESS: f32 = 0.07;

/// The sheen at a point. Directions are above the surface.
///
/// The model reflects more than it gets at grazing angles on smooth fibres; in
/// [`BsdfForm::Conserving`] it is scaled down there.
#[derive(Clone, Copy, Debug)]
pub struct Sheen {
    color: Vec3,
    alpha: f32,
    shadowing: Shadowing,
    /// The roughness in steps of the table.
    step: f32,
    form: BsdfForm,
}

impl Sheen {
    /// Density of [`Sheen::sample`].
    pub const PDF: f32 = 1.0 / TAU;

    /// Of a colour and a roughness, both 0 to 1.
    pub fn new(color: Vec3, roughness: f32, form: BsdfForm) -> Self {
        let roughness = roughness.max(MIN_ROUGHNESS);
        let alpha = roughness * roughness;
        let step = (roughness - MIN_ROUGHNESS) / (1.0 - MIN_ROUGHNESS) * STEPS as f32;
        Self { color, alpha, shadowing: Shadowing::new(alpha), step, form }
    }

    /// The share of light from a direction that white fibres would scatter.
    fn white(&self, w: Vec3) -> f32 {
        albedo(self.step, w.z.abs())
    }

    /// The share of light from a direction that it scatters, all colours together.
    pub fn albedo(&self, w: Vec3) -> f32 {
        mean(self.color) * self.white(w).min(1.0)
    }

    /// The share of light from a direction, on either side, that it lets through.
    pub fn transmittance(&self, w: Vec3) -> f32 {
        let kept = match self.form {
            BsdfForm::AppendixB => self.white(w),
            BsdfForm::Conserving => self.white(w).min(1.0),
        };
        (1.0 - self.color.max_element() * kept).max(0.0)
    }

    /// What it scatters, times the cosine.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> Vec3 {
        let h = (wo + wi).normalize();
        let sin2 = h.x * h.x + h.y * h.y;
        let inverse = 1.0 / self.alpha;
        let distribution = (2.0 + inverse) / TAU * libm::powf(sin2, 0.5 * inverse);
        let shadowed = 1.0 + self.shadowing.lambda(wo.z) + self.shadowing.lambda(wi.z);
        let limit = match self.form {
            BsdfForm::AppendixB => 1.0,
            BsdfForm::Conserving => self.white(wo).max(self.white(wi)).max(1.0),
        };
        self.color * (distribution / (shadowed * 4.0 * wo.z * limit))
    }

    /// Samples the hemisphere uniformly: there is no peak.
    pub fn sample(u: Vec2) -> Vec3 {
        warp::cone(u, 0.0)
    }
}

/// The fit of Smith's function Λ for one alpha.
#[derive(Clone, Copy, Debug)]
struct Shadowing {
    a: f32,
    b: f32,
    c: f32,
    d: f32,
    e: f32,
}

impl Shadowing {
    fn new(alpha: f32) -> Self {
        let t = (1.0 - alpha) * (1.0 - alpha);
        let mix = |rough: f32, smooth: f32| rough + (smooth - rough) * t;
        Self {
            a: mix(21.5473, 25.3245),
            b: mix(3.829_87, 3.324_35),
            c: mix(0.198_23, 0.168_01),
            d: mix(-1.977_6, -1.273_93),
            e: mix(-4.320_54, -4.859_67),
        }
    }

    fn log_lambda(&self, cos: f32) -> f32 {
        self.a / (1.0 + self.b * libm::powf(cos, self.c)) + self.d * cos + self.e
    }

    fn lambda(&self, cos: f32) -> f32 {
        libm::expf(if cos < 0.5 {
            self.log_lambda(cos)
        } else {
            2.0 * self.log_lambda(0.5) - self.log_lambda((1.0 - cos).max(0.0))
        })
    }
}

/// Roughness is taken in so many steps, of which the first few, where much happens, are parted.
const STEPS: usize = 15;
const PARTED: usize = 2;
const PARTS: usize = 4;
/// Entries along roughness, then along the root of the cosine.
const ROWS: usize = STEPS + 1 + PARTED * (PARTS - 1);
const COLUMNS: usize = 32;

/// Directional albedos of white sheen.
static ALBEDOS: LazyLock<Box<[[f32; COLUMNS]; ROWS]>> = LazyLock::new(|| {
    Box::new(std::array::from_fn(|row| {
        let step = match row.checked_sub(PARTED * PARTS) {
            Some(beyond) => (PARTED + beyond) as f32,
            None => row as f32 / PARTS as f32,
        };
        let roughness = MIN_ROUGHNESS + (1.0 - MIN_ROUGHNESS) * (step / STEPS as f32);
        integrate_row(roughness * roughness)
    }))
});

fn albedo(step: f32, cos: f32) -> f32 {
    let table = &**ALBEDOS;
    let (i, row_t) = if step < PARTED as f32 {
        locate_cell::<{ PARTED * PARTS + 1 }>(step * PARTS as f32)
    } else {
        let (i, t) = locate_cell::<{ STEPS + 1 }>(step);
        (i + PARTED * (PARTS - 1), t)
    };
    let (j, t) = locate_cell::<COLUMNS>(cos.sqrt() * (COLUMNS - 1) as f32);
    let at = |row: &[f32; COLUMNS]| row[j] + (row[j + 1] - row[j]) * t;
    let (below, above) = (at(&table[i]), at(&table[i + 1]));
    below + (above - below) * row_t
}

/// The albedo at each column's cosine, by the midpoint rule over azimuth and the cosine's root.
fn integrate_row(alpha: f32) -> [f32; COLUMNS] {
    const CAPS: usize = 64;
    const TURNS: usize = 24;
    let shadowing = Shadowing::new(alpha);
    let inverse = 1.0 / alpha;
    let caps: [(f32, f32, f32); CAPS] = std::array::from_fn(|cap| {
        let root = (cap as f32 + 0.5) / CAPS as f32;
        (root * root, 2.0 * root / CAPS as f32, shadowing.lambda(root * root))
    });
    std::array::from_fn(|column| {
        let root = column as f32 / (COLUMNS - 1) as f32;
        // At the horizon itself the limit is taken from close by.
        let cos = (root * root).max(1e-4);
        let (sin, here) = ((1.0 - cos * cos).max(0.0).sqrt(), shadowing.lambda(cos));
        let mut sum = 0.0_f64;
        for (z, width, there) in caps {
            let radius = (1.0 - z * z).sqrt();
            let mut ring = 0.0;
            for turn in 0..TURNS {
                // Half a turn will do, by symmetry.
                let way = warp::unit_circle((turn as f32 + 0.5) / (2 * TURNS) as f32) * radius;
                let h = Vec3::new(sin + way.x, way.y, cos + z).normalize();
                ring += libm::powf(h.x * h.x + h.y * h.y, 0.5 * inverse);
            }
            let shadowed = (1.0 + here + there) * 4.0 * cos;
            sum += f64::from(ring * width / shadowed);
        }
        // The distribution's norm over 2π, times the ring's 2π.
        (sum * f64::from(2.0 + inverse) / TURNS as f64) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of the integral by a rule of 400 by 200 points in f64.
    #[test]
    fn albedos_are_the_integral() {
        for (roughness, cos, expected) in [
            (1.0, 1.0, 0.1638),
            (1.0, 0.2, 0.5842),
            (0.5, 0.4, 0.2468),
            (0.5, 0.03, 0.7397),
            (0.3, 0.1, 0.5409),
            (0.2, 0.01, 1.1513),
        ] {
            let sheen = Sheen::new(Vec3::ONE, roughness, BsdfForm::Conserving);
            let found = sheen.white(Vec3::new(0.0, 0.0, cos));
            let error = (found - expected).abs() / expected;
            assert!(error < 0.03, "{roughness}, {cos}: {found} is not {expected}");
        }
    }
}
