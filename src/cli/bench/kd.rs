//! `dapple bench kd`: the tables of kd-trees.

use std::path::PathBuf;

use serde_json::json;

use super::options::{MachineArgs, ray_bytes};
use super::output::{OutputArgs, Results};
use super::scenes::{BenchScene, KITCHEN};
use crate::bench::bars::draw_bars;
use crate::bench::kd::{self, KdBenchSettings, Row, SETS};
use crate::bench::kd_growth::{self, Growth};
use crate::bench::measure::Measured;
use crate::bench::ray_sets::RaySet;
use crate::cli::error::CliError;
use crate::cli::flags::{Quiet, whole};
use crate::cli::{input, memory};
use crate::generate::Generator;

/// All kd-trees: bytes, rates, nodes, leaves and tests per ray; then builds by layouts; with
/// --report also the build times over machines of 10^4 to 10^6 triangles.
///
/// Without a file, the scene is the kitchen of 103,000 triangles that `dapple generate` makes.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple bench kd --report out
  dapple bench kd bunny.obj --rays 1000000")]
pub struct KdArgs {
    /// A scene file, or an .npy of (N, 9) float32 triangles
    scene: Option<PathBuf>,
    /// Rays of each set; primary ones are the largest square picture of no more
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    #[arg(value_parser = whole(1..=1_000_000_000_u64))]
    rays: u64,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    quiet: Quiet,
    #[command(flatten)]
    output: OutputArgs,
}

/// Runs the command.
pub fn run(args: &KdArgs) -> Result<(), CliError> {
    // All sets and answers, and those that are compared with them.
    let needed = ray_bytes(args.rays, SETS.len() as u64 + 1);
    memory::require(&format!("{} rays of each set", args.rays), needed)?;
    args.output.probe()?;
    let made = BenchScene::Made(Generator::Kitchen, KITCHEN);
    let scene = args.scene.clone().map_or(made, BenchScene::File);
    let source = scene.with_file(|path| input::load_triangles(path, args.quiet))?;
    let (isa, memory) = (args.machine.isa()?, args.machine.memory_limit());
    let settings = KdBenchSettings { rays: args.rays as usize, memory, isa };
    let walks = kd::measure_walks(&source, &settings)?;
    let builds = kd::measure_builds_and_layouts(&source, &settings)?;
    let name = match &args.scene {
        Some(file) => file.display().to_string(),
        None => scene.name(),
    };
    let count = source.len();
    let titles = [
        format!("Kd-tree walks, {name}, {count} triangles"),
        format!("Builds and layouts, kd-stack-direction, {name}"),
    ];
    let growth = if args.output.wants_report() {
        measure_growth(&settings, args.quiet)?
    } else {
        Vec::new()
    };
    let object = |rows: &[Row]| rows.iter().map(Row::json).collect::<Vec<_>>();
    let mut results = Results {
        name: "kd",
        tables: [kd::make_tables(&titles[0], &walks), kd::make_tables(&titles[1], &builds)]
            .concat(),
        json: json!({
            "scene": name,
            "triangles": count,
            "rays": args.rays,
            "walks": object(&walks),
            "builds": object(&builds),
            "growth": kd_growth::to_json(&growth),
        }),
        plots: vec![
            ("walks".to_owned(), draw_chart(&titles[0], &walks)),
            ("builds".to_owned(), draw_chart(&titles[1], &builds)),
        ],
    };
    if !growth.is_empty() {
        results.tables.push(kd_growth::make_table(&growth));
        results.plots.push(("growth".to_owned(), kd_growth::draw_plot(&growth)));
    }
    results.publish(&args.output)
}

/// Builds over machines of growing size.
fn measure_growth(settings: &KdBenchSettings, quiet: Quiet) -> Result<Vec<Growth>, CliError> {
    let measure = |size: u64| {
        let source = BenchScene::Made(Generator::Assembly, size)
            .with_file(|path| input::load_triangles(path, quiet))?;
        Ok(kd_growth::measure(&source, settings)?)
    };
    kd_growth::sizes(settings).map(measure).collect()
}

fn draw_chart(title: &str, rows: &[Row]) -> String {
    let rows: Vec<_> = rows
        .iter()
        .map(|row| (row.spec.clone(), row.sets.iter().map(Measured::rate).collect()))
        .collect();
    draw_bars(title, "Mrays/s", &SETS.map(RaySet::name), &rows)
}
