//! Error metrics of two pictures, pixel by pixel.
//!
//! A pixel that is not finite in either picture is left out of all figures, and counted:
//! [`NotFinite`].

/// Which pixels are finite in both pictures, and how many are not in which.
#[derive(Clone, Debug, PartialEq)]
pub struct Finite {
    /// For each pixel, whether all three channels are finite in both pictures.
    pub both: Vec<bool>,
    /// How many pixels are not.
    pub counts: NotFinite,
}

/// Pixels with a NaN or an infinity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct NotFinite {
    /// In the image.
    pub image: usize,
    /// In the reference.
    pub reference: usize,
    /// In one of them only.
    pub only_one: usize,
}

impl Finite {
    /// Examines two pictures of one size.
    pub fn of(image: &[[f32; 3]], reference: &[[f32; 3]]) -> Self {
        let mut counts = NotFinite::default();
        let sound = |pixel: &[f32; 3]| pixel.iter().all(|value| value.is_finite());
        let both = image.iter().zip(reference).map(|(a, b)| {
            let (a, b) = (sound(a), sound(b));
            counts.image += usize::from(!a);
            counts.reference += usize::from(!b);
            counts.only_one += usize::from(a != b);
            a && b
        });
        Self { both: both.collect(), counts }
    }

    /// A copy of a picture that is black where the pair is not finite: equal there, so that
    /// filters over neighbourhoods see no difference.
    pub fn blacken(&self, picture: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let kept = picture.iter().zip(&self.both);
        kept.map(|(&pixel, &keep)| if keep { pixel } else { [0.0; 3] }).collect()
    }

    /// The mean of a value per pixel over the pixels that are finite; NaN if there are none.
    pub fn mean(&self, values: &[f32]) -> f64 {
        let kept = values.iter().zip(&self.both).filter(|&(_, &keep)| keep);
        let (sum, count) =
            kept.fold((0.0, 0_usize), |(sum, count), (&it, _)| (sum + f64::from(it), count + 1));
        sum / count as f64
    }
}

/// Differences over the pixels that are finite in both pictures. All NaN if there are none.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Errors {
    /// Mean of the image per channel.
    pub mean_image: [f64; 3],
    /// Mean of the reference per channel.
    pub mean_reference: [f64; 3],
    /// Quotient of the two.
    pub ratio: [f64; 3],
    /// Mean of all channels of the image over that of the reference, less 1.
    pub bias: f64,
    /// Root of the mean of `(a - b)²`.
    pub rmse: f64,
    /// Mean of `(a - b)² / (b² + 0.01)`, b the reference.
    pub relmse: f64,
    /// The greatest `|a - b|` of any channel.
    pub max: f64,
}

impl Errors {
    /// Compares an image `a` with a reference `b`.
    pub fn of(image: &[[f32; 3]], reference: &[[f32; 3]], finite: &Finite) -> Self {
        let (mut sum_a, mut sum_b) = ([0.0; 3], [0.0; 3]);
        let (mut squares, mut relative, mut max) = (0.0, 0.0, 0.0_f64);
        let mut count = 0_usize;
        for ((a, b), _) in image.iter().zip(reference).zip(&finite.both).filter(|&(_, &keep)| keep)
        {
            count += 1;
            for channel in 0..3 {
                let (a, b) = (f64::from(a[channel]), f64::from(b[channel]));
                let square = (a - b) * (a - b);
                sum_a[channel] += a;
                sum_b[channel] += b;
                squares += square;
                relative += square / (b * b + 0.01);
                max = max.max((a - b).abs());
            }
        }
        let pixels = count as f64;
        // Two black channels are equal; black against something is infinitely more.
        let quotient = |a: f64, b: f64| if a == b { 1.0 } else { a / b };
        let all = |sums: [f64; 3]| sums.iter().sum::<f64>();
        let nan_if_none = if count == 0 { f64::NAN } else { 0.0 };
        Self {
            mean_image: sum_a.map(|sum| sum / pixels),
            mean_reference: sum_b.map(|sum| sum / pixels),
            ratio: std::array::from_fn(|i| quotient(sum_a[i], sum_b[i]) + nan_if_none),
            bias: quotient(all(sum_a), all(sum_b)) - 1.0 + nan_if_none,
            rmse: (squares / (3.0 * pixels)).sqrt(),
            relmse: relative / (3.0 * pixels),
            max: max + nan_if_none,
        }
    }
}

/// The share of all pixels that are off: some channel is not finite in one picture only, or differs
/// by more than `tolerance * max(1, |b|)`.
pub fn pixels_off(image: &[[f32; 3]], reference: &[[f32; 3]], tolerance: f64) -> f64 {
    let same = |a: f32, b: f32| {
        let (wide_a, wide_b) = (f64::from(a), f64::from(b));
        a.to_bits() == b.to_bits()
            || a.is_nan() && b.is_nan()
            || (wide_a - wide_b).abs() <= tolerance * wide_b.abs().max(1.0) && b.is_finite()
    };
    let pairs = image.iter().zip(reference);
    let off = pairs.filter(|(a, b)| !(0..3).all(|i| same(a[i], b[i]))).count();
    off as f64 / image.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_pixels_by_hand() {
        let (a, b) = ([[1.0, 0.0, 3.0], [2.0, 0.0, 1.0]], [[2.0, 0.0, 1.0], [2.0, 0.0, 1.0]]);
        let errors = Errors::of(&a, &b, &Finite::of(&a, &b));
        assert_eq!(errors.mean_image, [1.5, 0.0, 2.0]);
        assert_eq!(errors.ratio, [0.75, 1.0, 2.0]);
        assert!((errors.bias - (7.0 / 6.0 - 1.0)).abs() < 1e-12);
        assert!((errors.rmse - (5.0_f64 / 6.0).sqrt()).abs() < 1e-12);
        assert!((errors.relmse - (1.0 / 4.01 + 4.0 / 1.01) / 6.0).abs() < 1e-12);
        assert_eq!(errors.max, 2.0);
    }

    #[test]
    fn pixels_that_are_not_finite_are_counted_and_left_out() {
        let (nan, inf) = (f32::NAN, f32::INFINITY);
        let a = [[nan, 0.0, 0.0], [1.0; 3], [inf, 1.0, 1.0], [3.0; 3]];
        let b = [[0.0; 3], [1.0; 3], [inf, 1.0, 1.0], [2.0; 3]];
        let finite = Finite::of(&a, &b);
        assert_eq!(finite.counts, NotFinite { image: 2, reference: 1, only_one: 1 });
        let errors = Errors::of(&a, &b, &finite);
        assert_eq!((errors.mean_image, errors.max), ([2.0; 3], 1.0));
        assert_eq!(finite.mean(&[9.0, 1.0, 9.0, 2.0]), 1.5);
        assert_eq!(finite.blacken(&a)[2], [0.0; 3]);
    }

    #[test]
    fn nothing_finite_is_no_figure_rather_than_a_perfect_one() {
        let (a, b) = ([[f32::NAN; 3]], [[1.0; 3]]);
        let finite = Finite::of(&a, &b);
        let errors = Errors::of(&a, &b, &finite);
        for figure in [errors.rmse, errors.relmse, errors.max, errors.bias, finite.mean(&[0.0])] {
            assert!(figure.is_nan());
        }
    }

    #[test]
    fn the_tolerance_is_absolute_below_one_and_relative_above() {
        let off = |a: f32, b: f32| pixels_off(&[[a; 3]], &[[b; 3]], 1e-4);
        assert_eq!(off(0.00009, 0.0), 0.0);
        assert_eq!(off(0.00011, 0.0), 1.0);
        assert_eq!(off(10000.9, 10000.0), 0.0);
        assert_eq!(off(10002.0, 10000.0), 1.0);
        assert_eq!(off(f32::NAN, f32::NAN), 0.0);
        assert_eq!(off(f32::INFINITY, f32::INFINITY), 0.0);
        assert_eq!(off(1.0, f32::INFINITY), 1.0);
        assert_eq!(off(f32::NAN, 1.0), 1.0);
    }
}
