//! The light that is lost between a layer and what lies below it, and that comes back.
//!
//! Of light that goes from o to i by way of the base, a coat or cloth lets through the lesser of
//! what it lets through in either direction. So a base that reflects to where the layer lets less
//! through seems to lose light: what the layer really does is throw it back down, until it leaves
//! some other way. That share r of light from o comes back from all directions as
//! `r(o) r(i) / (π r_avg)`, as Kulla and Conty (2017) have it for light between microfacets.
//!
//! What layers lose is proportional to their strengths; `layer_losses` tells it for strength one.
//! Where a coat and cloth keep the shares A and B, the base's light from o to i loses
//! `(1 - A(o)) (1 - B(o)) - min(1 - A) min(1 - B) = dA + dB - (dA B(o) + dB A(o) + dA dB)`, where
//! dA is `max(0, A(i) - A(o))`: what it loses below each alone, less what that counts too much.

use std::f32::consts::FRAC_1_PI;

use super::clearcoat::{COAT_ROWS, Clearcoat};
use super::energy::{Albedo, Albedos, Row, locate_cell, node_alpha};
use super::form::BsdfForm;
use super::layer_columns::{Averaged, locate_column};
use super::layer_losses::{
    BASES, Cell, FEW, Losses, cloth_under_coat, under_both, under_cloth, under_coat,
};
use super::metallic_roughness::MetallicRoughness;
use super::params::SurfaceParams;
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
    fn new(white: &MetallicRoughness) -> Self {
        Self {
            row: white.row,
            f0: white.f0.max_element(),
            f90: white.f90,
            coat_f0: white.coat_f0,
            coat_f90: white.coat_f90,
            below: white.diffuse.x * white.coat_scale,
            again: white.multiple.x * white.multiple_scale,
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

/// The two rows of a table of `N` rows between which a place lies, and the weight of each.
fn rows<const N: usize>(place: f32) -> [(usize, f32); 2] {
    let (row, t) = locate_cell::<N>(place);
    [(row, 1.0 - t), (row + 1, t)]
}

/// A row of the base, its weight, and that of its specular lobe, whose losses are proportional to
/// alpha where it is narrow.
type BaseRow = (usize, f32, f32);

fn base_rows(white: &MetallicRoughness) -> [BaseRow; 2] {
    let [(row, low), (next, high)] = rows::<BASES>(2.0 * white.row.place());
    let [first, last] = [row, next].map(|row| node_alpha(row, BASES));
    let t = ((white.alpha - first) / (last - first)).clamp(0.0, 1.0);
    [(row, low, 1.0 - t), (next, high, t)]
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

/// What comes back of the light that layers lose, on the outside of what is opaque, or on either
/// side of a sheet that lets light through scattered: then it leaves as the base's light does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Returned {
    base: WhiteBase,
    base_rows: [BaseRow; 2],
    base_color: Vec3,
    /// The part of that which leaves by the other side.
    through: Vec3,
    coat: Option<Place>,
    cloth: Option<Place>,
    cloth_color: Vec3,
    /// The average share over the hemisphere.
    average: Vec3,
}

impl Returned {
    /// That of a base, as `params` describe it, under a coat and cloth; by colour, what the base
    /// scatters in all, and what of it goes through.
    pub fn new(
        params: &SurfaceParams,
        [base_color, through]: [Vec3; 2],
        coat: Option<&Clearcoat>,
        cloth: Option<&Sheen>,
    ) -> Self {
        let white = SurfaceParams { base_color: Vec3::ONE, diffuse_transmission: 0.0, ..*params };
        let white = MetallicRoughness::new(&white, BsdfForm::Conserving);
        let coat = coat.map(|coat| Place::new::<COAT_ROWS>(coat.strength(), coat.place()));
        let mut made = Self {
            base: WhiteBase::new(&white),
            base_rows: base_rows(&white),
            base_color,
            through: through.min(base_color),
            coat,
            cloth: cloth
                .map(|cloth| Place::new::<{ Fibres::ROWS }>(cloth.strength(), cloth.place())),
            cloth_color: cloth.map_or(Vec3::ZERO, Sheen::color),
            average: Vec3::ZERO,
        };
        let (mut losses, mut of_cloth) = ([Losses::default(); 3], 0.0);
        made.each_cell(|cell, weight, lobe_weight| {
            for (sum, average) in losses.iter_mut().zip(&cell.averages) {
                sum.add(average, weight, lobe_weight);
            }
        });
        made.each_curve(|averaged, weight| of_cloth += averaged.average * weight);
        made.average = made.colored(made.base.average(&losses), of_cloth);
        made
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

    /// The share of light from a direction that comes back so, by colour.
    pub fn albedo(&self, cos: f32) -> Vec3 {
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

    /// What comes back, times the cosine, and its density: that of the cosine on either side, by
    /// [`Self::through_probability`]. `view` is the share of light from the viewer's direction that
    /// comes back.
    pub fn eval(&self, view: Vec3, wi: Vec3) -> (Vec3, f32) {
        let cos = wi.z.abs();
        let shares = view * self.albedo(cos) / self.average.max(Vec3::splat(1e-9));
        let through = self.through / self.base_color.max(Vec3::splat(1e-9));
        let probability = self.through_probability();
        let (side, probability) = if wi.z < 0.0 {
            (through, probability)
        } else {
            (Vec3::ONE - through, 1.0 - probability)
        };
        let density = cos * FRAC_1_PI;
        (shares * side * density, density * probability)
    }

    /// Of what comes back, the share that leaves by the other side.
    pub fn through_probability(&self) -> f32 {
        mean(self.through) / mean(self.base_color).max(1e-9)
    }
}
