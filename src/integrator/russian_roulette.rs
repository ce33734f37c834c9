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
}
