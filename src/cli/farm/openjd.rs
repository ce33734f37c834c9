//! `dapple farm openjd`: a template of Open Job Description.

use std::process::ExitCode;

use serde::Serialize;
use serde_json::{Value, json};

use super::plan::{Cut, Plan};
use crate::cli::error::CliError;
use crate::cli::settings::{Table, Typed};
use crate::cli::shell::quote;
use crate::cli::text;

/// How long a cancelled task has to save, seconds.
const NOTICE: u32 = 60;

const EXAMPLES: &str = "\
Examples:
  dapple farm openjd scene.gltf -o out.exr --spp 1024 --parts 16 > out.json
  openjd run out.json";

/// The flags.
#[derive(clap::Args, Debug)]
#[command(
    about = "Print a template of Open Job Description",
    long_about = "Print a template of Open Job Description, version jobtemplate-2023-09: a step \
                  Render over all tasks and, if there are parts, a step Merge behind it.\n\n\
                  Put it where the scene's path leads to the scene, or set its parameter Folder.",
    after_help = EXAMPLES
)]
pub struct OpenjdArgs {
    #[command(flatten)]
    typed: Typed,
    #[command(flatten)]
    cut: Cut,
}

/// Prints the template.
pub fn run(args: &OpenjdArgs) -> Result<ExitCode, CliError> {
    let plan = Plan::new(&args.typed, &args.cut)?;
    let template = serde_json::to_string_pretty(&template(&plan))
        .map_err(|error| CliError::Output(format!("the template: {error}")))?;
    text::print(&format!("{template}\n"))?;
    Ok(ExitCode::SUCCESS)
}

/// A template, in the order in which people read it.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Template {
    specification_version: &'static str,
    name: String,
    parameter_definitions: Value,
    steps: Vec<Step>,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Step {
    name: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    dependencies: Option<Value>,
    parameter_space: Value,
    script: Value,
}

/// The template of a plan.
fn template(plan: &Plan) -> Template {
    let progress = reports_progress(plan).then_some(["--progress", "openjd"]);
    let more = progress.as_ref().map_or(&[][..], |words| &words[..]);
    let work = quote(&plan.work);
    let render = format!("task=$2\nmkdir -p {work}\n{}", plan.render_task("exec ", more));
    let mut steps = vec![step("Render", "Task", plan.tasks(), &render)];
    if plan.merges() > 0 {
        let merge = format!("picture=$2\n{}", plan.merge_picture("exec ", &[]));
        let merge = step("Merge", "Picture", plan.merges(), &merge);
        let behind = Some(json!([{ "dependsOn": "Render" }]));
        steps.push(Step { dependencies: behind, ..merge });
    }
    Template {
        specification_version: "jobtemplate-2023-09",
        name: name(plan),
        parameter_definitions: json!([{
            "name": "Folder",
            "type": "PATH",
            "objectType": "DIRECTORY",
            "dataFlow": "INOUT",
            "default": ".",
            "description": "Where the paths of the scene and of the outputs begin.",
        }]),
        steps,
    }
}

/// The name of the job: of some length, and without what a template may take for a reference.
fn name(plan: &Plan) -> String {
    let name: String = plan.name.chars().filter(|c| !"{}".contains(*c)).take(64).collect();
    if name.is_empty() { "dapple".to_owned() } else { name }
}

/// Whether tasks are to report progress in the lines of Open Job Description.
fn reports_progress(plan: &Plan) -> bool {
    let setting = Table::default().find("progress");
    let has_style = setting.is_some_and(|progress| progress.parse("openjd".as_ref()).is_ok());
    has_style && !plan.typed.contains(&"progress") && !plan.typed.contains(&"quiet")
}

/// A step of so many tasks, each of which runs some lines of bash: their `$1` is the folder, `$2`
/// the task's number.
fn step(name: &'static str, index: &str, count: u64, lines: &str) -> Step {
    let text = format!("set -eu\ncd \"$1\"\n{}\n", without_references(lines));
    let range = format!("0-{}", count - 1);
    Step {
        name,
        dependencies: None,
        parameter_space: json!({
            "taskParameterDefinitions": [{ "name": index, "type": "INT", "range": range }],
        }),
        script: json!({
            "actions": { "onRun": {
                "command": "bash",
                "args": [
                    "{{Task.File.Run}}",
                    "{{Param.Folder}}",
                    format!("{{{{Task.Param.{index}}}}}"),
                ],
                "cancelation": {
                    "mode": "NOTIFY_THEN_TERMINATE",
                    "notifyPeriodInSeconds": NOTICE,
                },
            }},
            "embeddedFiles": [
                { "name": "Run", "type": "TEXT", "filename": "run.sh", "data": text },
            ],
        }),
    }
}

/// Lines in which no template finds a reference: two braces stand only in quoted words, where
/// they may be parted by the end of one quotation and the begin of another.
fn without_references(lines: &str) -> String {
    let mut lines = lines.to_owned();
    for (braces, parted) in [("{{", "{''{"), ("}}", "}''}")] {
        while lines.contains(braces) {
            lines = lines.replace(braces, parted);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_template_finds_no_reference_in_names() {
        for lines in ["'{{Param.Folder}}'", "'{{{a'", "'{' 'b{{{{'", "'}}}' {a..c}"] {
            let parted = without_references(lines);
            assert!(!parted.contains("{{") && !parted.contains("}}"), "{parted}");
            if cfg!(unix) {
                let print = |words: &str| {
                    let script = format!("printf '%s\\n' {words}");
                    let output = std::process::Command::new("bash").args(["-c", &script]).output();
                    output.expect("bash runs").stdout
                };
                assert_eq!(print(&parted), print(lines));
            }
        }
    }
}
