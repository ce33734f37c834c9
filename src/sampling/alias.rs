//! Discrete distributions in constant time.

use thiserror::Error;

use super::ONE_MINUS_EPSILON;

/// Why weights make no [`AliasTable`].
#[derive(Clone, Debug, Error, PartialEq)]
pub enum AliasError {
    /// A weight that is negative, infinite or NaN.
    #[error("weight {index} is {weight}; weights are finite and at least zero")]
    Weight {
        /// Of the weight.
        index: usize,
        /// The weight.
        weight: f64,
    },
    /// No weight, or all of them zero.
    #[error("no weight is above zero")]
    Empty,
    /// More entries than 32 bits count.
    #[error("{0} weights are too many; the limit is 2^32 - 1")]
    TooMany(usize),
}

/// Chooses an index with probability proportional to its weight, in constant time.
///
/// Walker's method with tables filled by Vose, "A Linear Algorithm for Generating Random Numbers
/// with a Given Distribution", IEEE TSE 1991: a slot is chosen evenly, then the slot's own index or
/// its alias. Deterministic: the tables depend on the weights alone.
#[derive(Clone, Debug)]
pub struct AliasTable {
    slots: Vec<Slot>,
}

#[derive(Clone, Copy, Debug)]
struct Slot {
    /// Share of the slot that stays with its own index.
    keep: f32,
    alias: u32,
    /// Of the slot's own index.
    pmf: f32,
}

impl AliasTable {
    /// The table for `weights`.
    ///
    /// # Errors
    /// Where a weight is negative or not finite, or none is above zero.
    pub fn new(weights: &[f64]) -> Result<Self, AliasError> {
        let count = weights.len();
        if u32::try_from(count).is_err() {
            return Err(AliasError::TooMany(count));
        }
        for (index, &weight) in weights.iter().enumerate() {
            if !weight.is_finite() || weight < 0.0 {
                return Err(AliasError::Weight { index, weight });
            }
        }
        // Scaled first, so that no sum overflows.
        let largest = weights.iter().copied().fold(0.0, f64::max);
        if largest == 0.0 {
            return Err(AliasError::Empty);
        }
        let sum: f64 = weights.iter().map(|weight| weight / largest).sum();
        let pmf = |index: usize| weights[index] / largest / sum;

        let slot = |index| Slot { keep: 1.0, alias: index as u32, pmf: pmf(index) as f32 };
        let mut slots: Vec<Slot> = (0..count).map(slot).collect();
        let mut left: Vec<f64> = (0..count).map(|index| pmf(index) * count as f64).collect();
        let (mut small, mut large): (Vec<usize>, Vec<usize>) =
            (0..count).partition(|&index| left[index] < 1.0);
        while let (Some(&below), Some(&above)) = (small.last(), large.last()) {
            small.pop();
            slots[below].keep = left[below] as f32;
            slots[below].alias = above as u32;
            left[above] = (left[above] + left[below]) - 1.0;
            if left[above] < 1.0 {
                large.pop();
                small.push(above);
            }
        }
        // What is left over differs from one by rounding alone, unless its weight is zero, and
        // such an index must never come up.
        let heaviest = (0..count).max_by(|&a, &b| weights[a].total_cmp(&weights[b])).unwrap_or(0);
        for index in small {
            if weights[index] == 0.0 {
                slots[index].keep = 0.0;
                slots[index].alias = heaviest as u32;
            }
        }
        Ok(Self { slots })
    }

    /// An index and its probability, for `u` in `[0, 1)`.
    ///
    /// `u` has some 24 bits, which choose both the slot and its half: for more than some 10^5
    /// entries the odds between a slot's two halves are rounded visibly.
    #[inline]
    pub fn sample(&self, u: f32) -> (usize, f32) {
        let (index, pmf, _) = self.sample_and_reuse(u);
        (index, pmf)
    }

    /// The same, and where `u` lies in the share that chose the index: a number in `[0, 1)` again.
    #[inline(always)]
    pub fn sample_and_reuse(&self, u: f32) -> (usize, f32, f32) {
        let scaled = f64::from(u) * self.slots.len() as f64;
        let index = (scaled as usize).min(self.slots.len() - 1);
        let slot = self.slots[index];
        let rest = (scaled - index as f64) as f32;
        if rest < slot.keep {
            (index, slot.pmf, (rest / slot.keep).min(ONE_MINUS_EPSILON))
        } else {
            let (alias, rest) = (slot.alias as usize, (rest - slot.keep) / (1.0 - slot.keep));
            (alias, self.slots[alias].pmf, rest.min(ONE_MINUS_EPSILON))
        }
    }

    /// The probability of `index`; zero where there is no such index.
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        self.slots.get(index).map_or(0.0, |slot| slot.pmf)
    }

    /// How many indices there are.
    #[inline]
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// Never: a table has at least one entry.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The probability of each index as the tables realise it.
    fn realised(table: &AliasTable) -> Vec<f64> {
        let mut probability = vec![0.0; table.len()];
        for (index, slot) in table.slots.iter().enumerate() {
            let keep = f64::from(slot.keep);
            probability[index] += keep / table.len() as f64;
            probability[slot.alias as usize] += (1.0 - keep) / table.len() as f64;
        }
        probability
    }

    #[test]
    fn bad_weights_are_named() {
        assert_eq!(AliasTable::new(&[]).unwrap_err(), AliasError::Empty);
        assert_eq!(AliasTable::new(&[0.0, 0.0]).unwrap_err(), AliasError::Empty);
        let error = AliasTable::new(&[1.0, -1.0]).unwrap_err();
        assert_eq!(error, AliasError::Weight { index: 1, weight: -1.0 });
        assert!(AliasTable::new(&[f64::NAN]).is_err());
        assert!(AliasTable::new(&[1e308, 1e308, 1e308]).is_ok());
    }

    #[test]
    fn a_sweep_of_u_meets_each_index_as_often_as_its_weight_says() {
        let table = AliasTable::new(&[1.0, 0.0, 5.0, 2.0]).unwrap();
        let mut counts = [0; 4];
        for i in 0..8000 {
            let (index, pmf) = table.sample((i as f32 + 0.5) / 8000.0);
            counts[index] += 1;
            assert_eq!(pmf, table.pmf(index));
        }
        assert_eq!(counts, [1000, 0, 5000, 2000]);
        assert_eq!(table.pmf(2), 0.625);
        assert_eq!(table.pmf(4), 0.0);
    }

    proptest! {
        #[test]
        fn the_tables_realise_the_weights(
            weights in prop::collection::vec(prop_oneof![Just(0.0), 1e-6..1e6_f64], 1..200)
        ) {
            prop_assume!(weights.iter().any(|&weight| weight > 0.0));
            let table = AliasTable::new(&weights).unwrap();
            let sum: f64 = weights.iter().sum();
            for (index, probability) in realised(&table).into_iter().enumerate() {
                let expected = weights[index] / sum;
                prop_assert!((probability - expected).abs() < 1e-6, "{index}");
                prop_assert!((f64::from(table.pmf(index)) - expected).abs() < 1e-7);
                prop_assert!(expected > 0.0 || probability == 0.0);
            }
        }
    }
}
