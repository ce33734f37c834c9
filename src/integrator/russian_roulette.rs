//! Russian roulette: paths that carry little light end early, and the others make up for them.

use crate::math::Vec3;

/// Ends a path at random, or scales the throughput of one that goes on by the inverse of the
/// probability of that. Returns whether it goes on.
#[inline(always)]
pub fn survives_russian_roulette(throughput: &mut Vec3, eta_squared: f32, u: f32) -> bool {
    let survival = survival_probability(*throughput, eta_squared);
    if u >= survival {
        return false;
    }
    *throughput /= survival;
    true
}

/// The same after a scattering in a medium. Most of these are followed by many more, none of which
/// takes much: who dies at each of them with the least probability leaves few and heavy ones.
pub fn survives_scattering(throughput: &mut Vec3, eta_squared: f32, u: f32) -> bool {
    let power = throughput.max_element() * eta_squared;
    power >= 1.0 || survives_russian_roulette(throughput, eta_squared, u)
}

/// The probability with which a path goes on. Radiance was scaled on its way through the borders
/// of dense media; `eta_squared` undoes that, so that the roulette sees power.
#[inline]
fn survival_probability(throughput: Vec3, eta_squared: f32) -> f32 {
    (throughput.max_element() * eta_squared).min(0.95)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn survival_is_capped_and_sees_power() {
        assert_eq!(survival_probability(Vec3::new(0.1, 0.5, 0.2), 1.0), 0.5);
        assert_eq!(survival_probability(Vec3::ONE, 1.0), 0.95);
        assert_eq!(survival_probability(Vec3::splat(0.25), 2.25), 0.5625);
    }

    #[test]
    fn what_carries_all_light_survives_scatterings() {
        let mut throughput = Vec3::new(0.2, 1.0, 0.9);
        assert!(survives_scattering(&mut throughput, 1.0, 0.999));
        assert_eq!(throughput, Vec3::new(0.2, 1.0, 0.9));
        let mut throughput = Vec3::splat(0.5);
        assert!(!survives_scattering(&mut throughput, 1.0, 0.5));
        assert!(survives_scattering(&mut throughput, 1.0, 0.25) && throughput == Vec3::ONE);
    }
}
