//! `dapple bench`: structures measured side by side.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Subcommand;
use serde_json::json;

use super::{CliError, input, memory, table};
use crate::accel::ClosestHit;
use crate::bench::bars::bars;
use crate::bench::kd::{self, BenchError, Row, SETS, Settings};
use crate::files::{self, Flush};
use crate::math::Ray;
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
    #[arg(value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    rays: u64,
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
    memory::require(&format!("{} rays of each set", args.rays), ray_bytes(args.rays))?;
    if let Some(folder) = &args.report {
        fs::create_dir_all(folder).map_err(|error| CliError::not_written(folder, &error))?;
        files::probe(&folder.join("kd.md")).map_err(|e| CliError::not_written(folder, &e))?;
    }
    let source = input::triangles(&args.scene)?;
    let memory = match args.memory {
        0 => memory::limit() / 4 * 3,
        megabytes => megabytes.saturating_mul(1_000_000),
    };
    let settings = Settings { rays: args.rays as usize, memory, isa: args.isa };
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
        write(folder, "kd.md", &text)?;
        write(folder, "kd.json", &format!("{report:#}\n"))?;
        write(folder, "kd-walks.svg", &chart(&titles[0], &walks))?;
        write(folder, "kd-builds.svg", &chart(&titles[1], &builds))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// All sets and answers, and those that are compared with them.
fn ray_bytes(rays: u64) -> u64 {
    let (ray, hit) = (size_of::<Ray>() as u64, size_of::<ClosestHit>() as u64);
    rays * (SETS.len() as u64 + 1) * (ray + hit)
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
    files::write(&path, Flush::ToDisk, |file| file.write_all(text.as_bytes()))
        .map_err(|error| CliError::not_written(&path, &error))
}

fn to_cli(error: BenchError) -> CliError {
    match error {
        BenchError::Build(error) => CliError::Build(error),
        wrong @ BenchError::Disagrees { .. } => CliError::Differs(wrong.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disagreement_is_a_difference() {
        let wrong = BenchError::Disagrees {
            spec: "kd-ropes".to_owned(),
            first: "kd-stack-direction".to_owned(),
            rays: 1,
            count: 10,
            set: "random",
        };
        assert_eq!(to_cli(wrong).exit_code(), 1);
    }
}
