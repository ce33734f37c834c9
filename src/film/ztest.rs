//! A test whether two noisy pictures have the same expectation.
//!
//! The pixels of a Monte Carlo picture are far from normally distributed, so tiles are pooled:
//! `z = (Σ a - Σ b) / sqrt(Σ var a + Σ var b)` per tile and channel is about N(0, 1) if the
//! expectations agree. Estimated variances are too low where rare bright paths were missed, so a
//! tile only counts as bad beyond [`LIMIT`], and the test judges the share of bad tiles.

use super::metrics::Finite;

/// Pixels along a tile's side.
pub const TILE: usize = 8;
/// The |z| beyond which a tile is bad.
pub const LIMIT: f64 = 5.0;

/// The result of the test. Equal tiles without noise count as good and are in no mean.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ZTest {
    /// The number of whole tiles; pixels beyond the last whole one belong to none.
    pub tiles: usize,
    /// The share of tiles with |z| > 5 in some channel.
    pub bad_tiles: f64,
    /// Mean of z over tiles and channels.
    pub mean: f64,
    /// Standard deviation of z over tiles and channels; 1 for correct variances.
    pub deviation: f64,
    /// The greatest |z|; infinite where something differs that has no noise.
    pub worst: f64,
    /// z of each channel of the whole picture.
    pub whole: [f64; 3],
    /// Whether one of the pictures has no variances and was taken as exact.
    pub one_is_exact: bool,
}

/// Tests an image against a reference by the variances of their pixels' means, of which at least
/// one must be known. Pixels that are not finite are left out.
///
/// # Panics
/// If the pictures are of different sizes.
pub fn ztest(
    image: (&[[f32; 3]], Option<&[[f32; 3]]>),
    reference: (&[[f32; 3]], Option<&[[f32; 3]]>),
    width: usize,
    finite: &Finite,
) -> ZTest {
    let pixels = image.0.len();
    assert!(reference.0.len() == pixels && finite.both.len() == pixels, "one size");
    let height = pixels.checked_div(width).unwrap_or(0);
    let side = TILE.min(width).min(height).max(1);
    let (mut moments, mut worst) = (Moments::default(), 0.0_f64);
    let (mut tiles, mut bad) = (0, 0);
    for y in (0..=height.saturating_sub(side)).step_by(side).take(height / side) {
        for x in (0..=width.saturating_sub(side)).step_by(side).take(width / side) {
            let mut tile = Sums::default();
            for row in y..y + side {
                for i in row * width + x..row * width + x + side {
                    tile.add(image, reference, finite, i);
                }
            }
            tiles += 1;
            let z: Vec<f64> = (0..3).filter_map(|channel| tile.z(channel)).collect();
            bad += usize::from(z.iter().any(|z| z.abs() > LIMIT));
            for &z in &z {
                worst = worst.max(z.abs());
                if z.is_finite() {
                    moments.add(z);
                }
            }
        }
    }
    let mut all = Sums::default();
    (0..pixels).for_each(|i| all.add(image, reference, finite, i));
    ZTest {
        tiles,
        bad_tiles: bad as f64 / tiles.max(1) as f64,
        mean: moments.mean(),
        deviation: moments.deviation(),
        worst,
        whole: std::array::from_fn(|channel| all.z(channel).unwrap_or(0.0)),
        one_is_exact: image.1.is_none() || reference.1.is_none(),
    }
}

/// Sums over the pixels of a tile, per channel.
#[derive(Default)]
struct Sums {
    difference: [f64; 3],
    variance: [f64; 3],
    scale: [f64; 3],
}

type WithVariance<'a> = (&'a [[f32; 3]], Option<&'a [[f32; 3]]>);

impl Sums {
    fn add(
        &mut self,
        image: WithVariance<'_>,
        reference: WithVariance<'_>,
        finite: &Finite,
        i: usize,
    ) {
        if !finite.both[i] {
            return;
        }
        for channel in 0..3 {
            let (a, b) = (f64::from(image.0[i][channel]), f64::from(reference.0[i][channel]));
            let variance = |of: Option<&[[f32; 3]]>| of.map_or(0.0, |it| f64::from(it[i][channel]));
            self.difference[channel] += a - b;
            self.variance[channel] += variance(image.1) + variance(reference.1);
            self.scale[channel] += a.abs().max(b.abs());
        }
    }

    /// `None` where there is no noise and no difference beyond rounding.
    fn z(&self, channel: usize) -> Option<f64> {
        let (difference, scale) = (self.difference[channel], self.scale[channel]);
        let rounding = 1e-6 * scale;
        if self.variance[channel] > rounding * rounding {
            return Some(difference / self.variance[channel].sqrt());
        }
        // A variance that is NaN ends here too: as good as unknown.
        (difference.abs() > 1e-4 * scale + 1e-9).then(|| difference.signum() * f64::INFINITY)
    }
}

#[derive(Default)]
struct Moments {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.squares += value * value;
    }

    fn mean(&self) -> f64 {
        self.sum / self.count.max(1.0)
    }

    fn deviation(&self) -> f64 {
        (self.squares / self.count.max(1.0) - self.mean() * self.mean()).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// About N(0, 1): twelve uniform numbers less 6, by a linear congruential generator.
    fn normals(seed: u64) -> impl FnMut() -> f32 {
        let mut state = seed;
        move || {
            let mut uniform = || {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                (state >> 40) as f32 / 16777216.0
            };
            (0..12).map(|_| uniform()).sum::<f32>() - 6.0
        }
    }

    fn noisy(seed: u64, shift: f32) -> Vec<[f32; 3]> {
        let mut normal = normals(seed);
        (0..128 * 128)
            .map(|i| {
                let shift = if i % 128 < 8 { shift } else { 0.0 };
                [1.0 + 0.1 * normal() + shift, 1.0 + 0.1 * normal(), 1.0 + 0.1 * normal()]
            })
            .collect()
    }

    #[test]
    fn equal_expectations_pass_with_a_deviation_of_one() {
        let (a, b, variance) = (noisy(1, 0.0), noisy(2, 0.0), vec![[0.01; 3]; 128 * 128]);
        let finite = Finite::of(&a, &b);
        let test = ztest((&a, Some(&variance)), (&b, Some(&variance)), 128, &finite);
        assert_eq!((test.tiles, test.bad_tiles), (256, 0.0));
        // 768 values: the mean's deviation is 0.036, the deviation's 0.026; four of each.
        assert!(test.mean.abs() < 0.15 && (test.deviation - 1.0).abs() < 0.11, "{test:?}");
        assert!(!test.one_is_exact);
    }

    #[test]
    fn a_shifted_column_of_tiles_is_found() {
        // 0.2 over a tile is 12.8 against a deviation of sqrt(2 * 64 * 0.01) = 1.13: z of 11.
        let (a, b, variance) = (noisy(1, 0.2), noisy(2, 0.0), vec![[0.01; 3]; 128 * 128]);
        let finite = Finite::of(&a, &b);
        let test = ztest((&a, Some(&variance)), (&b, Some(&variance)), 128, &finite);
        assert_eq!(test.bad_tiles, 1.0 / 16.0);
        assert!(test.whole[0] > 4.0 && test.whole[1].abs() < 4.0, "{test:?}");
    }

    #[test]
    fn without_noise_only_equality_will_do() {
        let (a, variance) = (vec![[0.5, 0.0, 1.0]; 64], vec![[0.0; 3]; 64]);
        let mut b = a.clone();
        let run = |b: &[[f32; 3]]| ztest((&a, Some(&variance)), (b, None), 8, &Finite::of(&a, b));
        assert_eq!((run(&b).bad_tiles, run(&b).worst, run(&b).one_is_exact), (0.0, 0.0, true));
        b[5] = [0.6, 0.0, 1.0];
        assert_eq!((run(&b).bad_tiles, run(&b).worst), (1.0, f64::INFINITY));
    }

    #[test]
    fn small_pictures_are_one_tile_and_ragged_edges_belong_to_none() {
        let (a, v) = (vec![[1.0; 3]; 5 * 3], vec![[0.1; 3]; 5 * 3]);
        assert_eq!(ztest((&a, Some(&v)), (&a, None), 5, &Finite::of(&a, &a)).tiles, 1);
        let (a, v) = (vec![[1.0; 3]; 20 * 17], vec![[0.1; 3]; 20 * 17]);
        assert_eq!(ztest((&a, Some(&v)), (&a, None), 20, &Finite::of(&a, &a)).tiles, 4);
        assert_eq!(ztest((&[], Some(&[])), (&[], None), 0, &Finite::of(&[], &[])).tiles, 0);
    }
}
