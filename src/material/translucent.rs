//! Surfaces whose diffuse base lets light through, scattered: leaves, paper, wax, skin.

use std::f32::consts::FRAC_1_PI;

use super::boundary::INFINITE_IOR;
use super::energy::Albedos;
use super::form::BsdfForm;
use super::metallic_roughness::MetallicRoughness;
use super::params::{SurfaceParams, saturate};
use super::sample::{BsdfSample, is_above, mean};
use crate::math::{Vec2, Vec3};
use crate::sampling::{ONE_MINUS_EPSILON, warp};

/// glTF's opaque material, of whose diffuse base a share does not send light back but lets it
/// through, evenly into the other hemisphere (KHR_materials_diffuse_transmission).
///
/// What the coat takes is taken on the side that light enters and on the side that it leaves, as
/// in [`MetallicRoughness`]: so the surface is reciprocal, and a white one loses nothing.
///
/// Alone it lets light through as if the index of refraction were the same on both sides: what goes
/// in scattered comes out scattered. Beside glass, which scales radiance that enters a solid by
/// 1 / eta², it has to know the index as well, or what comes in the one way and goes out the other
/// would gain or lose eta². There, of scattered light on the denser side the share 1 / eta² gets
/// through of what would from the other, and the rest is sent back (as is known of internal
/// reflection: Judd, "Fresnel reflection of diffusely incident light", 1942).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Translucent {
    surface: MetallicRoughness,
    /// Colour of what goes through, times its share.
    through: Vec3,
    /// Index of refraction of the back over that of the front; 1 where it does not count.
    ior: f32,
}

impl Translucent {
    /// The opaque part of what `params` describe, with `metallic` in place of the parameter.
    pub(super) fn new(params: &SurfaceParams, metallic: f32, form: BsdfForm) -> Self {
        let share = saturate(params.diffuse_transmission);
        let mut surface = MetallicRoughness::with_metallic(params, metallic, form);
        surface.diffuse *= 1.0 - share;
        let color = params.diffuse_transmission_color;
        Self { surface, through: color * (share * (1.0 - metallic)), ior: 1.0 }
    }

    /// The same as a part of a surface that is glass in part.
    pub(super) fn beside_glass(params: &SurfaceParams, metallic: f32, form: BsdfForm) -> Self {
        // Through what has an infinite index, glass lets nothing: there is nothing to agree with.
        let bends = !params.thin && params.ior > 1e-3 && params.ior < INFINITE_IOR;
        let ior = if bends { params.ior } else { 1.0 };
        Self { ior, ..Self::new(params, metallic, form) }
    }

    /// Whether `params` let any light through by way of the diffuse base.
    pub(super) fn is_seen(params: &SurfaceParams) -> bool {
        params.diffuse_transmission > 0.0 && saturate(params.metallic) < 1.0
    }

    /// See [`super::Bsdf::eval`].
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let probability = self.probability(wo);
        if (wi.z > 0.0) == (wo.z > 0.0) {
            let (value, pdf) = self.reflection(wo).eval(wo, wi);
            return (value, pdf * (1.0 - probability));
        }
        let (value, _) = self.transmission().eval(wo, Vec3::new(wi.x, wi.y, -wi.z));
        let pdf = if value == Vec3::ZERO { 0.0 } else { probability * wi.z.abs() * FRAC_1_PI };
        let eta = self.eta(wo);
        (value / (eta * eta).max(1.0), pdf)
    }

    /// See [`super::Bsdf::sample`].
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        if !is_above(wo.z.abs()) {
            return None;
        }
        let probability = self.probability(wo);
        if u_lobe < probability {
            let wi = warp::cosine_hemisphere(u);
            let wi = if wo.z > 0.0 { -wi } else { wi };
            let (value, pdf) = self.eval(wo, wi);
            return BsdfSample::from_value(wi, value, pdf, self.eta(wo));
        }
        let rest = ((u_lobe - probability) / (1.0 - probability)).min(ONE_MINUS_EPSILON);
        let mut sample = self.reflection(wo).sample(wo, rest, u)?;
        sample.weight /= 1.0 - probability;
        sample.pdf *= 1.0 - probability;
        Some(sample)
    }

    /// See [`super::Bsdf::albedo`].
    pub fn albedo(&self) -> Vec3 {
        self.surface.albedo() + self.transmission().albedo()
    }

    /// What goes through, as if it were sent back: the diffuse lobe below the same coat.
    pub(super) fn transmission(&self) -> MetallicRoughness {
        MetallicRoughness {
            diffuse: self.through,
            f0: Vec3::ZERO,
            f90: 0.0,
            multiple: Vec3::ZERO,
            ..self.surface
        }
    }

    /// Index of refraction beyond the surface over that on the viewer's side.
    fn eta(&self, wo: Vec3) -> f32 {
        if wo.z < 0.0 { 1.0 / self.ior } else { self.ior }
    }

    /// Of what would go through from the thinner side, the share that does from the viewer's.
    fn passes(&self, wo: Vec3) -> f32 {
        let eta = self.eta(wo);
        (eta * eta).min(1.0)
    }

    /// What is sent back on the viewer's side.
    fn reflection(&self, wo: Vec3) -> MetallicRoughness {
        let diffuse = self.surface.diffuse + self.through * (1.0 - self.passes(wo));
        MetallicRoughness { diffuse, ..self.surface }
    }

    /// The probability that the light that goes through is sampled: its share of all, seen from
    /// there.
    fn probability(&self, wo: Vec3) -> f32 {
        let surface = &self.reflection(wo);
        let view = Albedos::get().at(surface.row, wo.z.abs());
        let below = 1.0 - view.of(surface.coat_f0, surface.coat_f90);
        let through = mean(self.through) * self.passes(wo) * below;
        let reflected = mean(surface.f0) * view.f0
            + surface.f90 * view.f90
            + mean(surface.diffuse) * below
            + mean(surface.multiple) * view.loss();
        if through <= 0.0 {
            0.0
        } else if reflected <= 0.0 {
            1.0
        } else {
            (through / (through + reflected)).clamp(0.05, 0.95)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the extension has it: what goes through takes from what is sent back.
    #[test]
    fn light_is_divided_by_the_factor() {
        let color = Vec3::new(0.2, 0.4, 0.6);
        let params = SurfaceParams {
            specular: 0.0,
            base_color: Vec3::splat(0.5),
            diffuse_transmission: 0.25,
            diffuse_transmission_color: color,
            ..SurfaceParams::default()
        };
        for form in BsdfForm::ALL {
            let leaf = Translucent::new(&params, 0.0, form);
            let (wo, wi) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, -0.8, 0.6));
            let (back, _) = leaf.eval(wo, wi);
            let (through, _) = leaf.eval(wo, Vec3::new(wi.x, wi.y, -wi.z));
            let lambert = 0.6 * FRAC_1_PI;
            assert!((back - Vec3::splat(0.5 * 0.75 * lambert)).length() < 1e-6, "{back}");
            assert!((through - color * (0.25 * lambert)).length() < 1e-6, "{through}");
            assert!((leaf.albedo() - (Vec3::splat(0.375) + color * 0.25)).length() < 1e-6);
        }
    }

    /// Beside glass of index 1.5, of what is inside 1 / 2.25 gets out where all would get in; a
    /// sheet has no inside, nor has what does not bend light.
    #[test]
    fn beside_glass_the_index_counts() {
        let wax =
            SurfaceParams { diffuse_transmission: 1.0, specular: 0.0, ..SurfaceParams::default() };
        let (wo, wi) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.8, -0.6));
        let mirrored = Vec3::new(0.6, 0.0, -0.8);
        for (params, scale) in [
            (wax, 2.25),
            (SurfaceParams { thin: true, ..wax }, 1.0),
            (SurfaceParams { ior: 1.0, ..wax }, 1.0),
            (SurfaceParams { ior: 0.0, ..wax }, 1.0),
            (SurfaceParams { ior: f32::NAN, ..wax }, 1.0),
        ] {
            let wax = Translucent::beside_glass(&params, 0.0, BsdfForm::AppendixB);
            let (enters, leaves) = (wax.eval(wo, wi).0 / 0.6, wax.eval(wi, wo).0 / 0.8);
            assert!((leaves - FRAC_1_PI).length() < 1e-6, "{leaves}");
            assert!((leaves - enters * scale).length() < 1e-6, "{enters} {leaves}");
            let within = wax.eval(wi, mirrored).0 / 0.8;
            let expected = FRAC_1_PI * (1.0 - 1.0 / scale);
            assert!((within - expected).abs().max_element() < 1e-6, "{within}");
            let sample = wax.sample(wo, 0.0, Vec2::splat(0.5)).expect("it lets light through");
            assert!(sample.wi.z < 0.0 && (sample.eta * sample.eta - scale).abs() < 1e-6);
        }
    }
}
