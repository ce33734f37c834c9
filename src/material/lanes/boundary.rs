//! What a smooth boundary does to light, in lanes.

use super::bsdf::{BsdfSamples, is_above};
use crate::simd::lanes::{Float, Lanes, Mask, Vec3f};

/// The probability with which a reflection is sampled, of a reflectance over all colours, where
/// what passes is tinted.
#[inline(always)]
pub fn reflection_probability<L: Lanes>(
    lanes: L,
    reflectance: L::Float,
    tint: Vec3f<L>,
) -> L::Float {
    let zero = lanes.float(0.0);
    let brightest = tint.y.most(tint.z).most(tint.x);
    let all = reflectance + (lanes.float(1.0) - reflectance) * brightest.most(zero);
    // Black glass seen where it does not reflect: sample the nothing that is transmitted.
    all.gt(zero).select(reflectance / all, zero)
}

/// A smooth boundary as seen from a direction.
pub struct SmoothBoundary<L: Lanes> {
    /// Colour of the light that passes.
    pub tint: Vec3f<L>,
    /// By colour.
    pub reflectance: Vec3f<L>,
    /// The probability with which the reflection is sampled.
    pub reflection_probability: L::Float,
    /// Index on the far side over that on the side of the viewer; 1 for a sheet.
    pub eta: L::Float,
    /// The cosine of the refracted ray.
    pub cos_t: L::Float,
    /// Where it is a sheet, which light passes straight.
    pub thin: L::Mask,
}

impl<L: Lanes> SmoothBoundary<L> {
    /// Mirrors light or lets it pass, for a viewer in the local direction `wo`.
    #[inline(always)]
    pub fn sample(&self, lanes: L, wo: Vec3f<L>, u_lobe: L::Float) -> BsdfSamples<L> {
        let one = lanes.float(1.0);
        let mirrors = u_lobe.lt(self.reflection_probability);
        let pdf = mirrors.select(self.reflection_probability, one - self.reflection_probability);

        let inverse = one / self.eta;
        let bent = -self.cos_t.copysign(wo.z);
        let through = Vec3f::new(-wo.x * inverse, -wo.y * inverse, self.thin.select(-wo.z, bent));
        let white = Vec3f::splat(one);
        let passes = self.tint * (white - self.reflectance);
        // Radiance is denser by the square of the index.
        let dense = passes.scale(inverse * inverse / pdf);
        let kept = Vec3f::select(mirrors, self.reflectance, passes).divide(pdf);
        BsdfSamples {
            wi: Vec3f::select(mirrors, Vec3f::new(-wo.x, -wo.y, wo.z), through),
            weight: Vec3f::select(mirrors | self.thin, kept, dense),
            pdf,
            eta: mirrors.select(one, self.eta),
            valid: is_above(lanes, wo.z.abs()),
        }
    }
}
