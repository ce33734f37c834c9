//! What rough glass scatters more than once between its microfacets.
//!
//! As Kulla and Conty have it ("Revisiting Physically Based Shading at Imageworks", 2017): the
//! share `1 - E` of light that one bounce loses comes back from all directions in proportion to
//! what these lose, `(1 - E(o)) (1 - E(i)) / (π (1 - E_avg))`, with the albedo E and its average
//! of the side where it comes back. A share x of it passes to the other side. Light takes the same
//! way back, if
//!
//! `x / (1 - E_avg of the other side) = eta² * x' / (1 - E_avg of this side)`,
//!
//! where x' is the share that passes from there. With `x = k (1 - F) (1 - E_avg of the other side)`
//! it does: F is the average reflectance of the boundary, for which `1 - F = eta² (1 - F')`, and k,
//! which is the same for both sides, is as great as x and x' allow.

use std::f32::consts::{FRAC_1_PI, PI};

use super::boundary::Boundary;
use super::energy::{Albedo, Albedos, Row};
use super::glass_energy::GlassRow;
use super::sample::mean;
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Averages that are less lose nothing that a picture shows.
pub(super) const LEAST_LOSS: f32 = 1e-5;

/// The lobe, for a direction of view; local, on the side of `+Z`.
pub struct Multiple<'a> {
    boundary: &'a Boundary,
    sides: Sides,
    /// What one bounce loses of the viewer's light, times what of it comes back on this side and on
    /// the other one, over the average loss there.
    reflected: Vec3,
    transmitted: Vec3,
    /// The probability with which the lobe is sampled, and, if it is, the other side.
    pub probability: f32,
    across: f32,
    /// What radiance is divided by beyond the boundary.
    eta_squared: f32,
}

/// The share of what a solid's facets lose on one side that comes back on the other; `averages` are
/// the losses of both.
pub(super) fn across(boundary: &Boundary, eta: f32, averages: [Vec3; 2]) -> Vec3 {
    let passes = boundary.average_transmittance(eta);
    let limit = averages[0].max(averages[1]).max(Vec3::splat(LEAST_LOSS));
    passes * averages[1] / limit
}

/// Where losses are looked up.
enum Sides {
    /// Of a solid: on the viewer's side and on the other one.
    Solid([GlassRow; 2]),
    /// Of a sheet, whose sides are alike.
    Sheet(Row),
}

impl<'a> Multiple<'a> {
    /// That of a solid; `eta` is the index beyond the boundary over that before it.
    pub fn of_solid(boundary: &'a Boundary, eta: f32, cos: f32) -> Self {
        let sides = [eta, 1.0 / eta].map(|eta| GlassRow::of(boundary.alpha, eta));
        let loss = boundary.loss(sides[0].at(cos));
        let averages = sides.map(|side| boundary.loss(side.average()));
        let across = across(boundary, eta, averages);
        let parts = (Sides::Solid(sides), loss, averages, across);
        Self::new(boundary, parts, eta * eta)
    }

    /// That of a sheet.
    pub fn of_sheet(boundary: &'a Boundary, cos: f32) -> Self {
        let (table, row) = (Albedos::get(), Row::of(boundary.alpha));
        let [loss, average] = [table.at(row, cos), table.average(row)].map(Albedo::loss);
        let across = boundary.average_transmittance_of_sheet();
        let (loss, average) = (Vec3::splat(loss), Vec3::splat(average));
        Self::new(boundary, (Sides::Sheet(row), loss, [average; 2], across), 1.0)
    }

    fn new(
        boundary: &'a Boundary,
        (sides, loss, averages, across): (Sides, Vec3, [Vec3; 2], Vec3),
        eta_squared: f32,
    ) -> Self {
        let over = |share: Vec3, average: Vec3| {
            let usable = average.cmpge(Vec3::splat(LEAST_LOSS));
            Vec3::select(usable, share / average, Vec3::ZERO)
        };
        let reflected = over((Vec3::ONE - across) * loss, averages[0]);
        let transmitted = over(across * loss, averages[1]) * boundary.tint;
        let stays = mean(loss * (Vec3::ONE - across));
        let passes = mean(loss * across * boundary.tint);
        let probability = (stays + passes).clamp(0.0, 1.0);
        let across = if probability > 0.0 { passes / (stays + passes) } else { 0.0 };
        Self { boundary, sides, reflected, transmitted, probability, across, eta_squared }
    }

    /// What is scattered in a direction of that cosine, times the cosine, and its density.
    pub fn eval(&self, cos: f32) -> (Vec3, f32) {
        let (here, beyond) = (cos > 0.0, cos.abs());
        let loss = match &self.sides {
            Sides::Solid(sides) => self.boundary.loss(sides[usize::from(!here)].at(beyond)),
            Sides::Sheet(row) => Vec3::splat(Albedos::get().at(*row, beyond).loss()),
        };
        let density = beyond * FRAC_1_PI * self.probability;
        let value = loss * (beyond / PI);
        if here {
            (value * self.reflected, density * (1.0 - self.across))
        } else {
            (value * self.transmitted / self.eta_squared, density * self.across)
        }
    }

    /// Samples a direction; `u_side` chooses the side.
    pub fn sample(&self, u_side: f32, u: Vec2) -> Vec3 {
        let w = warp::cosine_hemisphere(u);
        if u_side < self.across { Vec3::new(w.x, w.y, -w.z) } else { w }
    }
}
