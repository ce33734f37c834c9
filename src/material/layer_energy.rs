//! The light that is lost between a layer and what lies below it, and that comes back.
//!
//! Of light that goes from o to i by way of the base, a coat or cloth lets through the lesser of
//! what it lets through in either direction. So a base that reflects to where the layer lets less
//! through seems to lose light: what the layer really does is throw it back down, until it leaves
//! some other way. That share r of light from o comes back from all directions as
//! `r(o) r(i) / (π r_avg)`, as Kulla and Conty (2017) have it for light between microfacets. Of
//! solids that light passes `layer_solids` tells more.
//!
//! What layers lose is proportional to their strengths; `layer_losses` tells it for strength one.
//! Where a coat and cloth keep the shares A and B, the base's light from o to i loses
//! `(1 - A(o)) (1 - B(o)) - min(1 - A) min(1 - B) = dA + dB - (dA B(o) + dB A(o) + dA dB)`, where
//! dA is `max(0, A(i) - A(o))`: what it loses below each alone, less what that counts too much.

use std::f32::consts::FRAC_1_PI;

use super::clearcoat::{COAT_ROWS, Clearcoat};
use super::energy::{Albedo, Albedos, Row};
use super::form::BsdfForm;
use super::layer_base::Base;
use super::layer_columns::{Averaged, Curve, locate_column};
use super::layer_glass::Side;
use super::layer_losses::{
    BASES, Cell, FEW, Losses, base_rows, cloth_under_coat, rows, under_both, under_cloth,
    under_coat,
};
use super::layer_solids::Solid;
use super::metallic_roughness::MetallicRoughness;
use super::params::{SurfaceParams, saturate};
use super::sample::mean;
use super::sheen::{Fibres, Sheen};
use crate::math::Vec3;

/// A white base, by its lobes.
#[derive(Clone, Copy, Debug)]
struct WhiteBase {
    row: Row,
    f0: f32,
    f90: f32,
    coat_f0: f32,
    coat_f90: f32,
    /// Factors of the lobes that follow the cosine: of the one below the specular lobe, and of
    /// what that scatters more than once.
    below: f32,
    again: f32,
}

impl WhiteBase {
    /// The share of a surface, of which below the specular lobe the share `stays` is sent back.
    fn new(white: &MetallicRoughness, share: f32, stays: f32) -> Self {
        Self {
            row: white.row,
            f0: white.f0.max_element() * share,
            f90: white.f90 * share,
            coat_f0: white.coat_f0,
            coat_f90: white.coat_f90,
            below: white.diffuse.x * white.coat_scale * stays * share,
            again: white.multiple.x * white.multiple_scale * share,
        }
    }

    /// What is lost of the lobes that follow the cosine: below the specular one, and again.
    fn diffuse(&self, losses: &Losses) -> [f32; 2] {
        let below = losses.diffuse - losses.dimmed.of(self.coat_f0, self.coat_f90);
        [below, losses.diffuse - losses.dimmed.of(1.0, 1.0)]
    }

    /// What it loses at a cosine, if its lobes lose that.
    fn lost(&self, cos: f32, losses: &Losses) -> f32 {
        let albedo = Albedos::get().at(self.row, cos);
        let through = 1.0 - albedo.of(self.coat_f0, self.coat_f90);
        let [below, again] = self.diffuse(losses);
        let diffuse = self.below * through * below + self.again * albedo.loss() * again;
        (losses.lobe.of(self.f0, self.f90) + diffuse).max(0.0)
    }

    /// The average of that over the hemisphere, from those of [`Cell::averages`].
    fn average(&self, averages: &[Losses; 3]) -> f32 {
        let [one, f0, f90] = averages;
        let of = |coat_f0: f32, coat_f90: f32, lobe: usize| {
            let [one, f0, f90] = [one, f0, f90].map(|losses| self.diffuse(losses)[lobe]);
            one - Albedo { f0, f90 }.of(coat_f0, coat_f90)
        };
        let below = self.below * of(self.coat_f0, self.coat_f90, 0);
        let diffuse = below + self.again * of(1.0, 1.0, 1);
        (one.lobe.of(self.f0, self.f90) + diffuse).max(0.0)
    }
}

/// Where a layer lies in tables: among all rows, and among [`FEW`].
#[derive(Clone, Copy, Debug)]
struct Place {
    strength: f32,
    rows: [(usize, f32); 2],
    few: [(usize, f32); 2],
}

impl Place {
    fn new<const N: usize>(strength: f32, place: f32) -> Self {
        let few = rows::<FEW>(place * ((FEW - 1) as f32 / (N - 1) as f32));
        Self { strength, rows: rows::<N>(place), few }
    }
}

/// What comes back of the light that layers lose: on the outside of what is opaque, on either side
/// of sheets, where it leaves as the base's light does, and on both sides of solids.
#[derive(Clone, Copy, Debug)]
pub(super) struct Returned {
    base: WhiteBase,
    /// Rows of the base, the weight of each, and that of its specular lobe.
    base_rows: [(usize, f32, f32); 2],
    base_color: Vec3,
    /// The part of that which leaves a sheet by the other side.
    through: Vec3,
    solid: Option<Solid>,
    coat: Option<Place>,
    cloth: Option<Place>,
    cloth_color: Vec3,
    /// The average share over the hemisphere, outside and inside of what is solid, by how dense
    /// radiance is there.
    averages: [Vec3; 2],
}

impl Returned {
    /// That of a base, as `params` describe it, under a coat and cloth.
    pub fn new(
        params: &SurfaceParams,
        base: &Base,
        coat: Option<&Clearcoat>,
        cloth: Option<&Sheen>,
    ) -> Self {
        let is_solid = base.transmits() && !params.thin;
        let (glass_share, is_delta) =
            base.clear_part().map_or((0.0, true), |(glass, share)| (share, glass.is_delta()));
        // What a rough sheet of glass reflects and lets through is together what metal reflects.
        let like_metal = if is_solid || is_delta { 0.0 } else { glass_share };
        let share = 1.0 - glass_share + like_metal;
        let metallic = saturate((saturate(params.metallic) + like_metal) / share);
        let white = SurfaceParams { base_color: Vec3::ONE, metallic, ..*params };
        let white = MetallicRoughness::new(&white, BsdfForm::Conserving);
        let passes = is_solid && base.scatters_through();
        let stays = if passes { 1.0 - saturate(params.diffuse_transmission) } else { 1.0 };
        let colors = if is_solid {
            let opaque = SurfaceParams { metallic, ..*params };
            [MetallicRoughness::new(&opaque, BsdfForm::Conserving).albedo(), Vec3::ZERO]
        } else {
            base.scattered()
        };
        let [base_color, through] = colors.map(|color| color.min(Vec3::ONE));
        let solid = is_solid.then(|| Solid::new(params, base, (&white, share), coat, cloth));
        let [(row, low), (next, high)] = rows::<BASES>(2.0 * white.row.place());
        let [(_, low_lobe), (_, high_lobe)] = base_rows(white.alpha);
        let coat = coat.map(|coat| Place::new::<COAT_ROWS>(coat.strength(), coat.place()));
        let mut made = Self {
            base: WhiteBase::new(&white, share, stays),
            base_rows: [(row, low, low_lobe), (next, high, high_lobe)],
            base_color,
            through: through.min(base_color),
            solid,
            coat,
            cloth: cloth
                .map(|cloth| Place::new::<{ Fibres::ROWS }>(cloth.strength(), cloth.place())),
            cloth_color: cloth.map_or(Vec3::ZERO, Sheen::color),
            averages: [Vec3::ZERO; 2],
        };
        made.averages = made.averages();
        made
    }

    fn averages(&self) -> [Vec3; 2] {
        let (mut losses, mut of_cloth) = ([Losses::default(); 3], 0.0);
        self.each_cell(|cell, weight, lobe_weight| {
            for (sum, average) in losses.iter_mut().zip(&cell.averages) {
                sum.add(average, weight, lobe_weight);
            }
        });
        self.each_curve(|averaged, weight| of_cloth += averaged.average * weight);
        let outside = self.colored(self.base.average(&losses), of_cloth);
        let Some(solid) = &self.solid else { return [outside, Vec3::ZERO] };
        let inside = solid.average(Side::Inside) * solid.density;
        [outside + solid.average(Side::Outside), inside]
    }

    /// Calls `put` with each cell of what the base loses, its weight and that of specular lobes.
    #[inline]
    fn each_cell(&self, mut put: impl FnMut(&Cell, f32, f32)) {
        for (base, weight, lobe_weight) in self.base_rows {
            let mut put = |cell: &Cell, share: f32| put(cell, share * weight, share * lobe_weight);
            if let Some(coat) = &self.coat {
                for (row, share) in coat.rows {
                    put(under_coat(row, base), coat.strength * share);
                }
            }
            if let Some(cloth) = &self.cloth {
                for (row, share) in cloth.rows {
                    put(under_cloth(row, base), cloth.strength * share);
                }
            }
            self.each_pair(|coat, cloth, share| put(under_both(coat, cloth, base), -share));
        }
    }

    /// The same of what cloth loses of what it scatters, white and at its strongest.
    #[inline]
    fn each_curve(&self, mut put: impl FnMut(&Averaged, f32)) {
        let Some(cloth) = &self.cloth else { return };
        for (row, share) in cloth.rows {
            put(&Fibres::of(row).lost, share);
        }
        let strength = cloth.strength.max(1e-9);
        self.each_pair(|coat, cloth, share| put(cloth_under_coat(coat, cloth), share / strength));
    }

    /// Calls `put` with places of a coat and of cloth, if both are there, and weights.
    #[inline]
    fn each_pair(&self, mut put: impl FnMut(usize, usize, f32)) {
        let (Some(coat), Some(cloth)) = (&self.coat, &self.cloth) else { return };
        let strength = coat.strength * cloth.strength;
        for (coat, coat_share) in coat.few {
            for (cloth, share) in cloth.few {
                put(coat, cloth, strength * coat_share * share);
            }
        }
    }

    fn colored(&self, of_base: f32, of_cloth: f32) -> Vec3 {
        self.base_color * of_base + self.cloth_color * of_cloth.max(0.0)
    }

    /// The share of light that all layers on a solid keep.
    pub fn kept(&self) -> Option<&Curve> {
        self.solid.as_ref().map(|solid| &solid.kept)
    }

    /// The share of light from a direction that comes back so, by colour.
    pub fn albedo(&self, w: Vec3) -> Vec3 {
        let (side, cos) = (Side::of(w), w.z.abs());
        match &self.solid {
            None => self.lost_outside(cos),
            Some(solid) if side == Side::Inside => solid.lost(side, cos),
            Some(solid) => self.lost_outside(cos) + solid.lost(side, cos),
        }
    }

    fn lost_outside(&self, cos: f32) -> Vec3 {
        let (j, t) = locate_column(cos);
        let (mut losses, mut of_cloth) = (Losses::default(), 0.0);
        self.each_cell(|cell, weight, lobe_weight| {
            losses.add(&cell.columns[j], weight * (1.0 - t), lobe_weight * (1.0 - t));
            losses.add(&cell.columns[j + 1], weight * t, lobe_weight * t);
        });
        self.each_curve(|Averaged { curve, .. }, weight| {
            of_cloth += weight * (curve[j] + (curve[j + 1] - curve[j]) * t);
        });
        self.colored(self.base.lost(cos, &losses), of_cloth)
    }

    /// What comes back from `wo` to `wi`, times the cosine, and its density: that of the cosine on
    /// either side, by [`Self::inside_probability`]. `view` is the share of light from the viewer's
    /// direction that comes back.
    pub fn eval(&self, view: Vec3, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let least = Vec3::splat(1e-9);
        let inside = self.inside_probability();
        let probability = if wi.z < 0.0 { inside } else { 1.0 - inside };
        let density = wi.z.abs() * FRAC_1_PI;
        let [outside, within] = self.averages;
        let shares = view * self.albedo(wi) / (outside + within).max(least);
        let factor = match &self.solid {
            Some(solid) if wo.z < 0.0 => Vec3::splat(solid.density),
            Some(_) => Vec3::ONE,
            None => {
                let through = self.through / self.base_color.max(least);
                if wi.z < 0.0 { through } else { Vec3::ONE - through }
            }
        };
        (shares * factor * density, density * probability)
    }

    /// Of what comes back, the share that leaves to the inside of a solid, or by the other side of
    /// a sheet.
    pub fn inside_probability(&self) -> f32 {
        let [outside, inside] = self.averages.map(mean);
        match self.solid {
            Some(_) => inside / (outside + inside).max(1e-9),
            None => mean(self.through) / mean(self.base_color).max(1e-9),
        }
    }
}
