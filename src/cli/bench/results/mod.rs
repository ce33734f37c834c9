//! `dapple bench results`: the figures that benches wrote, read again.

mod check;
mod folder;
mod listing;
mod pages;
mod short_runs;

use std::path::PathBuf;
use std::process::ExitCode;

use check::CheckSettings;

use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::text;

/// What a folder of results holds, whether it still describes this program, and its page.
///
/// Reads mbvh.json, coherent.json, kd.json and render.json, which the benches write with --report,
/// and structures.json, which `bench accels --json` prints: those that are there. Without flags it
/// lists scenes, processor, commit and command of each.
///
/// --check measures a small part of each again, in some two minutes, and holds the rates against
/// those of the file. On another processor than the file's, rates say nothing: there it compares
/// ratios to the first structure. Single cells are noisy, so the geometric mean of a file's cells
/// decides; a structure alone may be off by twice as much. Nodes, leaves and bytes are the same on
/// every machine, and must be equal. Let nothing else run meanwhile.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple bench results
  dapple bench results --check
  dapple bench results out --check --within 5 --json
  dapple bench results --page docs/results.md")]
pub struct BenchResultsArgs {
    /// The folder
    #[arg(default_value = "docs/results")]
    folder: PathBuf,
    /// Measure a small part again and compare; exits with 1 if a file differs
    #[arg(long)]
    check: bool,
    /// Per cent that the mean of a file's cells may be off
    #[arg(long, value_name = "PERCENT", default_value_t = 15.0, requires = "check")]
    #[arg(value_parser = parse_within)]
    within: f64,
    /// Compare ratios on the file's processor, too: for machines that are busy or throttled
    #[arg(long, requires = "check")]
    ratios: bool,
    /// Put the tables beside the papers' into this page, between its marks
    #[arg(long, value_name = "FILE", conflicts_with_all = ["check", "json"])]
    page: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    quiet: Quiet,
}

fn parse_within(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(per_cent) if per_cent > 0.0 && per_cent <= 1000.0 => Ok(per_cent),
        _ => Err("say a number above 0, at most 1000".to_owned()),
    }
}

/// Runs the command; exit 1 if a file no longer describes the program.
pub fn run(args: &BenchResultsArgs) -> Result<ExitCode, CliError> {
    let kept = folder::read(&args.folder)?;
    if let Some(page) = &args.page {
        pages::fill(page, &kept)?;
        return Ok(ExitCode::SUCCESS);
    }
    let (text, agree) = if args.check {
        let (within, ratios, quiet) = (args.within, args.ratios, args.quiet);
        let all = check::check(&kept, &CheckSettings { within, ratios, quiet })?;
        let text = if args.json {
            format!("{:#}\n", check::to_json(&all, within))
        } else {
            check::to_text(&all, within)
        };
        (text, all.iter().all(check::Checked::agrees))
    } else if args.json {
        (format!("{:#}\n", listing::to_json(&kept)), true)
    } else {
        (listing::to_text(&kept), true)
    };
    text::print(&text)?;
    Ok(ExitCode::from(u8::from(!agree)))
}
