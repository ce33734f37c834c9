//! Weights of samples: multiple importance sampling and Russian roulette.

use crate::math::Vec3;

/// The weight of a sample of density `pdf` that another strategy would have taken with density
/// `other`: the power heuristic with exponent two (Veach 1997, 9.2). A density that is infinite
/// belongs to a direction that no other strategy finds.
#[inline]
pub fn power_heuristic(pdf: f32, other: f32) -> f32 {
    if pdf == f32::INFINITY {
        return 1.0;
    }
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
}

/// The probability with which a path goes on. Radiance was scaled on its way through the borders
/// of dense media; `eta_squared` undoes that, so that the roulette sees power.
#[inline]
pub fn survival(throughput: Vec3, eta_squared: f32) -> f32 {
    (throughput.max_element() * eta_squared).min(0.95)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_two_strategies_sum_to_one() {
        for (a, b) in [(1.0, 1.0), (0.3, 7.0), (1e-20, 1e20), (0.5, 0.0), (2.0, f32::INFINITY)] {
            assert!((power_heuristic(a, b) + power_heuristic(b, a) - 1.0).abs() < 1e-6 || b == 0.0);
        }
        assert_eq!(power_heuristic(0.5, 0.0), 1.0);
        assert_eq!(power_heuristic(f32::INFINITY, 3.0), 1.0);
        assert_eq!(power_heuristic(f32::INFINITY, f32::INFINITY), 1.0);
    }

    #[test]
    fn survival_is_capped_and_sees_power() {
        assert_eq!(survival(Vec3::new(0.1, 0.5, 0.2), 1.0), 0.5);
        assert_eq!(survival(Vec3::ONE, 1.0), 0.95);
        assert_eq!(survival(Vec3::splat(0.25), 2.25), 0.5625);
    }
}
