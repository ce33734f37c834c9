//! `dapple golden`: a folder of pictures that renders are compared with.

use crate::cli::error::CliError;
use crate::cli::golden_page::Page;
use crate::cli::render::render_picture;
use crate::cli::text;
use crate::film::FilmError;
use crate::film::golden::{self, GoldenScene, Outcome, RenderError, RenderFn, Verdict};
use clap::{Args, Subcommand};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

const MANIFEST_HELP: &str = r#"golden.toml:
  render = ["--resolution", "128x128", "--spp", "64"]

  [[scene]]
  name = "cornell"
  file = "../scenes/cornell.gltf"
  render = ["--max-depth", "6"]
  limits = { flip = 0.002 }

In render, {folder} stands for the folder of golden.toml.
Limits are pixels-off (0.001) beyond tolerance (1e-4), flip (0.001) and relmse. With rule = "ztest"
pixels need not be equal but have the same expectation: then bad-tiles (0.01) counts."#;

/// Compare renders with the stored pictures of a folder, or store new ones.
///
/// The folder has a `golden.toml` that lists scenes, how to render them, and how much may differ.
#[derive(Args, Clone, Debug)]
#[command(after_help = MANIFEST_HELP)]
pub struct GoldenArgs {
    /// What to do
    #[command(subcommand)]
    pub command: GoldenCommand,
}

/// What `dapple golden` can do.
#[derive(Subcommand, Clone, Debug)]
pub enum GoldenCommand {
    /// Render each scene and compare it with its stored picture
    #[command(after_help = "\
Examples:
  dapple golden check golden
  dapple golden check golden --report out
  dapple golden check golden --only cornell -- --accel kd-ropes")]
    Check(CheckArgs),
    /// Render each scene and store the picture where it differs, with a table of old against new
    #[command(after_help = "\
Examples:
  dapple golden update golden
  dapple golden update golden --only cornell

A picture with the same pixels is left alone. Put the table into the commit's message.")]
    Update(FolderArgs),
}

/// Which scenes, and how results are printed.
#[derive(Args, Clone, Debug)]
pub struct FolderArgs {
    /// The folder that holds golden.toml
    pub folder: PathBuf,
    /// Only the scene of this name; may be given several times
    #[arg(long, value_name = "NAME")]
    pub only: Vec<String>,
    /// Print one JSON array instead of the table
    #[arg(long)]
    pub json: bool,
    /// Prints nothing but errors and the table
    #[arg(short, long)]
    pub quiet: bool,
}

/// Which scenes, and how they are rendered differently.
#[derive(Args, Clone, Debug)]
pub struct CheckArgs {
    /// The scenes
    #[command(flatten)]
    pub folder: FolderArgs,
    /// Write an HTML page into this folder: each picture beside its golden one and the map of FLIP
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Arguments of `dapple render` to add to those of the manifest, which they override
    #[arg(last = true, value_name = "RENDER ARGUMENTS")]
    pub render: Vec<String>,
}

/// Runs the command. The table goes to standard output.
///
/// # Errors
/// A manifest that cannot be read, or a name that is not in it. A scene that cannot be rendered is
/// no error but a line of the table, and an exit status.
pub fn run(args: &GoldenArgs) -> Result<ExitCode, CliError> {
    let render = |scene: &GoldenScene| {
        render_picture(&scene.file, &scene.render)
            .map_err(|error| RenderError::new(error.exit_code(), &error))
    };
    Ok(run_with(args, &render)?)
}

/// The same with another renderer.
fn run_with(args: &GoldenArgs, render: &RenderFn<'_>) -> Result<ExitCode, FilmError> {
    // What is stored is what the manifest says: no more words then.
    let (folder, words, report) = match &args.command {
        GoldenCommand::Check(check) => (&check.folder, &check.render[..], check.report.as_deref()),
        GoldenCommand::Update(folder) => (folder, &[][..], None),
    };
    let updates = matches!(args.command, GoldenCommand::Update(_));
    let mut page = report.map(Page::new).transpose()?;
    let mut outcomes = Vec::new();
    for scene in &choose_scenes(folder, words)? {
        if !folder.quiet {
            // It may take long; whether anybody reads this is no concern.
            let file = scene.file.display();
            let _ = writeln!(std::io::stderr(), "{}: rendering {file}", scene.name);
        }
        if updates {
            outcomes.push(golden::update(scene, render));
            continue;
        }
        let (outcome, pair) = golden::check(scene, render);
        if let Some(page) = &mut page {
            page.add(&outcome, name_verdict(outcome.verdict, updates), pair.as_ref())?;
        }
        outcomes.push(outcome);
    }
    if let Some(page) = page {
        page.write()?;
    }
    let text = if folder.json { to_json(&outcomes)? } else { to_text(&outcomes, updates) };
    text::print(&text)?;
    Ok(ExitCode::from(exit_status(&outcomes, updates)))
}

/// Chooses the scenes of the folder, less those that `--only` leaves out, with `words` added.
fn choose_scenes(args: &FolderArgs, words: &[String]) -> Result<Vec<GoldenScene>, FilmError> {
    let mut scenes = golden::load(&args.folder)?;
    for name in &args.only {
        if !scenes.iter().any(|scene| scene.name == *name) {
            let all: Vec<_> = scenes.iter().map(|scene| scene.name.as_str()).collect();
            return Err(FilmError::Usage(format!(
                "{}: no scene `{name}`; there are {}",
                args.folder.join(golden::MANIFEST).display(),
                all.join(", ")
            )));
        }
    }
    scenes.retain(|scene| args.only.is_empty() || args.only.contains(&scene.name));
    for scene in &mut scenes {
        scene.render.extend_from_slice(words);
    }
    Ok(scenes)
}

/// Failures weigh more than differences.
fn exit_status(outcomes: &[Outcome], updates: bool) -> u8 {
    let of = |outcome: &Outcome| match outcome.verdict {
        Verdict::Failed => outcome.exit_code,
        Verdict::New if !updates => 3,
        Verdict::Changed if !updates => 1,
        _ => 0,
    };
    outcomes.iter().map(of).max().unwrap_or(0)
}

fn to_json(outcomes: &[Outcome]) -> Result<String, FilmError> {
    let text = serde_json::to_string_pretty(outcomes)
        .map_err(|error| FilmError::Stdout(std::io::Error::other(error)))?;
    Ok(text + "\n")
}

fn name_verdict(verdict: Verdict, updates: bool) -> &'static str {
    match (verdict, updates) {
        (Verdict::Same, _) => "same",
        (Verdict::Changed, false) => "DIFFERS",
        (Verdict::New, false) => "MISSING",
        (Verdict::Changed, true) => "changed",
        (Verdict::New, true) => "new",
        (Verdict::Failed, _) => "FAILED",
    }
}

fn to_text(outcomes: &[Outcome], updates: bool) -> String {
    let heading = ["scene", "pixels off", "FLIP", "relMSE", "bad tiles", "result"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for outcome in outcomes {
        let figure = |of: fn(&golden::Figures) -> Option<f64>| {
            outcome.figures.as_ref().and_then(of).map_or("-".to_owned(), text::format_figure)
        };
        rows.push(vec![
            outcome.name.clone(),
            figure(|it| Some(it.pixels_off)),
            figure(|it| Some(it.flip)),
            figure(|it| Some(it.relmse)),
            figure(|it| it.bad_tiles),
            name_verdict(outcome.verdict, updates).to_owned(),
        ]);
    }
    let mut text = text::align_columns(&rows);
    // In an update, what exceeds the limits is the news and no complaint.
    for outcome in outcomes.iter().filter(|it| !it.reason.is_empty()) {
        let _ = writeln!(text, "{}: {}", outcome.name, outcome.reason);
    }
    if !updates && outcomes.iter().any(|it| it.verdict == Verdict::New) {
        text.push_str("missing pictures are made by `dapple golden update`\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Picture, Window};
    use clap::Parser;
    use std::path::Path;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        args: GoldenArgs,
    }

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        let manifest = "[[scene]]\nname = \"dark\"\nfile = \"d\"\n\
                        [[scene]]\nname = \"light\"\nfile = \"l\"\nrender = [\"--spp\", \"1\"]\n";
        std::fs::write(folder.path().join(golden::MANIFEST), manifest).expect("written");
        folder
    }

    fn status_of(words: &[&str], folder: &Path, value: f32) -> Result<String, FilmError> {
        let folder = folder.to_str().expect("a name");
        let words = words.iter().map(|&word| if word == "DIR" { folder } else { word });
        let command = Command::parse_from(std::iter::once("golden").chain(words));
        let picture = move |scene: &GoldenScene| {
            let mut picture = Picture::new(Window::of_size(8, 8), Window::of_size(8, 8));
            let value = if scene.name == "light" { value } else { 0.1 };
            // Arguments after `--` come last.
            let value = if scene.render.last().is_some_and(|it| it == "2") { 0.7 } else { value };
            picture.set_aov("", "RGB", &[[value; 3]; 64]);
            Ok(picture)
        };
        run_with(&command.args, &picture).map(|code| format!("{code:?}"))
    }

    #[test]
    fn from_missing_to_made_to_different() {
        let folder = folder();
        let status = |words: &[&str], value| status_of(words, folder.path(), value).expect("ran");
        let code = |code: u8| format!("{:?}", ExitCode::from(code));
        assert_eq!(status(&["check", "DIR"], 0.5), code(3));
        assert_eq!(status(&["update", "DIR", "--only", "dark"], 0.5), code(0));
        assert_eq!(status(&["check", "DIR", "--json"], 0.5), code(3));
        assert_eq!(status(&["update", "DIR"], 0.5), code(0));
        assert_eq!(status(&["check", "DIR"], 0.5), code(0));
        assert_eq!(status(&["check", "DIR"], 0.6), code(1));
        assert_eq!(status(&["check", "DIR", "--only", "dark"], 0.6), code(0));
        assert_eq!(status(&["check", "DIR", "--", "--spp", "2"], 0.5), code(1));
        let page = folder.path().join("new/report");
        let words = ["check", "DIR", "-q", "--report", page.to_str().expect("a name")];
        assert_eq!(status(&words, 0.6), code(1));
        let html = std::fs::read_to_string(page.join("index.html")).expect("written");
        assert_eq!(html.matches("data:image/png;base64,").count(), 6);
        assert!(html.contains("DIFFERS") && html.contains("dark") && !html.contains("http"));
    }

    #[test]
    fn a_name_that_is_not_there_is_told_with_those_that_are() {
        let folder = folder();
        let error = status_of(&["check", "DIR", "--only", "drak"], folder.path(), 0.5);
        let error = error.expect_err("no such scene");
        assert!(error.exit_code() == 2 && error.to_string().ends_with("there are dark, light"));
    }

    #[test]
    fn the_table_says_what_changed() {
        let figures =
            golden::Figures { pixels_off: 0.25, flip: 0.01, relmse: 0.5, bad_tiles: None };
        let outcome = |name: &str, verdict, figures, reason: &str| Outcome {
            name: name.to_owned(),
            verdict,
            figures,
            reason: reason.to_owned(),
            exit_code: 0,
        };
        let outcomes = [
            outcome("cornell", Verdict::Changed, Some(figures), "FLIP 0.01 > 0.001"),
            outcome("ball", Verdict::New, None, ""),
        ];
        let expected = "\
scene    pixels off  FLIP  relMSE  bad tiles   result
cornell        0.25  0.01     0.5          -  DIFFERS
ball              -     -       -          -  MISSING
cornell: FLIP 0.01 > 0.001
missing pictures are made by `dapple golden update`
";
        assert_eq!(to_text(&outcomes, false), expected);
        assert!(to_text(&outcomes, true).contains("changed"));
    }
}
