//! Tabulated densities on the unit square.

use thiserror::Error;

use crate::sampling::ONE_MINUS_EPSILON;
use crate::simd::lanes::{Float, Lanes, Mask, fetch};

/// Why values make no [`Distribution2d`].
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DistributionError {
    /// Not one value a cell, no cell, or more than [`Distribution2d::MOST`] along a side.
    #[error("{values} values do not fill a grid of {width} by {height}, or it is too long")]
    Size {
        /// Columns asked for.
        width: usize,
        /// Rows asked for.
        height: usize,
        /// Values given.
        values: usize,
    },
    /// A value that is negative, infinite or NaN.
    #[error("the value at column {column}, row {row} is {value}; values are finite and positive")]
    Value {
        /// Counted from 0.
        column: usize,
        /// Counted from 0.
        row: usize,
        /// The value.
        value: f32,
    },
    /// All values are zero.
    #[error("no value is above zero")]
    AllZero,
}

/// A density on the unit square that is constant in each cell of a grid, sampled by hierarchical
/// warping: block by block, down to single cells, the sums of values in the halves of a block split
/// `u.x`, and those in the halves of that half split `u.y`. What is near in the square of `u` so
/// stays near on the grid, and the strata of well spread points cover the grid well too. (By rows,
/// then columns, they scatter more.)
///
/// Clarberg, Jarosz, Akenine-Möller and Jensen, "Wavelet Importance Sampling", SIGGRAPH 2005.
#[derive(Clone, Debug)]
pub struct Distribution2d {
    /// From the whole grid down to blocks of two by two cells.
    levels: Vec<Level>,
    /// For each block of a level: the share of its left half, then those of the upper quarters in
    /// the left half and in the right. (The fourth makes it a row that lanes fetch.)
    nodes: Vec<[f32; 4]>,
    /// Mean of the values.
    mean: f64,
}

/// Blocks of one size, row by row.
#[derive(Clone, Copy, Debug)]
struct Level {
    start: u32,
    columns: u32,
}

/// A cell that was chosen, and the place within it, from 0 to 1 along both axes.
#[derive(Clone, Copy, Debug)]
pub struct CellSample<L: Lanes> {
    /// Counted from 0.
    pub column: L::Uint,
    /// Counted from 0.
    pub row: L::Uint,
    /// Place along the row.
    pub across: L::Float,
    /// Place down the column.
    pub down: L::Float,
}

impl Distribution2d {
    /// Columns or rows at most: beyond, f32 cannot tell all cells of the unit interval apart.
    pub const MOST: usize = 1 << 22;

    /// The density proportional to `values`, row by row: x runs along a row, y over rows.
    ///
    /// # Errors
    /// Where the values do not fill the grid, one is negative or not finite, or none above zero.
    pub fn new(width: usize, height: usize, values: &[f32]) -> Result<Self, DistributionError> {
        let filled = width.checked_mul(height) == Some(values.len()) && !values.is_empty();
        if !filled || width.max(height) > Self::MOST {
            return Err(DistributionError::Size { width, height, values: values.len() });
        }
        if let Some(at) = values.iter().position(|value| !value.is_finite() || *value < 0.0) {
            let (column, row, value) = (at % width, at / width, values[at]);
            return Err(DistributionError::Value { column, row, value });
        }
        let depth = width.max(height).next_power_of_two().trailing_zeros();
        let mut sums = Sums { columns: width, rows: height, values: Vec::new() };
        sums.values.extend(values.iter().map(|&value| f64::from(value)));
        let mut blocks = Vec::new();
        for _ in 0..depth {
            let (nodes, above) = sums.halved();
            blocks.push((above.columns, nodes));
            sums = above;
        }
        let mean = sums.values[0] / values.len() as f64;
        if mean == 0.0 {
            return Err(DistributionError::AllZero);
        }
        let mut levels = Vec::with_capacity(blocks.len());
        let mut nodes = Vec::with_capacity(blocks.iter().map(|(_, nodes)| nodes.len()).sum());
        for (columns, of_level) in blocks.into_iter().rev() {
            levels.push(Level { start: nodes.len() as u32, columns: columns as u32 });
            nodes.extend(of_level);
        }
        Ok(Self { levels, nodes, mean })
    }

    /// The density in a cell of a value, with respect to the square's area.
    pub fn density(&self, value: f32) -> f32 {
        (f64::from(value) / self.mean) as f32
    }

    /// A cell, with a probability in proportion to its value, and a uniform place within it, by
    /// uniform numbers in `[0, 1)`. It is never one of value zero.
    #[inline(always)]
    pub fn sample_in_lanes<L: Lanes>(&self, lanes: L, [x, y]: [L::Float; 2]) -> CellSample<L> {
        let (mut x, mut y) = (Span::new(lanes, x), Span::new(lanes, y));
        let (zero, one) = (lanes.uint(0), lanes.uint(1));
        let (mut column, mut row) = (zero, zero);
        for level in &self.levels {
            let place = row * level.columns + column + level.start;
            let [left, upper_left, upper_right, _] = fetch(lanes, &self.nodes, place);
            // Both borders before it is known which one is asked for.
            let (of_left, of_right) = (y.border(lanes, upper_left), y.border(lanes, upper_right));
            let right = x.split(x.border(lanes, left));
            let below = y.split(right.select(of_right, of_left));
            row = (row << 1) | below.select_uint(one, zero);
            column = (column << 1) | right.select_uint(one, zero);
        }
        CellSample { column, row, across: x.place(lanes), down: y.place(lanes) }
    }
}

/// The part of the unit interval that a number `u` has fallen into: `from <= u < to`. Parts that
/// are split off leave no gap, whatever rounding does to the borders between them.
struct Span<L: Lanes> {
    u: L::Float,
    from: L::Float,
    to: L::Float,
}

impl<L: Lanes> Span<L> {
    #[inline(always)]
    fn new(lanes: L, u: L::Float) -> Self {
        let (from, to) = (lanes.float(0.0), lanes.float(1.0));
        Self { u: u.most(from).least(lanes.float(ONE_MINUS_EPSILON)), from, to }
    }

    /// The end of the first `share` of it: all of it at a share of one, nothing at zero.
    #[inline(always)]
    fn border(&self, lanes: L, share: L::Float) -> L::Float {
        self.from * (lanes.float(1.0) - share) + self.to * share
    }

    /// Keeps what lies before a border or what lies after, whichever has `u`: true where it is
    /// after.
    #[inline(always)]
    fn split(&mut self, border: L::Float) -> L::Mask {
        let before = self.u.lt(border);
        self.from = before.select(self.from, border);
        self.to = before.select(border, self.to);
        !before
    }

    /// Where `u` lies in it, from 0 to 1.
    #[inline(always)]
    fn place(&self, lanes: L) -> L::Float {
        let place = (self.u - self.from) / (self.to - self.from);
        place.most(lanes.float(0.0)).least(lanes.float(1.0))
    }
}

/// A grid of sums over blocks of equal size; the last ones may reach beyond the values.
struct Sums {
    columns: usize,
    rows: usize,
    values: Vec<f64>,
}

impl Sums {
    /// The blocks of two by two of these, and their sums.
    fn halved(&self) -> (Vec<[f32; 4]>, Self) {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let at = |column: usize, row: usize| {
            let inside = column < self.columns && row < self.rows;
            if inside { self.values[row * self.columns + column] } else { 0.0 }
        };
        // A share of nothing is never asked for, but must be a number.
        let share = |of: f64, all: f64| if all > 0.0 { (of / all) as f32 } else { 0.5 };
        let (mut nodes, mut values) = (Vec::with_capacity(columns * rows), Vec::new());
        for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (2 * x, 2 * y))) {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)];
            let (left, right) = (a + c, b + d);
            let sum = left + right;
            nodes.push([share(left, sum), share(a, left), share(b, right), 0.0]);
            values.push(sum);
        }
        (nodes, Self { columns, rows, values })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::sampling::Sampler;
    use crate::sampling::chi_squared::assert_fits;
    use crate::simd::lanes::Scalar;

    /// Column and row of a sample.
    fn cell_of(distribution: &Distribution2d, u: [f32; 2]) -> (usize, usize) {
        let cell = distribution.sample_in_lanes(Scalar, u);
        assert!((0.0..=1.0).contains(&cell.across) && (0.0..=1.0).contains(&cell.down));
        (cell.column.0 as usize, cell.row.0 as usize)
    }

    #[test]
    fn bad_values_are_named() {
        let error = Distribution2d::new(2, 2, &[1.0; 3]).unwrap_err();
        assert_eq!(error, DistributionError::Size { width: 2, height: 2, values: 3 });
        assert!(Distribution2d::new(0, 0, &[]).is_err());
        assert_eq!(Distribution2d::new(1, 2, &[0.0; 2]).unwrap_err(), DistributionError::AllZero);
        let error = Distribution2d::new(2, 1, &[1.0, f32::NAN]).unwrap_err();
        assert!(matches!(error, DistributionError::Value { column: 1, row: 0, .. }));
        assert!(Distribution2d::new(2, 1, &[1.0, -0.5]).is_err());
        assert!(Distribution2d::new(2, 1, &[1.0, f32::INFINITY]).is_err());
    }

    #[test]
    fn samples_follow_the_values() {
        let values = [1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 5.0, 0.5, 0.25_f32];
        let distribution = Distribution2d::new(3, 3, &values).unwrap();
        let (total, mut counts) = (50_000_u64, [0; 9]);
        for i in 0..total {
            let (column, row) = cell_of(&distribution, Sampler::new(i, 0, 5).next_2d().to_array());
            counts[row * 3 + column] += 1;
        }
        assert!((distribution.density(2.0) - 2.0 * 9.0 / 8.75).abs() < 1e-6);
        let expected = values.map(|value| f64::from(value) / 8.75 * total as f64);
        assert_fits(&counts, &expected, 1, "distribution");
    }

    #[test]
    fn places_within_a_cell_are_uniform() {
        let values = [3.0, 0.1, 2.0, 7.0, 1.0, 0.5, 4.0, 0.0, 1.0, 2.0];
        let distribution = Distribution2d::new(5, 2, &values).unwrap();
        let mut counts = [0; 16];
        for i in 0..100_000 {
            let u = Sampler::new(i, 0, 6).next_2d().to_array();
            let cell = distribution.sample_in_lanes(Scalar, u);
            if (cell.column.0, cell.row.0) == (3, 0) {
                let (x, y) = ((cell.across * 4.0) as usize, (cell.down * 4.0) as usize);
                counts[y.min(3) * 4 + x.min(3)] += 1;
            }
        }
        let each = counts.iter().sum::<u64>() as f64 / 16.0;
        assert_fits(&counts, &[each; 16], 1, "places");
    }

    proptest! {
        /// Also where values differ by more than f32 resolves, a sample is never in a cell of value
        /// zero, nor outside the grid.
        #[test]
        fn no_sample_has_density_zero(
            width in 1_usize..9,
            seeds in prop::collection::vec(
                prop_oneof![Just(0.0), Just(1e-30), 0.0..1.0_f32, Just(1e9)], 8..64),
            x in 0.0..1.0_f32,
            y in prop_oneof![0.0..1.0_f32, Just(0.0), Just(ONE_MINUS_EPSILON)],
        ) {
            let height = seeds.len() / width;
            prop_assume!(height > 0);
            let values = &seeds[..width * height];
            prop_assume!(values.iter().any(|&value| value > 0.0));
            let distribution = Distribution2d::new(width, height, values).unwrap();
            let (column, row) = cell_of(&distribution, [x, y]);
            prop_assert!(column < width && row < height);
            let value = values[row * width + column];
            prop_assert!(value > 0.0);
            prop_assert!(distribution.density(value).is_finite());
            let mean: f32 = values.iter().map(|&value| distribution.density(value)).sum::<f32>()
                / values.len() as f32;
            prop_assert!((mean - 1.0).abs() < 1e-4);
        }
    }
}
