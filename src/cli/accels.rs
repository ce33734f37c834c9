//! `dapple accels`: the table of structures.

use std::fmt::Write;
use std::process::ExitCode;

use serde_json::json;

use super::{CliError, table};
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
pub fn run(args: &AccelsArgs) -> Result<ExitCode, CliError> {
    let text = if args.json {
        let rows: Vec<_> = VARIANTS.iter().map(as_json).collect();
        format!("{:#}\n", serde_json::Value::from(rows))
    } else {
        in_words()
    };
    table::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn in_words() -> String {
    let width = VARIANTS.iter().map(|variant| variant.id.len()).max().unwrap_or(0);
    let mut text = String::new();
    for variant in VARIANTS {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:width$}  {}", variant.id, variant.summary);
        for option in variant.options {
            let (name, values) = (option.name, option.values);
            let _ = writeln!(text, "{:width$}    {name}={values}: {}", "", option.summary);
        }
    }
    text
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
