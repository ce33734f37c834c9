//! A coat of lacquer: a rough dielectric boundary of index 1.5 over anything
//! (KHR_materials_clearcoat).

use std::sync::OnceLock;

use super::energy::{each_reflection, locate_cell, node_alpha};
use super::form::BsdfForm;
use super::fresnel;
use super::ggx::{self, MIN_ALPHA};
use super::layer_columns::{Curve, column_direction, look_up};
use super::sample::is_above;
use crate::math::{Frame, Vec2, Vec3};

/// The coat's reflectance at normal incidence.
const F0: f32 = 0.04;

/// The coat at a point.
///
/// It reflects by GGX under Schlick's Fresnel term at the half vector. The share that it lets
/// through in one direction is `1 - F` at the macroscopic normal in [`BsdfForm::AppendixB`], and
/// one minus the coat's albedo in [`BsdfForm::Conserving`].
#[derive(Clone, Copy, Debug)]
pub struct Clearcoat {
    strength: f32,
    alpha: f32,
    /// The place of its roughness among the rows of [`kept`].
    place: f32,
    rows: [&'static Curve; 2],
    /// About its own normal.
    frame: Frame,
    form: BsdfForm,
}

impl Clearcoat {
    /// A coat of that strength, roughness (both 0 to 1) and unit normal.
    pub fn new(strength: f32, roughness: f32, normal: Vec3, form: BsdfForm) -> Self {
        let alpha = (roughness * roughness).max(MIN_ALPHA);
        let place = alpha.sqrt() * (COAT_ROWS - 1) as f32;
        let (row, _) = locate_cell::<COAT_ROWS>(place);
        let rows = [kept(row), kept(row + 1)];
        Self { strength, alpha, place, rows, frame: Frame::from_normal(normal), form }
    }

    /// Its strength.
    pub(super) fn strength(&self) -> f32 {
        self.strength
    }

    /// The place of its roughness among the rows of [`kept`].
    pub(super) fn place(&self) -> f32 {
        self.place
    }

    /// The share of light from a direction that it reflects.
    pub fn albedo(&self, w: Vec3) -> f32 {
        let cos = w.dot(self.frame.normal).abs();
        let (_, t) = locate_cell::<COAT_ROWS>(self.place);
        self.strength * look_up(self.rows, t, cos)
    }

    /// That share at each column.
    pub(super) fn curve(&self) -> Curve {
        let ([below, above], (_, t)) = (self.rows, locate_cell::<COAT_ROWS>(self.place));
        std::array::from_fn(|k| self.strength * (below[k] + (above[k] - below[k]) * t))
    }

    /// The share of light from a direction, on either side, that it lets through.
    pub fn transmittance(&self, w: Vec3) -> f32 {
        match self.form {
            BsdfForm::AppendixB => {
                let weight = fresnel::schlick_weight(w.dot(self.frame.normal).abs());
                1.0 - self.strength * (F0 + (1.0 - F0) * weight)
            }
            BsdfForm::Conserving => 1.0 - self.albedo(w),
        }
    }

    /// What it reflects, times the cosine at its own normal, and the density of
    /// [`Clearcoat::sample`]; for directions above the surface below.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (f32, f32) {
        let (wo, wi) = (self.frame.to_local(wo), self.frame.to_local(wi));
        if !(is_above(wo.z) && is_above(wi.z)) {
            return (0.0, 0.0);
        }
        let h = (wo + wi).normalize();
        let lobe = ggx::Lobe::new(h, wo.z, wi.z, self.alpha);
        let fresnel = F0 + (1.0 - F0) * fresnel::schlick_weight(wo.dot(h));
        (self.strength * fresnel * lobe.reflected * wi.z, lobe.visible * 0.5)
    }

    /// Samples a reflected direction, which may lie below the surface; `None` where the viewer does
    /// not see the coat.
    pub fn sample(&self, wo: Vec3, u: Vec2) -> Option<Vec3> {
        let wo = self.frame.to_local(wo);
        if !is_above(wo.z) {
            return None;
        }
        let h = ggx::sample_visible_normal(wo, self.alpha, u);
        Some(self.frame.to_world(h * (2.0 * wo.dot(h)) - wo))
    }
}

/// Rows of tables by the roughness of a coat.
pub(super) const COAT_ROWS: usize = 65;

/// The share of light that a coat of strength one reflects and keeps from what lies below it. Each
/// row is computed on first use.
pub(super) fn kept(row: usize) -> &'static Curve {
    static ROWS: [OnceLock<Box<Curve>>; COAT_ROWS] = [const { OnceLock::new() }; COAT_ROWS];
    ROWS[row].get_or_init(|| {
        let alpha = node_alpha(row, COAT_ROWS);
        Box::new(std::array::from_fn(|column| {
            let mut sum = 0.0_f64;
            each_reflection(alpha, column_direction(column), |_, weight, albedo| {
                sum += weight * f64::from(albedo.of(F0, 1.0));
            });
            sum as f32
        }))
    })
}
