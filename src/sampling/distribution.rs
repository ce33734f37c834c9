//! Tabulated densities on the unit square.

use thiserror::Error;

use crate::math::Vec2;
use crate::sampling::ONE_MINUS_EPSILON;

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

/// A density on the unit square that is constant in each cell of a grid: a row is chosen by the
/// sums of rows, then a column within it.
///
/// Densities are differences of the very tables that samples are drawn with, and so agree with them
/// to the bit, however uneven the values are.
#[derive(Clone, Debug)]
pub struct Distribution2d {
    /// One line, of `height` cells.
    rows: Lines,
    /// `height` lines of `width` cells.
    columns: Lines,
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
        let mut columns = Lines::with_capacity(width, height);
        let mut sums = Vec::with_capacity(height);
        for (row, cells) in values.chunks_exact(width).enumerate() {
            for (column, &value) in cells.iter().enumerate() {
                if !value.is_finite() || value < 0.0 {
                    return Err(DistributionError::Value { column, row, value });
                }
            }
            sums.push(columns.push(cells.iter().map(|&value| f64::from(value))));
        }
        let mut rows = Lines::with_capacity(height, 1);
        if rows.push(sums.iter().copied()) == 0.0 {
            return Err(DistributionError::AllZero);
        }
        Ok(Self { rows, columns })
    }

    /// A point of `[0, 1)^2` and its density with respect to the square's area, which is above
    /// zero.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let (row, y, row_pdf) = self.rows.sample(0, u.y);
        let (_, x, column_pdf) = self.columns.sample(row, u.x);
        (Vec2::new(x, y), row_pdf * column_pdf)
    }

    /// The density at a point of `[0, 1]^2` with respect to the square's area.
    #[inline]
    pub fn pdf(&self, point: Vec2) -> f32 {
        let row = self.rows.cell_of(point.y);
        self.rows.pdf(0, row) * self.columns.pdf(row, self.columns.cell_of(point.x))
    }
}

/// Densities on the unit interval that are constant in each of `count` even cells.
#[derive(Clone, Debug)]
struct Lines {
    count: usize,
    /// `count + 1` values from 0 to 1 for each line.
    cumulative: Vec<f32>,
    /// `buckets + 1` for each line: how many cumulative values lie in earlier buckets of the unit
    /// interval. A search then starts among a few values instead of a whole line.
    guides: Vec<u32>,
    buckets: usize,
}

impl Lines {
    fn with_capacity(count: usize, lines: usize) -> Self {
        let buckets = count.div_ceil(4);
        let cumulative = Vec::with_capacity((count + 1) * lines);
        Self { count, cumulative, guides: Vec::with_capacity((buckets + 1) * lines), buckets }
    }

    /// Appends the line of `values` and returns their sum. Where all are zero it has even cells:
    /// it is never asked, but must hold no NaN.
    fn push(&mut self, values: impl ExactSizeIterator<Item = f64> + Clone) -> f64 {
        let (count, sum) = (self.count, values.clone().sum::<f64>());
        let start = self.cumulative.len();
        self.cumulative.push(0.0);
        let mut running = 0.0;
        for (index, value) in values.enumerate() {
            running += value;
            let share = if sum > 0.0 { running / sum } else { (index + 1) as f64 / count as f64 };
            self.cumulative.push(share.min(1.0) as f32);
        }
        let line = &mut self.cumulative[start..];
        // Rounding may leave the end below one; the zeros before it then share its fate.
        let last = line[count];
        line.iter_mut().filter(|entry| **entry == last).for_each(|entry| *entry = 1.0);

        let mut below = 0;
        for bucket in 0..=self.buckets {
            let earlier = |entry: &f32| bucket_of(*entry, self.buckets) < bucket;
            below += line[below..].iter().take_while(|entry| earlier(entry)).count();
            self.guides.push(below as u32);
        }
        sum
    }

    #[inline]
    fn line(&self, line: usize) -> &[f32] {
        &self.cumulative[line * (self.count + 1)..][..=self.count]
    }

    /// The cell that holds `u`, the place of `u` in `[0, 1)` and the density there.
    #[inline]
    fn sample(&self, line: usize, u: f32) -> (usize, f32, f32) {
        let guides = &self.guides[line * (self.buckets + 1)..][..=self.buckets];
        let bucket = bucket_of(u, self.buckets).min(self.buckets - 1);
        let (from, to) = (guides[bucket] as usize, guides[bucket + 1] as usize);
        let line = self.line(line);
        // The first entry above `u` ends its cell, which therefore is never empty.
        let end = from + line[from..to].partition_point(|&entry| entry <= u);
        let cell = end.clamp(1, self.count) - 1;
        let mass = line[cell + 1] - line[cell];
        let within = ((u - line[cell]) / mass).min(ONE_MINUS_EPSILON);
        let place = (cell as f32 + within) / self.count as f32;
        let mut place = place.min(ONE_MINUS_EPSILON);
        // Rounding may carry it over an edge of the cell, where `pdf` would see another density.
        while self.cell_of(place) > cell {
            place = place.next_down();
        }
        while self.cell_of(place) < cell {
            place = place.next_up();
        }
        (cell, place, mass * self.count as f32)
    }

    #[inline]
    fn pdf(&self, line: usize, cell: usize) -> f32 {
        let line = self.line(line);
        (line[cell + 1] - line[cell]) * self.count as f32
    }

    /// The cell of a place in `[0, 1]`.
    #[inline]
    fn cell_of(&self, place: f32) -> usize {
        ((place * self.count as f32) as usize).min(self.count - 1)
    }
}

/// The bucket of a cumulative value. Any monotone function would do, so rounding does no harm.
#[inline]
fn bucket_of(value: f32, buckets: usize) -> usize {
    (value * buckets as f32) as usize
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::sampling::Sampler;
    use crate::sampling::chi_squared::assert_fits;

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
            let (point, pdf) = distribution.sample(Sampler::new(i, 0, 5).next_2d());
            let cell = (point.y * 3.0) as usize * 3 + (point.x * 3.0) as usize;
            counts[cell] += 1;
            assert!((pdf - values[cell] * 9.0 / 8.75).abs() < 1e-5);
            assert_eq!(pdf, distribution.pdf(point));
        }
        let expected = values.map(|value| f64::from(value) / 8.75 * total as f64);
        assert_fits(&counts, &expected, 1, "distribution");
    }

    proptest! {
        /// Also where values differ by more than f32 resolves, a sample is never of density zero
        /// and its density is that of its point.
        #[test]
        fn densities_agree_with_samples(
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
            let (point, pdf) = distribution.sample(Vec2::new(x, y));
            prop_assert!(pdf > 0.0 && pdf.is_finite());
            prop_assert!(point.cmpge(Vec2::ZERO).all() && point.cmplt(Vec2::ONE).all());
            prop_assert_eq!(pdf, distribution.pdf(point));
            let row = (point.y * height as f32) as usize;
            let cell = row * width + (point.x * width as f32) as usize;
            prop_assert!(values[cell] > 0.0);
            let mean: f32 = (0..width * height).map(|cell| {
                let (column, row) = (cell % width, cell / width);
                distribution.pdf(Vec2::new(
                    (column as f32 + 0.5) / width as f32, (row as f32 + 0.5) / height as f32))
            }).sum::<f32>() / (width * height) as f32;
            prop_assert!((mean - 1.0).abs() < 1e-4);
        }
    }
}
