//! A coat of lacquer: a rough dielectric boundary of index 1.5 over anything
//! (KHR_materials_clearcoat).

use super::energy::{Albedos, Row};
use super::form::BsdfForm;
use super::fresnel;
use super::ggx::{self, MIN_ALPHA};
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
    row: Row,
    /// About its own normal.
    frame: Frame,
    form: BsdfForm,
}

impl Clearcoat {
    /// A coat of that strength, roughness (both 0 to 1) and unit normal.
    pub fn new(strength: f32, roughness: f32, normal: Vec3, form: BsdfForm) -> Self {
        let alpha = (roughness * roughness).max(MIN_ALPHA);
        Self { strength, alpha, row: Row::of(alpha), frame: Frame::from_normal(normal), form }
    }

    /// The share of light from a direction that it reflects.
    pub fn albedo(&self, w: Vec3) -> f32 {
        let cos = w.dot(self.frame.normal).abs();
        self.strength * Albedos::get().at(self.row, cos).of(F0, 1.0)
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
