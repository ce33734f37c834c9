//! The light that layers on the outside of solids lose which light passes: glass, wax, or both.
//!
//! From outside and from inside the shares L(o) and L'(o) are lost. They come back on both sides in
//! proportion to what these lose, and radiance is n² times as dense inside, so that
//!
//! `f(o, i) = L(o) L(i) n(o)² / (π (L_avg + n² L'_avg))`,
//!
//! where n(o) is 1 outside and n inside, is the same both ways over the square of the index, and
//! gives back all of L and of L'.

use super::boundary::INFINITE_IOR;
use super::clearcoat::Clearcoat;
use super::energy::{Albedos, Row};
use super::layer_base::Base;
use super::layer_columns::{COLUMNS, Curve, column_cos};
use super::layer_glass::{GlassLosses, Side, column_weights, dot};
use super::layer_losses::base_rows;
use super::metallic_roughness::MetallicRoughness;
use super::params::{SurfaceParams, saturate};
use super::sheen::Sheen;
use crate::math::Vec3;

/// What layers lose of the light that passes a solid's surface, or that glass reflects.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    /// The share of light that all layers keep.
    pub kept: Curve,
    /// What radiance inside is denser by, n².
    pub density: f32,
    glass: Option<Glass>,
    scattered: Scattered,
}

/// The share of a solid that is glass.
#[derive(Clone, Copy, Debug)]
struct Glass {
    losses: GlassLosses,
    /// The share, by side, in the colour of what is lost there.
    colors: [Vec3; 2],
}

/// What leaves scattered below a dielectric's surface.
#[derive(Clone, Copy, Debug)]
struct Scattered {
    /// What of it is lost, over what that surface lets through from inside.
    lost: Vec3,
    row: Row,
    coat_f0: f32,
    coat_f90: f32,
}

impl Solid {
    /// Of a solid that `params` describe, with its opaque part in white and the share of that.
    pub fn new(
        params: &SurfaceParams,
        base: &Base,
        (opaque, share): (&MetallicRoughness, f32),
        coat: Option<&Clearcoat>,
        cloth: Option<&Sheen>,
    ) -> Self {
        let [coat, cloth] = [coat.map(Clearcoat::curve), cloth.map(Sheen::curve)]
            .map(|curve| curve.unwrap_or([0.0; COLUMNS]));
        let kept = std::array::from_fn(|k| coat[k] + cloth[k] - coat[k] * cloth[k]);
        let clear = base.clear_part();
        let ior = clear.map_or(1.0, |(glass, _)| glass.boundary().ior);
        // Through an infinite index nothing passes.
        let is_mirror = ior >= INFINITE_IOR;
        let ior = if is_mirror { 1.0 } else { ior };
        let glass = clear.filter(|(glass, _)| !glass.is_delta()).map(|(glass, share)| {
            let boundary = glass.boundary();
            let passes = if is_mirror { Vec3::ZERO } else { boundary.tint };
            let colors = [Vec3::splat(share), passes * share];
            let losses = GlassLosses::new(boundary, base_rows(boundary.alpha));
            Glass { losses, colors }
        });
        let (row, coat_f0, coat_f90) = (opaque.row, opaque.coat_f0, opaque.coat_f90);
        let mut scattered = Scattered { lost: Vec3::ZERO, row, coat_f0, coat_f90 };
        if base.scatters_through() {
            let weights = column_weights();
            let dimmed = std::array::from_fn(|column| {
                weights[column] * scattered.passes(column_cos(column))
            });
            let through = saturate(params.diffuse_transmission) * share * dot(&dimmed, &kept);
            let factor = opaque.diffuse.x * opaque.coat_scale * through / (ior * ior).max(1.0);
            scattered.lost = params.diffuse_transmission_color.min(Vec3::ONE) * factor;
        }
        Self { kept, density: ior * ior, glass, scattered }
    }

    /// The share that is lost of light from a direction, but for what opaque parts reflect.
    pub fn lost(&self, side: Side, cos: f32) -> Vec3 {
        let of_glass = self.of_glass(side, |losses| losses.at(side, cos, &self.kept));
        match side {
            Side::Outside => of_glass,
            Side::Inside => of_glass + self.scattered.lost * self.scattered.passes(cos),
        }
    }

    /// The average of that over the hemisphere.
    pub fn average(&self, side: Side) -> Vec3 {
        let of_glass = self.of_glass(side, |losses| losses.average(side, &self.kept));
        match side {
            Side::Outside => of_glass,
            Side::Inside => of_glass + self.scattered.lost * self.scattered.passes_in_all(),
        }
    }

    fn of_glass(&self, side: Side, lost: impl FnOnce(&GlassLosses) -> Vec3) -> Vec3 {
        let of = |glass: &Glass| glass.colors[side as usize] * lost(&glass.losses);
        self.glass.as_ref().map_or(Vec3::ZERO, of)
    }
}

impl Scattered {
    /// What the surface above lets through to a cosine.
    fn passes(&self, cos: f32) -> f32 {
        1.0 - Albedos::get().at(self.row, cos).of(self.coat_f0, self.coat_f90)
    }

    /// The same on average.
    fn passes_in_all(&self) -> f32 {
        1.0 - Albedos::get().average(self.row).of(self.coat_f0, self.coat_f90)
    }
}
