//! `dapple bench`: structures measured side by side.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Subcommand;
use serde_json::json;

use super::{CliError, input, table};
use crate::bench::bars::bars;
use crate::bench::kd::{self, BenchError, Row, SETS, Settings};
use crate::simd::Isa;

/// Measure structures side by side, on one thread; all answers are compared first.
#[derive(clap::Args, Debug)]
pub struct BenchArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand, Debug)]
enum What {
    Kd(KdArgs),
}

/// All kd-trees: nodes, leaves and tests a ray, bytes and rates; then builds by layouts.
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  dapple bench kd bunny.obj --report out")]
pub struct KdArgs {
    /// A scene file, or an .npy of (N, 9) float32 triangles
    scene: PathBuf,
    /// Rays of each set
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    rays: usize,
    /// The instruction set
    #[arg(long, default_value_t)]
    isa: Isa,
    /// Megabytes that a structure may take; 0: three quarters of the machine's memory
    #[arg(long, value_name = "MB", default_value_t = 0)]
    memory: u64,
    /// Write the tables as Markdown, JSON and SVG into this folder
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

/// Runs the command.
pub fn run(args: &BenchArgs) -> Result<ExitCode, CliError> {
    match &args.what {
        What::Kd(args) => run_kd(args),
    }
}

fn run_kd(args: &KdArgs) -> Result<ExitCode, CliError> {
    let source = input::triangles(&args.scene)?;
    let memory = match args.memory {
        0 => machine_memory() / 4 * 3,
        megabytes => megabytes.saturating_mul(1_000_000),
    };
    let settings = Settings { rays: args.rays, memory, isa: args.isa };
    let walks = kd::walks(&source, &settings).map_err(to_cli)?;
    let builds = kd::builds_and_layouts(&source, &settings).map_err(to_cli)?;
    let name = args.scene.display();
    let count = source.len();
    let titles = [
        format!("Kd-tree walks, {name}, {count} triangles"),
        format!("Builds and layouts, kd-stack-direction, {name}"),
    ];
    let text =
        format!("{}\n{}", kd::markdown(&titles[0], &walks), kd::markdown(&titles[1], &builds));
    table::print(&text)?;
    if let Some(folder) = &args.report {
        let object = |rows: &[Row]| rows.iter().map(Row::json).collect::<Vec<_>>();
        let report = json!({
            "scene": name.to_string(),
            "triangles": count,
            "rays": args.rays,
            "walks": object(&walks),
            "builds": object(&builds),
        });
        fs::create_dir_all(folder).map_err(|error| not_written(folder, &error))?;
        write(folder, "kd.md", &text)?;
        write(folder, "kd.json", &format!("{report:#}\n"))?;
        write(folder, "kd-walks.svg", &chart(&titles[0], &walks))?;
        write(folder, "kd-builds.svg", &chart(&titles[1], &builds))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn chart(title: &str, rows: &[Row]) -> String {
    let rows: Vec<_> = rows
        .iter()
        .map(|row| (row.spec.clone(), row.sets.iter().map(kd::Measured::rate).collect()))
        .collect();
    bars(title, "Mrays/s", &SETS.map(crate::bench::ray_sets::RaySet::name), &rows)
}

fn write(folder: &Path, name: &str, text: &str) -> Result<(), CliError> {
    let path = folder.join(name);
    fs::write(&path, text).map_err(|error| not_written(&path, &error))
}

fn not_written(path: &Path, error: &std::io::Error) -> CliError {
    CliError::Output(format!("{}: {error}", path.display()))
}

fn to_cli(error: BenchError) -> CliError {
    match error {
        BenchError::Build(error) => CliError::Build(error),
        wrong @ BenchError::Disagrees { .. } => CliError::Input(wrong.to_string()),
    }
}

/// Bytes of memory, or 16 GB where the system does not say.
fn machine_memory() -> u64 {
    let total = fs::read_to_string("/proc/meminfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("MemTotal:"))?;
        line.split_whitespace().nth(1)?.parse::<u64>().ok()
    });
    total.map_or(16_000_000_000, |kilobytes| kilobytes * 1024)
}
