//! `dapple accels`: the table of structures.

use std::process::ExitCode;

use serde_json::json;

use crate::accel::{VARIANTS, Variant};

/// List the acceleration structures, with their options.
#[derive(clap::Args, Debug)]
#[command(after_help = "Examples:\n  dapple accels\n  dapple accels --json\n  \
    dapple render scene.gltf -o out.exr --accel bvh2:build=sweep")]
pub struct AccelsArgs {
    /// Print an array of objects with `id`, `summary`, `paper` and `options`
    #[arg(long)]
    json: bool,
}

/// Prints the table.
pub fn run(args: &AccelsArgs) -> ExitCode {
    if args.json {
        let rows: Vec<_> = VARIANTS.iter().map(as_json).collect();
        println!("{:#}", serde_json::Value::from(rows));
        return ExitCode::SUCCESS;
    }
    let width = VARIANTS.iter().map(|variant| variant.id.len()).max().unwrap_or(0);
    for variant in VARIANTS {
        println!("{:width$}  {}", variant.id, variant.summary);
        for option in variant.options {
            println!("{:width$}    {}={}: {}", "", option.name, option.values, option.summary);
        }
    }
    ExitCode::SUCCESS
}

fn as_json(variant: &Variant) -> serde_json::Value {
    let options = variant.options.iter().map(|option| {
        json!({
            "name": option.name,
            "summary": option.summary,
            "values": option.values.to_string(),
            "default": option.default.to_string(),
        })
    });
    json!({
        "id": variant.id,
        "summary": variant.summary,
        "paper": variant.paper,
        "options": options.collect::<Vec<_>>(),
    })
}
