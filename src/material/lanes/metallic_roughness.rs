//! glTF's opaque material in lanes.

use std::f32::consts::{FRAC_1_PI, PI};

use super::super::energy::Albedos;
use super::super::form::BsdfForm;
use super::super::ggx::MIRROR_ALPHA;
use super::bsdf::{BSDF_ROWS, BsdfLanes, BsdfSamples, is_above, or_zero};
use crate::sampling::warp;
use crate::simd::lanes::{Float, Lanes, Mask, Uint, Vec3f, unit_circle};

/// The specular lobe is sampled with at least this probability where it has any weight: a coat that
/// reflects little in all reflects nearly everything at grazing half vectors.
pub(crate) const MIN_SPECULAR_PROBABILITY: f32 = 0.1;

/// [`crate::material::MetallicRoughness`] in lanes, for a viewer.
#[derive(Clone, Copy)]
pub struct MetallicRoughnessLanes<L: Lanes> {
    diffuse: Vec3f<L>,
    f0: Vec3f<L>,
    f90: L::Float,
    coat_f0: L::Float,
    coat_f90: L::Float,
    alpha: L::Float,
    /// The table's row for the roughness.
    row: L::Float,
    coat_scale: L::Float,
    multiple: Vec3f<L>,
    multiple_scale: L::Float,
    /// The lobe's albedo towards the viewer.
    view: AlbedoLanes<L>,
    /// The probability of the specular lobe.
    specular: L::Float,
    form: BsdfForm,
}

/// [`super::super::energy::Albedo`] in lanes.
#[derive(Clone, Copy)]
struct AlbedoLanes<L: Lanes> {
    f0: L::Float,
    f90: L::Float,
}

impl<L: Lanes> AlbedoLanes<L> {
    #[inline(always)]
    fn of(self, f0: L::Float, f90: L::Float) -> L::Float {
        f0 * self.f0 + f90 * self.f90
    }

    #[inline(always)]
    fn loss(self, lanes: L) -> L::Float {
        (lanes.float(1.0) - self.f0 - self.f90).most(lanes.float(0.0))
    }

    /// The table's albedo between two rows and two columns.
    #[inline(always)]
    fn look_up(lanes: L, row: L::Float, cos: L::Float) -> Self {
        let (i, row_t) = locate(lanes, row);
        let (j, t) = locate(lanes, cos.sqrt() * (Albedos::SIDE - 1) as f32);
        let (table, first) = (Albedos::get(), i * Albedos::SIDE as u32 + j);
        let [a, b, c, d] = lanes.gather(first, |place| table.pair(place));
        let [e, f, g, h] = lanes.gather(first, |place| table.pair(place + Albedos::SIDE));
        Self {
            f0: mix::<L>(mix::<L>(a, c, t), mix::<L>(e, g, t), row_t),
            f90: mix::<L>(mix::<L>(b, d, t), mix::<L>(f, h, t), row_t),
        }
    }
}

/// See [`super::super::energy::locate_cell`].
#[inline(always)]
fn locate<L: Lanes>(lanes: L, x: L::Float) -> (L::Uint, L::Float) {
    let index = x.to_int().min(lanes.uint(Albedos::SIDE as u32 - 2));
    (index, (x - index.to_float()).least(lanes.float(1.0)))
}

/// Linear interpolation.
#[inline(always)]
fn mix<L: Lanes>(a: L::Float, b: L::Float, t: L::Float) -> L::Float {
    a + (b - a) * t
}

impl<L: Lanes> MetallicRoughnessLanes<L> {
    /// See [`crate::material::MetallicRoughness::specular_probability`].
    #[inline(always)]
    fn specular_probability(&self, lanes: L) -> L::Float {
        let (zero, one) = (lanes.float(0.0), lanes.float(1.0));
        let specular = mean(self.f0) * self.view.f0 + self.f90 * self.view.f90;
        let below = mean(self.diffuse) * (one - self.view.of(self.coat_f0, self.coat_f90));
        let other = below + mean(self.multiple) * self.view.loss(lanes);
        let share = (specular / (specular + other)).most(lanes.float(MIN_SPECULAR_PROBABILITY));
        let share = specular.le(zero).select(zero, share);
        other.le(zero).select(one, share)
    }

    /// Value times cosine and density for directions above the surface and their half vector.
    #[inline(always)]
    fn evaluate(&self, lanes: L, wo: Vec3f<L>, wi: Vec3f<L>, h: Vec3f<L>) -> (Vec3f<L>, L::Float) {
        let one = lanes.float(1.0);
        let weight = schlick_weight(lanes, wo.dot(h));
        let lobe = LobeLanes::new(lanes, h, wo.z, wi.z, self.alpha);
        let smooth = self.smooth(lanes, weight, wi.z);
        let fresnel = self.f0.map(
            #[inline(always)]
            |f0| f0 + (self.f90 - f0) * weight,
        );
        let smooth = smooth.map(
            #[inline(always)]
            |x| x * FRAC_1_PI,
        );
        let value = (smooth + fresnel.scale(lobe.reflected)).scale(wi.z);
        let choice = self.specular;
        let pdf = choice * lobe.visible * 0.5 + (one - choice) * wi.z * FRAC_1_PI;
        (value, pdf)
    }

    /// See [`crate::material::MetallicRoughness::smooth`].
    #[inline(always)]
    fn smooth(&self, lanes: L, weight: L::Float, cos: L::Float) -> Vec3f<L> {
        let one = lanes.float(1.0);
        match self.form {
            BsdfForm::AppendixB => {
                let coat = self.coat_f0 + (self.coat_f90 - self.coat_f0) * weight;
                self.diffuse.scale(one - coat)
            }
            BsdfForm::Conserving => {
                let towards = AlbedoLanes::look_up(lanes, self.row, cos);
                let view_passes = one - self.view.of(self.coat_f0, self.coat_f90);
                let passes = one - towards.of(self.coat_f0, self.coat_f90);
                let below = view_passes * passes * self.coat_scale;
                let again = self.view.loss(lanes) * towards.loss(lanes) * self.multiple_scale;
                self.diffuse.scale(below) + self.multiple.scale(again)
            }
        }
    }
}

impl<L: Lanes> BsdfLanes<L> for MetallicRoughnessLanes<L> {
    const ROWS: usize = 4;
    const TRANSMITS: bool = false;
    const IS_DELTA: bool = false;

    #[inline(always)]
    fn new(lanes: L, columns: [[L::Float; 4]; BSDF_ROWS], form: BsdfForm, wo: Vec3f<L>) -> Self {
        let [[dx, dy, dz, f90], [fx, fy, fz, alpha], [mx, my, mz, multiple_scale], last] = columns;
        let [row, coat_f0, coat_f90, coat_scale] = last;
        let mut bsdf = Self {
            diffuse: Vec3f::new(dx, dy, dz),
            f0: Vec3f::new(fx, fy, fz),
            f90,
            coat_f0,
            coat_f90,
            alpha,
            row,
            coat_scale,
            multiple: Vec3f::new(mx, my, mz),
            multiple_scale,
            view: AlbedoLanes::look_up(lanes, row, wo.z.abs()),
            specular: f90,
            form,
        };
        bsdf.specular = bsdf.specular_probability(lanes);
        bsdf
    }

    #[inline(always)]
    fn eval(&self, lanes: L, wo: Vec3f<L>, wi: Vec3f<L>) -> (Vec3f<L>, L::Float) {
        // The other side is the same one turned about a tangent, which no isotropic lobe sees.
        let side = wo.z.to_bits();
        let (wo, wi) = (wo.flip(side), wi.flip(side));
        let above = is_above(lanes, wo.z) & is_above(lanes, wi.z);
        or_zero(lanes, above, self.evaluate(lanes, wo, wi, (wo + wi).normalize(lanes)))
    }

    #[inline(always)]
    fn sample(&self, lanes: L, wo: Vec3f<L>, u_lobe: L::Float, u: [L::Float; 2]) -> BsdfSamples<L> {
        let side = wo.z.to_bits();
        let wo = wo.flip(side);
        let facet = sample_visible_normal(lanes, wo, self.alpha, u);
        let mirrored = facet.scale(wo.dot(facet) * 2.0) - wo;
        let diffuse = warp::cosine_hemisphere_in_lanes(lanes, u);
        let specular = u_lobe.lt(self.specular);
        let wi = Vec3f::select(specular, mirrored, diffuse);
        let h = Vec3f::select(specular, facet, (wo + diffuse).normalize(lanes));
        let (value, pdf) = self.evaluate(lanes, wo, wi, h);
        BsdfSamples {
            wi: wi.flip(side),
            weight: value.divide(pdf),
            pdf,
            eta: lanes.float(1.0),
            valid: is_above(lanes, wo.z) & is_above(lanes, wi.z) & pdf.gt(lanes.float(0.0)),
        }
    }

    #[inline(always)]
    fn albedo(&self, lanes: L) -> Vec3f<L> {
        self.diffuse.scale(lanes.float(1.0) - self.coat_f0) + self.f0
    }

    #[inline(always)]
    fn is_mirror_like(&self, lanes: L) -> L::Mask {
        self.diffuse.is_zero() & self.alpha.le(lanes.float(MIRROR_ALPHA))
    }
}

/// See [`super::super::sample::mean`].
#[inline(always)]
fn mean<L: Lanes>(color: Vec3f<L>) -> L::Float {
    (color.x + color.y + color.z) * (1.0 / 3.0)
}

/// See [`super::super::fresnel::schlick_weight`].
#[inline(always)]
fn schlick_weight<L: Lanes>(lanes: L, cos: L::Float) -> L::Float {
    let m = (lanes.float(1.0) - cos).most(lanes.float(0.0));
    let m2 = m * m;
    m2 * m2 * m
}

/// See [`super::super::ggx::Lobe`].
struct LobeLanes<L: Lanes> {
    visible: L::Float,
    reflected: L::Float,
}

impl<L: Lanes> LobeLanes<L> {
    #[inline(always)]
    fn new(lanes: L, h: Vec3f<L>, cos_o: L::Float, cos_i: L::Float, alpha: L::Float) -> Self {
        let alpha2 = alpha * alpha;
        let t = h.x * h.x + h.y * h.y + alpha2 * h.z * h.z;
        let towards = inverse_masking(lanes, cos_i, alpha2);
        let reflected = alpha2 / (t * PI * t * inverse_masking(lanes, cos_o, alpha2) * towards);
        Self { visible: reflected * towards, reflected }
    }
}

#[inline(always)]
fn inverse_masking<L: Lanes>(lanes: L, cos: L::Float, alpha2: L::Float) -> L::Float {
    cos + (alpha2 + (lanes.float(1.0) - alpha2) * cos * cos).sqrt()
}

/// See [`super::super::ggx::sample_visible_normal`].
#[inline(always)]
fn sample_visible_normal<L: Lanes>(
    lanes: L,
    wo: Vec3f<L>,
    alpha: L::Float,
    [u, v]: [L::Float; 2],
) -> Vec3f<L> {
    let (zero, one) = (lanes.float(0.0), lanes.float(1.0));
    let stretched = Vec3f::<L>::new(wo.x * alpha, wo.y * alpha, wo.z).normalize(lanes);
    let z = (one - v) * (stretched.z + 1.0) - stretched.z;
    let ring = (one - z * z).most(zero).sqrt();
    let (x, y) = unit_circle::<L>(u);
    let h = Vec3f::<L>::new(x * ring, y * ring, z) + stretched;
    let above = h.z.most(lanes.float(1e-12));
    Vec3f::<L>::new(h.x * alpha, h.y * alpha, above).normalize(lanes)
}
