//! Cloth: light that fibres scatter which stand off a surface (KHR_materials_sheen).
//!
//! Estevez and Kulla, "Production Friendly Microfacet Sheen BRDF", 2017, with the fit of the
//! shadowing that the specification gives.

use std::f32::consts::TAU;
use std::sync::OnceLock;

use super::energy::locate_cell;
use super::form::BsdfForm;
use super::layer_columns::{Averaged, COLUMNS, Curve, Spread, column_direction, look_up};
use super::sample::mean;
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Below this the distribution is too narrow to be seen.
const MIN_ROUGHNESS: f32 = 0.07;

/// The sheen at a point. Directions are above the surface.
///
/// The model reflects more than it gets at grazing angles on smooth fibres; in
/// [`BsdfForm::Conserving`] it is scaled down there.
#[derive(Clone, Copy, Debug)]
pub struct Sheen {
    color: Vec3,
    alpha: f32,
    shadowing: Shadowing,
    /// The roughness's place among the rows of tables.
    place: f32,
    rows: [&'static Fibres; 2],
    form: BsdfForm,
}

impl Sheen {
    /// Density of [`Sheen::sample`].
    pub const PDF: f32 = 1.0 / TAU;

    /// Of a colour and a roughness, both 0 to 1.
    pub fn new(color: Vec3, roughness: f32, form: BsdfForm) -> Self {
        let roughness = roughness.max(MIN_ROUGHNESS);
        let alpha = roughness * roughness;
        let place = Fibres::place(roughness);
        let (row, _) = locate_cell::<{ Fibres::ROWS }>(place);
        let rows = [Fibres::of(row), Fibres::of(row + 1)];
        Self { color, alpha, shadowing: Shadowing::new(alpha), place, rows, form }
    }

    /// Its colour.
    pub(super) fn color(&self) -> Vec3 {
        self.color
    }

    /// What it keeps of what white cloth would keep.
    pub(super) fn strength(&self) -> f32 {
        self.color.max_element()
    }

    /// The place of its roughness among the rows of [`Fibres`].
    pub(super) fn place(&self) -> f32 {
        self.place
    }

    fn look_up(&self, w: Vec3, curve: fn(&Fibres) -> &Curve) -> f32 {
        let (_, t) = locate_cell::<{ Fibres::ROWS }>(self.place);
        look_up(self.rows.map(curve), t, w.z.abs())
    }

    /// The share of light from a direction that white fibres would scatter by the model.
    fn white(&self, w: Vec3) -> f32 {
        self.look_up(w, |fibres| &fibres.albedos)
    }

    /// The share that they keep.
    fn kept(&self, w: Vec3) -> f32 {
        self.look_up(w, |fibres| &fibres.kept)
    }

    /// What it keeps of light from each column's direction.
    pub(super) fn curve(&self) -> Curve {
        let ([below, above], (_, t)) =
            (self.rows.map(|fibres| &fibres.kept), locate_cell::<{ Fibres::ROWS }>(self.place));
        std::array::from_fn(|k| self.strength() * (below[k] + (above[k] - below[k]) * t))
    }

    /// The share of light from a direction that it scatters, all colours together.
    pub fn albedo(&self, w: Vec3) -> f32 {
        mean(self.color) * self.kept(w)
    }

    /// The share of light from a direction, on either side, that it lets through.
    pub fn transmittance(&self, w: Vec3) -> f32 {
        let kept = match self.form {
            BsdfForm::AppendixB => self.white(w),
            BsdfForm::Conserving => self.kept(w),
        };
        (1.0 - self.strength() * kept).max(0.0)
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
            BsdfForm::Conserving => {
                let [o, i] = [wo, wi].map(|w| excess(self.white(w), self.kept(w)));
                o.max(i)
            }
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

/// White fibres of one roughness.
#[derive(Debug)]
pub(super) struct Fibres {
    /// The model's albedos.
    albedos: Curve,
    /// The share of light that they keep from what lies below: the same, at most one.
    pub kept: Curve,
    /// How what they scatter in [`BsdfForm::Conserving`] spreads.
    pub spread: Spread,
    /// What they scatter less than they keep, and its average.
    pub lost: Averaged,
}

impl Fibres {
    /// Rows of the tables, of which most are for smooth fibres.
    pub const ROWS: usize = 33;

    /// Those of a row.
    pub fn of(row: usize) -> &'static Self {
        static ROWS: [OnceLock<Box<Fibres>>; Fibres::ROWS] =
            [const { OnceLock::new() }; Fibres::ROWS];
        ROWS[row].get_or_init(|| {
            let place = row as f32 / (Self::ROWS - 1) as f32;
            let roughness = MIN_ROUGHNESS + (1.0 - MIN_ROUGHNESS) * place * place;
            Box::new(Self::new(roughness * roughness))
        })
    }

    /// The place of a roughness among the rows.
    fn place(roughness: f32) -> f32 {
        let share = (roughness - MIN_ROUGHNESS) / (1.0 - MIN_ROUGHNESS);
        share.max(0.0).sqrt() * (Self::ROWS - 1) as f32
    }

    /// By the midpoint rule over azimuth and the cosine's root.
    fn new(alpha: f32) -> Self {
        let shadowing = Shadowing::new(alpha);
        let caps: [Cap; CAPS] = std::array::from_fn(|cap| {
            let root = (cap as f32 + 0.5) / CAPS as f32;
            let lambda = shadowing.lambda(root * root);
            Cap { cos: root * root, width: 2.0 * root / CAPS as f32, lambda }
        });
        let rings: Vec<[f32; CAPS]> = (0..COLUMNS)
            .map(|column| {
                let wo = column_direction(column);
                let here = shadowing.lambda(wo.z);
                std::array::from_fn(|cap| ring(wo, here, &caps[cap], alpha))
            })
            .collect();
        let albedos: Curve = std::array::from_fn(|column| rings[column].iter().sum());
        let kept = albedos.map(|albedo| albedo.min(1.0));
        let mut made =
            Self { albedos, kept, spread: Spread::new(), lost: Averaged::from_fn(|_| 0.0) };
        for (column, ring) in rings.iter().enumerate() {
            for (cap, share) in caps.iter().zip(ring) {
                let there = [&albedos, &kept].map(|curve| look_up([curve; 2], 0.0, cap.cos));
                let limit = excess(albedos[column], kept[column]).max(excess(there[0], there[1]));
                made.spread.add(column, cap.cos, share / limit);
            }
        }
        let scattered = |column| made.spread.integrate(column, |_| 1.0);
        made.lost = Averaged::from_fn(|column| (kept[column] - scattered(column)).max(0.0));
        made
    }
}

/// How many times as much fibres would scatter by the model as they keep, at least one.
fn excess(scattered: f32, kept: f32) -> f32 {
    if scattered > kept { scattered / kept } else { 1.0 }
}

/// Of the rule over the hemisphere.
const CAPS: usize = 96;
const TURNS: usize = 32;

/// Directions of about one cosine.
struct Cap {
    cos: f32,
    /// What the cosine varies.
    width: f32,
    lambda: f32,
}

/// What is scattered from `wo`, whose lambda is `here`, to all directions of a cap.
fn ring(wo: Vec3, here: f32, cap: &Cap, alpha: f32) -> f32 {
    let (inverse, radius) = (1.0 / alpha, (1.0 - cap.cos * cap.cos).sqrt());
    let mut sum = 0.0;
    for turn in 0..TURNS {
        // Half a turn will do, by symmetry.
        let way = warp::unit_circle((turn as f32 + 0.5) / (2 * TURNS) as f32) * radius;
        let h = (wo + Vec3::new(way.x, way.y, cap.cos)).normalize();
        sum += libm::powf(h.x * h.x + h.y * h.y, 0.5 * inverse);
    }
    // The distribution's norm over 2π, times the ring's 2π.
    let distribution = (2.0 + inverse) * sum / TURNS as f32;
    distribution * cap.width / ((1.0 + here + cap.lambda) * 4.0 * wo.z)
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
