//! What several kinds of objects of a document have in common.

use serde_json::Value;

/// The object with a name, if that is not empty.
pub fn named(name: &str, mut object: Value) -> Value {
    if !name.is_empty() {
        object["name"] = name.into();
    }
    object
}

/// The least power of two that is at least `x`, but never below 1; 2^127, the largest, beyond it.
pub fn next_power_of_two(x: f32) -> f32 {
    let mut power = 1.0_f32;
    while power < x && power < 1e38 {
        power *= 2.0;
    }
    power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strength_is_divided_out_exactly() {
        let powers = [0.0, 0.3, 1.0, 1.1, f32::MAX].map(next_power_of_two);
        assert_eq!(powers, [1.0, 1.0, 1.0, 2.0, libm::exp2f(127.0)]);
        for x in [0.3, 1.0, 1.1, 17.0, 1e30] {
            let power = next_power_of_two(x);
            assert!(power >= x && x / power * power == x, "{x} {power}");
        }
    }
}
