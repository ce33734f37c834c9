//! `dapple accels`: the table of structures.

use std::fmt::Write;
use std::process::ExitCode;

use serde_json::json;

use crate::accel::{VARIANTS, Value, Values, Variant};
use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::text;

/// List the acceleration structures, with their options.
#[derive(clap::Args, Debug)]
#[command(after_help = "Examples:\n  dapple accels\n  dapple accels --json\n  \
    dapple render scene.gltf -o out.exr --accel bvh2:build=sweep")]
pub struct AccelsArgs {
    /// Print an array of objects with `id`, `summary`, `paper` and `options`
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    quiet: Quiet,
}

/// Prints the table.
pub fn run(args: &AccelsArgs) -> Result<ExitCode, CliError> {
    let text = if args.json {
        let rows: Vec<_> = VARIANTS.iter().map(to_json).collect();
        format!("{:#}\n", serde_json::Value::from(rows))
    } else {
        to_text()
    };
    text::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn to_text() -> String {
    let width = VARIANTS.iter().map(|variant| variant.id.len()).max().unwrap_or(0);
    let mut text = String::new();
    for variant in VARIANTS {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:width$}  {}", variant.id, variant.summary);
        for option in variant.options {
            let (name, values, default) = (option.name, option.values, option.default);
            let summary = option.summary;
            let _ =
                writeln!(text, "{:width$}    {name}={values}: {summary} [default: {default}]", "");
        }
    }
    text + OF_ALL
}

/// What every structure takes besides.
const OF_ALL: &str = "\nAll take, for meshes that are placed more than once:
  instances=auto|flat|two-level: all in one structure, or one of each mesh and one of its copies
    [default: auto]
  top=ID: the structure of copies, if it is to be another [default: that of the meshes]
";

fn to_json(variant: &Variant) -> serde_json::Value {
    let options = variant.options.iter().map(|option| {
        let mut all = json!({
            "name": option.name,
            "summary": option.summary,
            "default": value_to_json(option.default),
        });
        let (kind, limits) = values_to_json(option.values);
        all["type"] = kind.into();
        for (name, limit) in limits {
            all[name] = limit;
        }
        all
    });
    json!({
        "id": variant.id,
        "summary": variant.summary,
        "paper": variant.paper,
        "options": options.collect::<Vec<_>>(),
    })
}

/// What kind of value it is, and what limits it.
fn values_to_json(values: Values) -> (&'static str, Vec<(&'static str, serde_json::Value)>) {
    match values {
        Values::Choice(words) => ("choice", vec![("choices", json!(words))]),
        Values::Integer(low, high) => ("integer", vec![("min", json!(low)), ("max", json!(high))]),
        Values::Number(low, high) => ("number", vec![("min", json!(low)), ("max", json!(high))]),
        Values::Bytes(low) => ("bytes", vec![("min", json!(low))]),
    }
}

fn value_to_json(value: Value) -> serde_json::Value {
    match value {
        Value::Choice(word) => json!(word),
        Value::Integer(n) | Value::Bytes(n) => json!(n),
        Value::Number(n) => json!(n),
    }
}
