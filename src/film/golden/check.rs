//! Compares renders with golden pictures, and makes new golden pictures.

use super::{GoldenScene, Limits, Rule};
use crate::film::compare::{FlipKind, Named, compare};
use crate::film::metrics::pixels_off;
use crate::film::{FilmError, Picture, exr};
use serde::Serialize;
use std::error::Error;
use std::path::Path;

/// Renders a scene of a manifest by its [`GoldenScene::file`] and [`GoldenScene::render`].
pub type RenderFn<'a> = dyn Fn(&GoldenScene) -> Result<Picture, RenderError> + 'a;

/// Why a scene could not be rendered.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct RenderError {
    message: String,
    exit_code: u8,
}

impl RenderError {
    /// An error, and the exit status that a command would end with for it.
    pub fn new(exit_code: u8, error: &dyn Error) -> Self {
        Self { message: describe_chain(error), exit_code }
    }
}

/// How far a render is from its golden picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// The share of pixels that are off.
    pub pixels_off: f64,
    /// Mean FLIP (HDR).
    pub flip: f64,
    /// Mean of `(a - b)² / (b² + 0.01)`.
    pub relmse: f64,
    /// The share of tiles with |z| > 5, where variances are known.
    pub bad_tiles: Option<f64>,
}

/// The result for a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Within the limits; after an update: equal, and the file was left alone.
    Same,
    /// Beyond a limit, or of another size; after an update: the file was written again.
    Changed,
    /// There is no golden picture; after an update: there is now.
    New,
    /// It could not be rendered, read or written.
    Failed,
}

/// A line of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// The scene's name.
    pub name: String,
    /// The result.
    pub verdict: Verdict,
    /// The figures, if there were two pictures of one size.
    pub figures: Option<Figures>,
    /// What exceeded which limit, or why there are no figures.
    pub reason: String,
    /// The exit status of the error, if it failed.
    #[serde(skip)]
    pub exit_code: u8,
}

impl Outcome {
    fn of(scene: &GoldenScene, verdict: Verdict, figures: Option<Figures>, reason: String) -> Self {
        Self { name: scene.name.clone(), verdict, figures, reason, exit_code: 0 }
    }

    fn failed(scene: &GoldenScene, error: &FilmError) -> Self {
        Self { exit_code: error.exit_code(), ..Self::not_done(scene, error) }
    }

    fn render_failed(scene: &GoldenScene, error: &RenderError) -> Self {
        Self { exit_code: error.exit_code, ..Self::not_done(scene, error) }
    }

    fn not_done(scene: &GoldenScene, error: &dyn Error) -> Self {
        Self::of(scene, Verdict::Failed, None, describe_chain(error))
    }
}

/// An error and its sources, in a line, those left out that it has named itself.
fn describe_chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(error) = source {
        let reason = error.to_string();
        if !text.contains(&reason) {
            text = format!("{text}: {reason}");
        }
        source = error.source();
    }
    text
}

/// A render and its golden picture.
#[derive(Debug)]
pub struct Pair {
    /// What was rendered.
    pub picture: Picture,
    /// What is stored.
    pub golden: Picture,
}

/// Renders a scene and compares it with its golden picture. Returns both where there are both.
pub fn check(scene: &GoldenScene, render: &RenderFn<'_>) -> (Outcome, Option<Pair>) {
    // Without it there is no need to render.
    if !scene.golden.exists() {
        let reason = format!("{} is missing", scene.golden.display());
        return (Outcome::of(scene, Verdict::New, None, reason), None);
    }
    let golden = match exr::read(&scene.golden) {
        Ok(golden) => golden,
        Err(error) => return (Outcome::failed(scene, &error), None),
    };
    match render(scene) {
        Ok(picture) => (judge(scene, &picture, &golden), Some(Pair { picture, golden })),
        Err(error) => (Outcome::render_failed(scene, &error), None),
    }
}

/// Renders a scene and makes that its golden picture. A file that holds the same pixels is left
/// alone. Kept are the colours, alpha and variances; the render time is not, so that the same
/// picture is the same bytes.
pub fn update(scene: &GoldenScene, render: &RenderFn<'_>) -> Outcome {
    let old = if scene.golden.exists() { Some(exr::read(&scene.golden)) } else { None };
    let mut picture = match render(scene) {
        Ok(picture) => picture,
        Err(error) => return Outcome::render_failed(scene, &error),
    };
    picture.retain_channels(|name| {
        matches!(name, "R" | "G" | "B" | "A") || name.starts_with("variance.")
    });
    picture.strings.retain(|name, _| !name.contains("time"));
    let outcome = match old {
        None => Outcome::of(scene, Verdict::New, None, String::new()),
        Some(Ok(old)) => {
            if same_pixels(&picture, &old) {
                return judge(scene, &picture, &old);
            }
            Outcome { verdict: Verdict::Changed, ..judge(scene, &picture, &old) }
        }
        // What cannot be read is replaced, which an update is for.
        Some(Err(error)) => Outcome::of(scene, Verdict::Changed, None, error.to_string()),
    };
    match exr::write(&scene.golden, &picture) {
        Ok(()) => outcome,
        Err(error) => Outcome::failed(scene, &error),
    }
}

fn same_pixels(a: &Picture, b: &Picture) -> bool {
    let bits = |samples: &[f32]| samples.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
    (a.frame, a.crop) == (b.frame, b.crop)
        && a.channels().len() == b.channels().len()
        && a.channels()
            .iter()
            .zip(b.channels())
            .all(|(a, b)| a.name == b.name && bits(&a.samples) == bits(&b.samples))
}

fn judge(scene: &GoldenScene, picture: &Picture, golden: &Picture) -> Outcome {
    match measure(scene, picture, golden) {
        Ok((figures, not_finite)) => {
            let reason = describe_excess(&scene.limits, &figures, not_finite);
            let verdict = if reason.is_empty() { Verdict::Same } else { Verdict::Changed };
            Outcome::of(scene, verdict, Some(figures), reason)
        }
        Err(error @ FilmError::Sizes(..)) => {
            Outcome::of(scene, Verdict::Changed, None, error.to_string())
        }
        Err(error) => Outcome::failed(scene, &error),
    }
}

/// The figures, and how many pixels are finite in one of the pictures only.
fn measure(
    scene: &GoldenScene,
    picture: &Picture,
    golden: &Picture,
) -> Result<(Figures, usize), FilmError> {
    let rendered = Path::new("the render");
    let found = compare(
        Named { path: rendered, picture },
        Named { path: &scene.golden, picture: golden },
        FlipKind::Hdr,
    )?;
    let (a, b) = (picture.rgb(rendered)?, golden.rgb(&scene.golden)?);
    let figures = Figures {
        pixels_off: pixels_off(&a, &b, scene.limits.tolerance),
        flip: found.flip,
        relmse: found.errors.relmse,
        bad_tiles: found.ztest.map(|test| test.bad_tiles),
    };
    Ok((figures, found.not_finite.only_one))
}

/// Which figures exceed the limits; empty if none does.
fn describe_excess(limits: &Limits, figures: &Figures, not_finite: usize) -> String {
    let mut reasons = Vec::new();
    let mut hold = |name: &str, value: f64, limit: f64| {
        // NaN, which no pixel that is finite gives, is within no limit but an infinite one.
        if !(value <= limit || limit == f64::INFINITY) {
            reasons.push(format!("{name} {value:.6} > {limit}"));
        }
    };
    match limits.rule {
        Rule::Pixels => hold("pixels off", figures.pixels_off, limits.pixels_off),
        Rule::Ztest => hold("bad tiles", figures.bad_tiles.unwrap_or(f64::NAN), limits.bad_tiles),
    }
    hold("FLIP", figures.flip, limits.flip);
    hold("relMSE", figures.relmse, limits.relmse);
    if limits.rule == Rule::Ztest && not_finite > 0 {
        reasons.push(format!("{not_finite} pixels finite in one picture only"));
    }
    reasons.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Window;
    use std::fs;

    fn check(scene: &GoldenScene, render: &RenderFn<'_>) -> Outcome {
        super::check(scene, render).0
    }

    fn picture(value: f32, off: usize) -> Picture {
        let mut picture = Picture::new(Window::of_size(50, 40), Window::of_size(50, 40));
        let mut colours = vec![[value; 3]; 2000];
        colours[..off].fill([value + 2e-4; 3]);
        picture.set_aov("", "RGB", &colours);
        picture.set_aov("variance", "RGB", &vec![[1e-6; 3]; 2000]);
        picture.set_aov("albedo", "RGB", &colours);
        picture.strings.insert("dapple/render-time".into(), "3 s".into());
        picture
    }

    fn scene(folder: &Path, rule: Rule) -> GoldenScene {
        let limits = Limits { rule, flip: 0.1, ..Limits::default() };
        GoldenScene {
            name: "a".into(),
            file: "a.gltf".into(),
            golden: folder.join("a.exr"),
            render: Vec::new(),
            limits,
        }
    }

    #[test]
    fn missing_then_made_then_the_same() {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = scene(folder.path(), Rule::Pixels);
        let unused = check(&scene, &|_| panic!("nothing to render for"));
        assert_eq!(unused.verdict, Verdict::New);
        assert_eq!(update(&scene, &|_| Ok(picture(0.5, 0))).verdict, Verdict::New);
        let golden = exr::read(&scene.golden).expect("written");
        assert!(golden.channel("albedo.R").is_none() && golden.channel("variance.R").is_some());
        assert!(!golden.strings.contains_key("dapple/render-time"));
        let bytes = fs::read(&scene.golden).expect("there");
        assert_eq!(check(&scene, &|_| Ok(picture(0.5, 0))).verdict, Verdict::Same);
        assert_eq!(update(&scene, &|_| Ok(picture(0.5, 0))).verdict, Verdict::Same);
        assert_eq!(fs::read(&scene.golden).expect("there"), bytes);
    }

    #[test]
    fn one_pixel_in_a_thousand_may_be_off() {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = scene(folder.path(), Rule::Pixels);
        update(&scene, &|_| Ok(picture(0.5, 0)));
        let two = check(&scene, &|_| Ok(picture(0.5, 2)));
        assert_eq!((two.verdict, two.figures.expect("figures").pixels_off), (Verdict::Same, 0.001));
        let three = check(&scene, &|_| Ok(picture(0.5, 3)));
        assert_eq!(three.verdict, Verdict::Changed);
        assert!(three.reason.starts_with("pixels off 0.0015"), "{}", three.reason);
        let update = update(&scene, &|_| Ok(picture(0.5, 2)));
        assert_eq!(update.verdict, Verdict::Changed, "other pixels, though within the limits");
        assert_eq!(check(&scene, &|_| Ok(picture(0.5, 2))).figures.expect("two").pixels_off, 0.0);
    }

    #[test]
    fn the_z_test_bears_noise_but_no_shift() {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = scene(folder.path(), Rule::Ztest);
        update(&scene, &|_| Ok(picture(0.5, 0)));
        // All 2000 pixels are off by 2e-4, each with a deviation of 1.4e-3: z of 1.1 per tile.
        assert_eq!(check(&scene, &|_| Ok(picture(0.5, 2000))).verdict, Verdict::Same);
        assert_eq!(check(&scene, &|_| Ok(picture(0.505, 0))).verdict, Verdict::Changed);
    }

    #[test]
    fn a_nan_is_a_difference_under_either_rule() {
        let folder = tempfile::tempdir().expect("a folder");
        for rule in [Rule::Pixels, Rule::Ztest] {
            let mut scene = scene(folder.path(), rule);
            scene.limits.pixels_off = 0.0;
            update(&scene, &|_| Ok(picture(0.5, 0)));
            let mut bad = picture(0.5, 0);
            let mut red = vec![0.5; 2000];
            red[77] = f32::NAN;
            bad.set_channel("R", red);
            assert_eq!(check(&scene, &move |_| Ok(bad.clone())).verdict, Verdict::Changed);
        }
    }

    #[test]
    fn failures_keep_their_reason_and_exit_status() {
        let folder = tempfile::tempdir().expect("a folder");
        let scene = scene(folder.path(), Rule::Pixels);
        update(&scene, &|_| Ok(picture(0.5, 0)));
        let failed = check(&scene, &|_| {
            let error = FilmError::read(Path::new("a.gltf"), std::io::ErrorKind::NotFound.into());
            Err(RenderError::new(5, &error))
        });
        assert_eq!((failed.verdict, failed.exit_code), (Verdict::Failed, 5));
        assert_eq!(failed.reason, "a.gltf: cannot be read: entity not found");
        let small = Picture::new(Window::of_size(2, 2), Window::of_size(2, 2));
        let resized = check(&scene, &move |_| {
            let mut small = small.clone();
            small.set_aov("", "RGB", &[[0.0; 3]; 4]);
            Ok(small)
        });
        assert_eq!((resized.verdict, resized.figures), (Verdict::Changed, None));
        assert!(resized.reason.starts_with("sizes differ"), "{}", resized.reason);
    }
}
