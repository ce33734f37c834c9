//! `dapple diff`: how an image differs from a reference, as a table, as JSON or as a failure.

use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::outputs::{self, Output};
use crate::cli::text;
use crate::film::compare::{self, Comparison, FlipKind, Named};
use crate::film::{FilmError, png};
use crate::names::UnknownName;
use clap::Args;
use serde_json::json;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;

/// Compare an image with a reference: means, errors, FLIP, and a z-test where variances are.
///
/// Pixels with a NaN or an infinity are counted and left out of all figures. The z-test asks, per
/// tile of 8x8 pixels, whether two noisy renders have the same expectation; it needs the layer
/// `variance`, which `dapple render` writes, in at least one of the files.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  dapple diff out.exr golden.exr
  dapple diff out.exr golden.exr --heatmap where.png
  dapple diff out.exr mitsuba.exr --fail bias=0.005 --fail bad-tiles=0.01")]
pub struct DiffArgs {
    /// The image to judge (.exr or .png)
    pub image: PathBuf,
    /// The image to compare it with (.exr or .png)
    pub reference: PathBuf,
    /// Write a picture of FLIP per pixel: from black, equal, to pale yellow, entirely different
    #[arg(long, value_name = "PNG")]
    pub heatmap: Option<PathBuf>,
    /// Exits with 1 if METRIC is above VALUE: rmse, relmse, flip, bias, bad-tiles, max, not-finite
    #[arg(long, value_name = "METRIC=VALUE")]
    pub fail: Vec<Limit>,
    /// FLIP of what a display shows, clamped, instead of FLIP over a range of exposures
    #[arg(long)]
    pub ldr: bool,
    /// Print one JSON object instead of the table
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub(super) quiet: Quiet,
}

/// The metrics that `--fail` knows, by the words for them.
const METRICS: [(&str, Metric); 7] = [
    ("rmse", |found| found.errors.rmse),
    ("relmse", |found| found.errors.relmse),
    ("flip", |found| found.flip),
    ("bias", |found| found.errors.bias.abs()),
    // Without variances there is no such figure, and a limit on it is not kept.
    ("bad-tiles", |found| found.ztest.as_ref().map_or(f64::NAN, |test| test.bad_tiles)),
    ("max", |found| found.errors.max),
    ("not-finite", |found| found.not_finite.image.max(found.not_finite.reference) as f64),
];

type Metric = fn(&Comparison) -> f64;

/// A `--fail METRIC=VALUE`.
#[derive(Clone, Debug)]
pub struct Limit {
    name: &'static str,
    metric: Metric,
    limit: f64,
}

/// A text that is no [`Limit`].
#[derive(Clone, Debug, thiserror::Error)]
pub enum LimitError {
    /// Not of the form.
    #[error("say METRIC=VALUE, such as relmse=0.01")]
    Form,
    /// No such metric.
    #[error(transparent)]
    Metric(#[from] UnknownName),
    /// No such value.
    #[error("`{0}` is not a number of 0 or more")]
    Value(String),
}

impl FromStr for Limit {
    type Err = LimitError;

    fn from_str(word: &str) -> Result<Self, LimitError> {
        let (name, limit) = word.split_once('=').ok_or(LimitError::Form)?;
        let &(name, metric) = METRICS
            .iter()
            .find(|metric| metric.0 == name)
            .ok_or_else(|| UnknownName::new("metric", name, &METRICS.map(|metric| metric.0)))?;
        match limit.parse::<f64>() {
            Ok(limit) if limit >= 0.0 => Ok(Self { name, metric, limit }),
            _ => Err(LimitError::Value(limit.to_owned())),
        }
    }
}

impl Limit {
    /// A figure that does not exist exceeds any limit. So does a pixel that is finite in one image
    /// only, which no mean shows.
    fn is_exceeded(&self, found: &Comparison) -> bool {
        let value = (self.metric)(found);
        value.is_nan() || value > self.limit || found.not_finite.only_one > 0
    }

    /// How it is exceeded.
    fn explain(&self, found: &Comparison) -> String {
        let value = (self.metric)(found);
        let why = if value > self.limit {
            format!("is {}", text::format_figure(value))
        } else if value.is_nan() {
            "does not exist for these images".to_owned()
        } else {
            let pixels = found.not_finite.only_one;
            format!("cannot be told: {pixels} pixels are finite in one image only")
        };
        format!("exceeded: {} {why}, the limit is {}", self.name, self.limit)
    }
}

/// Runs the command: the result goes to standard output.
///
/// # Errors
/// Files that cannot be read, compared or written; see [`CliError::exit_code`].
pub fn run(args: &DiffArgs) -> Result<ExitCode, CliError> {
    let map = args.heatmap.as_deref();
    let map = map.map(|path| Output { flag: "--heatmap", path, ending: "png" });
    outputs::check(map.as_slice(), &[&args.image, &args.reference])?;
    let (image, reference) = (compare::read(&args.image)?, compare::read(&args.reference)?);
    let kind = if args.ldr { FlipKind::Ldr } else { FlipKind::Hdr };
    let found = compare::compare(
        Named { path: &args.image, picture: &image },
        Named { path: &args.reference, picture: &reference },
        kind,
    )?;
    if let Some(path) = &args.heatmap {
        png::write_rgb8(path, found.width, found.height, &found.heatmap())?;
    }
    let exceeded: Vec<_> = args.fail.iter().filter(|limit| limit.is_exceeded(&found)).collect();
    let text = if args.json { to_json(&found, &exceeded)? } else { to_text(&found, &exceeded) };
    text::print(&text)?;
    Ok(ExitCode::from(u8::from(!exceeded.is_empty())))
}

fn to_json(found: &Comparison, exceeded: &[&Limit]) -> Result<String, FilmError> {
    let mut object = serde_json::to_value(found)
        .map_err(|error| FilmError::Stdout(std::io::Error::other(error)))?;
    object["exceeded"] = json!(exceeded.iter().map(|limit| limit.name).collect::<Vec<_>>());
    Ok(format!("{object:#}\n"))
}

fn to_text(found: &Comparison, exceeded: &[&Limit]) -> String {
    let three = |values: &[f64; 3]| values.map(text::format_figure).join("  ");
    let errors = &found.errors;
    let mut rows = vec![
        ("size", format!("{} x {}", found.width, found.height)),
        ("mean, image", three(&errors.mean_image)),
        ("mean, reference", three(&errors.mean_reference)),
        ("ratio", three(&errors.ratio)),
        ("bias", format!("{:+.3} %", 100.0 * errors.bias)),
        ("RMSE", text::format_figure(errors.rmse)),
        ("relMSE", text::format_figure(errors.relmse)),
        ("greatest difference", text::format_figure(errors.max)),
        (
            match found.flip_kind {
                FlipKind::Hdr => "FLIP (HDR)",
                FlipKind::Ldr => "FLIP (LDR)",
            },
            text::format_figure(found.flip),
        ),
    ];
    if let Some(test) = &found.ztest {
        let exact = if test.one_is_exact { ", one image taken as exact" } else { "" };
        let worst =
            if test.worst.is_finite() { text::format_figure(test.worst) } else { "inf".into() };
        rows.push((
            "tiles with |z| > 5",
            format!("{:.2} % of {}, worst {worst}{exact}", 100.0 * test.bad_tiles, test.tiles),
        ));
        rows.push((
            "z of tiles",
            format!("mean {:+.3}, standard deviation {:.3}", test.mean, test.deviation),
        ));
        rows.push(("z of the whole", three(&test.whole)));
    }
    let not_finite = &found.not_finite;
    if not_finite.image + not_finite.reference > 0 {
        rows.push((
            "pixels not finite",
            format!(
                "{} of the image, {} of the reference; left out above",
                not_finite.image, not_finite.reference
            ),
        ));
    }
    let width = rows.iter().map(|row| row.0.len()).max().unwrap_or(0);
    let mut text = String::new();
    for (name, value) in rows {
        let _ = writeln!(text, "{name:width$}  {value}");
    }
    for limit in exceeded {
        let _ = writeln!(text, "{}", limit.explain(found));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Picture, Window, exr};
    use std::path::Path;

    fn written(path: &Path, value: f32) -> PathBuf {
        let mut picture = Picture::new(Window::of_size(16, 16), Window::of_size(16, 16));
        picture.set_aov("", "RGB", &[[value; 3]; 256]);
        exr::write(path, &picture).expect("written");
        path.to_owned()
    }

    fn arguments(image: PathBuf, reference: PathBuf, fail: &[&str]) -> DiffArgs {
        let fail = fail.iter().map(|it| it.parse().expect("a limit")).collect();
        DiffArgs {
            image,
            reference,
            heatmap: None,
            fail,
            ldr: false,
            json: false,
            quiet: Quiet::default(),
        }
    }

    #[test]
    fn limits_decide_the_exit_status() {
        let folder = tempfile::tempdir().expect("a folder");
        let a = written(&folder.path().join("a.exr"), 0.5);
        let b = written(&folder.path().join("b.exr"), 0.6);
        let status = |fail: &[&str]| {
            run(&arguments(a.clone(), b.clone(), fail)).map(|code| format!("{code:?}"))
        };
        let (good, bad) = (format!("{:?}", ExitCode::from(0)), format!("{:?}", ExitCode::from(1)));
        assert_eq!(status(&[]).expect("compared"), good);
        assert_eq!(status(&["rmse=0.11", "max=0.11"]).expect("compared"), good);
        assert_eq!(status(&["rmse=0.11", "max=0.09"]).expect("compared"), bad);
        assert_eq!(status(&["bias=0.1"]).expect("compared"), bad);
        assert_eq!(status(&["bad-tiles=1"]).expect("no variances"), bad);
    }

    #[test]
    fn a_nan_on_one_side_exceeds_every_limit() {
        let folder = tempfile::tempdir().expect("a folder");
        let b = written(&folder.path().join("b.exr"), 0.5);
        let mut picture = exr::read(&b).expect("read");
        let mut red = vec![0.5; 256];
        red[0] = f32::NAN;
        picture.set_channel("R", red);
        let path = folder.path().join("a.exr");
        exr::write(&path, &picture).expect("written");
        let code = run(&arguments(path, b, &["rmse=9"])).expect("compared");
        assert_eq!(format!("{code:?}"), format!("{:?}", ExitCode::from(1)));
    }

    #[test]
    fn the_heat_map_is_a_png_of_the_same_size() {
        let folder = tempfile::tempdir().expect("a folder");
        let a = written(&folder.path().join("a.exr"), 0.5);
        let b = written(&folder.path().join("b.exr"), 5.0);
        let mut args = arguments(a, b, &[]);
        args.heatmap = Some(folder.path().join("map.png"));
        run(&args).expect("compared");
        let map = image::open(folder.path().join("map.png")).expect("a picture");
        assert_eq!((map.width(), map.height()), (16, 16));
    }

    #[test]
    fn words_that_are_no_limits_say_what_would_be() {
        let error = |word: &str| word.parse::<Limit>().expect_err("no limit").to_string();
        assert!(error("relmsw=1").contains("did you mean relmse"), "{}", error("relmsw=1"));
        assert!(error("q=1").contains("there are rmse, relmse"), "{}", error("q=1"));
        assert!(error("rmse").contains("METRIC=VALUE"));
        assert!(error("rmse=-1").contains("0 or more"));
        assert!(error("rmse=nan").contains("0 or more"));
    }
}
