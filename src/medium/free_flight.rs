//! How far light flies before it scatters: spectral multiple importance sampling.
//!
//! Wilkie et al., "Hero Wavelength Spectral Sampling", EGSR 2014, over the three colours: one of
//! them, the hero, draws the distance, and the sample is weighed by the mean of the densities with
//! which each of them would have drawn it, along the whole path. Which one has been the hero so far
//! need not be remembered: it is drawn anew for each leg with the probability that the path tells.

use super::medium::Medium;
use crate::math::{Vec2, Vec3};

/// Light in a medium, of whose path the colours would have drawn the legs so far with densities in
/// these proportions; their mean is one.
#[derive(Clone, Copy, Debug)]
pub struct FreeFlight<'a> {
    /// Where it flies.
    pub medium: &'a Medium,
    /// The proportions.
    pub densities: Vec3,
}

/// A leg of a path in a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Where it scatters, metres from its start; `None`: not before its end.
    pub scatters_at: Option<f32>,
    /// What the light is multiplied with, by colour: the share of what is scattered or passes over
    /// the density.
    pub weight: Vec3,
    /// The new proportions of the colours' densities.
    pub densities: Vec3,
    /// The probability with which it passes, where it does.
    pub passes: f32,
}

impl FreeFlight<'_> {
    /// A leg of up to `distance` metres, which may be infinite; `u` chooses the hero and where it
    /// scatters. `None` where the numbers underflow: such a leg is never drawn.
    #[inline]
    pub fn sample(&self, distance: f32, u: Vec2) -> Option<Leg> {
        let (extinction, densities) = (self.medium.extinction(), self.densities);
        let place = u.x * (densities.x + densities.y + densities.z);
        let hero = if place < densities.x {
            extinction.x
        } else if place < densities.x + densities.y || densities.z <= 0.0 {
            extinction.y
        } else {
            extinction.z
        };
        let flight = if hero > 0.0 { -libm::log1pf(-u.y) / hero } else { f32::INFINITY };
        let scatters = flight < distance;
        let left = self.medium.transmittance(if scatters { flight } else { distance });
        // The share that goes on, and the density of this end, of each colour.
        let (share, drawn) = if scatters {
            (extinction * left * self.medium.albedo(), extinction * left)
        } else {
            (left, left)
        };
        let drawn = drawn * densities;
        let mean = (drawn.x + drawn.y + drawn.z) * (1.0 / 3.0);
        let leg = Leg {
            scatters_at: scatters.then_some(flight),
            weight: share / mean,
            densities: drawn / mean,
            passes: if scatters { 0.0 } else { mean },
        };
        (leg.weight.is_finite() && leg.densities.is_finite()).then_some(leg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;

    const MEDIUM: (Vec3, Vec3) = (Vec3::new(0.2, 1.0, 5.0), Vec3::new(1.0, 0.5, 0.9));

    /// The mean weight of the legs that pass is the transmittance, and that of those that scatter
    /// the albedo of what is left, for each colour and whatever the proportions.
    #[test]
    fn weights_are_those_of_each_colour() {
        let medium = Medium::new(MEDIUM.0, MEDIUM.1, 0.0);
        for densities in [Vec3::ONE, Vec3::new(2.5, 0.5, 0.0), Vec3::new(0.0, 0.0, 3.0)] {
            let flight = FreeFlight { medium: &medium, densities };
            let (mut passed, mut scattered) = (Vec3::ZERO, Vec3::ZERO);
            let count = 400_000;
            for i in 0..count {
                let u = Sampler::independent(i, 1, 4).next_2d();
                let leg = flight.sample(0.75, u).expect("no underflow");
                let mean = (leg.densities.x + leg.densities.y + leg.densities.z) / 3.0;
                assert!((mean - 1.0).abs() < 1e-5);
                let sum = if leg.scatters_at.is_some() { &mut scattered } else { &mut passed };
                *sum += leg.weight / count as f32;
            }
            let through = medium.transmittance(0.75);
            let expected = medium.albedo() * (Vec3::ONE - through);
            // A colour that no hero of the path's could have been is found by the others alone:
            // the weights are bounded where its own density counts.
            let counts = densities.map(|density| f32::from(density > 0.0));
            assert!(((passed - through) * counts).abs().max_element() < 0.01, "{passed}");
            assert!(((scattered - expected) * counts).abs().max_element() < 0.01, "{scattered}");
        }
    }

    #[test]
    fn nothing_passes_an_endless_medium() {
        let medium = Medium::new(Vec3::ONE, Vec3::ONE, 0.0);
        let flight = FreeFlight { medium: &medium, densities: Vec3::ONE };
        for i in 0..1000 {
            let u = Sampler::independent(i, 2, 4).next_2d();
            let leg = flight.sample(f32::INFINITY, u).expect("no underflow");
            // Three sums and products are rounded.
            let off = (leg.weight - Vec3::ONE).abs().max_element();
            assert!(leg.scatters_at.is_some() && off <= 2.0 * f32::EPSILON, "{leg:?}");
        }
    }

    #[test]
    fn odd_numbers_are_left_out() {
        for extinction in [1e-38, 1e-20, 1e12] {
            let medium = Medium::new(Vec3::new(extinction, 0.0, 1.0), Vec3::ONE, 0.0);
            let flight = FreeFlight { medium: &medium, densities: Vec3::ONE };
            for i in 0..1000 {
                let u = Sampler::independent(i, 3, 4).next_2d();
                for distance in [0.0, 1e-30, 1.0, 1e30, f32::INFINITY] {
                    if let Some(leg) = flight.sample(distance, u) {
                        assert!(leg.weight.is_finite() && leg.weight.min_element() >= 0.0);
                    }
                }
            }
        }
    }
}
