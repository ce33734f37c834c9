//! Multiple importance sampling: the weights of samples that two strategies may take.

/// The weight of a sample of density `pdf` that another strategy would have taken with density
/// `other`: the power heuristic with exponent two (Veach 1997, 9.2; pbrt's `PowerHeuristic`). A
/// density that is infinite belongs to a direction that no other strategy finds.
#[inline]
pub fn power_heuristic(pdf: f32, other: f32) -> f32 {
    if pdf == f32::INFINITY {
        return 1.0;
    }
    let ratio = other / pdf;
    1.0 / (1.0 + ratio * ratio)
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
}
