//! All error metrics of an image and a reference, and the map of where they differ.

use super::metrics::{Errors, Finite, NotFinite};
use super::ztest::{ZTest, ztest};
use super::{FilmError, Picture, exr, flip, png};
use std::path::Path;

/// Which FLIP.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FlipKind {
    /// Over a range of exposures: for pictures in linear light.
    #[default]
    Hdr,
    /// Of what a display shows without tone mapping.
    Ldr,
}

/// What the comparison of two pictures found.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Comparison {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Pixels with a NaN or infinity, which are in no other figure.
    pub not_finite: NotFinite,
    /// Means and errors.
    #[serde(flatten)]
    pub errors: Errors,
    /// Which FLIP follows.
    pub flip_kind: FlipKind,
    /// Mean FLIP.
    pub flip: f64,
    /// The z-test, where at least one picture has `variance.R`, `.G`, `.B`.
    pub ztest: Option<ZTest>,
    /// FLIP of each pixel; 1 where only one picture is finite.
    #[serde(skip)]
    pub flip_map: Vec<f32>,
}

/// A picture with the name that messages give it.
#[derive(Clone, Copy, Debug)]
pub struct Named<'a> {
    /// The file, or what else tells the user which picture it is.
    pub path: &'a Path,
    /// The picture.
    pub picture: &'a Picture,
}

/// Reads a picture: PNG by its extension, EXR else.
///
/// # Errors
/// As [`exr::read`] and [`png::read`].
pub fn read(path: &Path) -> Result<Picture, FilmError> {
    let is_png = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png"));
    if is_png { png::read(path) } else { exr::read(path) }
}

/// Compares the colours of an image with those of a reference.
///
/// # Errors
/// [`FilmError::Sizes`]; [`FilmError::Invalid`] if one has no colours.
pub fn compare(
    image: Named<'_>,
    reference: Named<'_>,
    flip_kind: FlipKind,
) -> Result<Comparison, FilmError> {
    let size =
        |it: &Named<'_>| (it.path.display().to_string(), it.picture.width(), it.picture.height());
    let (width, height) = (image.picture.width(), image.picture.height());
    if (width, height) != (reference.picture.width(), reference.picture.height()) {
        return Err(FilmError::Sizes(size(&image), size(&reference)));
    }
    let (a, b) = (image.picture.rgb(image.path)?, reference.picture.rgb(reference.path)?);
    let finite = Finite::of(&a, &b);
    let (black_a, black_b) = (finite.blacken(&a), finite.blacken(&b));
    let mut flip_map = match flip_kind {
        FlipKind::Hdr => flip::hdr(&black_b, &black_a, width),
        FlipKind::Ldr => flip::ldr(&black_b, &black_a, width),
    };
    let flip = finite.mean(&flip_map);
    for (i, value) in flip_map.iter_mut().enumerate() {
        let sound = |pixel: &[f32; 3]| pixel.iter().all(|it| it.is_finite());
        if sound(&a[i]) != sound(&b[i]) {
            *value = 1.0;
        }
    }
    let variances =
        [image.picture.aov("variance", "RGB"), reference.picture.aov("variance", "RGB")];
    let tested = variances.iter().any(Option::is_some).then(|| {
        let [of_a, of_b] = &variances;
        ztest((&a, of_a.as_deref()), (&b, of_b.as_deref()), width, &finite)
    });
    Ok(Comparison {
        width,
        height,
        not_finite: finite.counts,
        errors: Errors::of(&a, &b, &finite),
        flip_kind,
        flip,
        ztest: tested,
        flip_map,
    })
}

impl Comparison {
    /// The map of FLIP in the colours of matplotlib's magma, from black (equal) to pale yellow.
    pub fn heatmap(&self) -> Vec<[u8; 3]> {
        self.flip_map.iter().map(|&error| magma(error)).collect()
    }
}

/// M. Zucker's polynomial fit of magma (S. van der Walt and N. Smith, matplotlib 2015).
fn magma(t: f32) -> [u8; 3] {
    const FIT: [[f32; 3]; 7] = [
        [-0.002_136_485, -0.000_749_655, -0.005_386_128],
        [0.251_660_5, 0.677_523_24, 2.494_026_6],
        [8.353_717, -3.577_719_5, 0.314_467_9],
        [-27.668_733, 14.264_731, -13.649_213],
        [52.176_14, -27.943_606, 12.944_169],
        [-50.768_525, 29.046_583, 4.234_153],
        [18.655_705, -11.489_774, -5.601_961_5],
    ];
    let t = t.clamp(0.0, 1.0);
    std::array::from_fn(|channel| {
        let value = FIT.iter().rev().fold(0.0, |sum, term| sum * t + term[channel]);
        (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Window;

    fn grey(width: usize, height: usize, value: f32) -> Picture {
        let window = Window::of_size(width, height);
        let mut picture = Picture::new(window, window);
        picture.set_aov("", "RGB", &vec![[value; 3]; width * height]);
        picture
    }

    fn named<'a>(path: &'a str, picture: &'a Picture) -> Named<'a> {
        Named { path: Path::new(path), picture }
    }

    #[test]
    fn a_picture_equals_itself() {
        let a = grey(20, 10, 0.5);
        for kind in [FlipKind::Hdr, FlipKind::Ldr] {
            let found = compare(named("a", &a), named("b", &a), kind).expect("compared");
            assert_eq!((found.flip, found.errors.rmse, found.errors.max), (0.0, 0.0, 0.0));
            assert_eq!(found.errors.ratio, [1.0; 3]);
            assert!(found.ztest.is_none());
            assert!(found.heatmap().iter().all(|&pixel| pixel == [0; 3]));
        }
    }

    #[test]
    fn sizes_must_agree() {
        let (a, b) = (grey(4, 2, 0.5), grey(2, 4, 0.5));
        let error = compare(named("a.exr", &a), named("b.exr", &b), FlipKind::Hdr);
        let message = error.expect_err("differ").to_string();
        assert!(message.starts_with("sizes differ: a.exr is 4x2, b.exr is 2x4"), "{message}");
    }

    #[test]
    fn a_nan_on_one_side_shows_in_the_map_and_nowhere_else() {
        let b = grey(20, 20, 0.5);
        let mut a = b.clone();
        let mut red = vec![0.5; 400];
        red[210] = f32::NAN;
        a.set_channel("R", red);
        let found = compare(named("a", &a), named("b", &b), FlipKind::Hdr).expect("compared");
        assert_eq!(found.not_finite, NotFinite { image: 1, reference: 0, only_one: 1 });
        assert_eq!((found.flip, found.errors.rmse, found.flip_map[210]), (0.0, 0.0, 1.0));
    }

    #[test]
    fn magma_goes_from_black_to_pale_yellow() {
        assert_eq!(magma(0.0), [0, 0, 0]);
        let [r, g, b] = magma(1.0);
        assert!(r > 248 && g > 240 && (180..200).contains(&b), "{r} {g} {b}");
    }
}
