//! `dapple farm shell`: a script that any system can run.

use std::process::ExitCode;

use super::commands::indent;
use super::plan::{Cut, Plan};
use crate::cli::error::CliError;
use crate::cli::settings::Typed;
use crate::cli::shell::quote;
use crate::cli::text;

const EXAMPLES: &str = "\
Examples:
  dapple farm shell scene.gltf -o out.exr --spp 1024 --parts 16 > farm.sh
  bash farm.sh
  dapple farm shell walk.glb --frames 1..240 -o walk.####.exr > farm.sh
  bash farm.sh 17";

/// The flags.
#[derive(clap::Args, Debug)]
#[command(
    about = "Print a script for GNU parallel, or for any system that counts its tasks",
    long_about = "Print a script for GNU parallel, or for any system that counts its tasks.\n\n\
                  Without a word it renders all tasks, as many at a time as the variable JOBS \
                  says, and merges; `bash farm.sh 7` renders task 7 alone, and `bash farm.sh \
                  merge` merges.",
    after_help = EXAMPLES
)]
pub struct ShellArgs {
    #[command(flatten)]
    typed: Typed,
    #[command(flatten)]
    cut: Cut,
}

/// Prints the script.
pub fn run(args: &ShellArgs) -> Result<ExitCode, CliError> {
    let plan = Plan::new(&args.typed, &args.cut)?;
    text::print(&script(&plan))?;
    Ok(ExitCode::SUCCESS)
}

/// The script.
fn script(plan: &Plan) -> String {
    let last = plan.tasks() - 1;
    let merges = plan.merges() > 0;
    let line = |text: &str| if merges { format!("{text}\n") } else { String::new() };
    let work = quote(&plan.work);
    let task = plan.render_task("exec ", &[]);
    let render = format!("render() {{\n{}}}\n\n", indent(&format!("local task=$1\n{task}")));
    let merge = if merges {
        format!("merge() {{\n{}}}\n\n", indent(&merge_all(plan)))
    } else {
        String::new()
    };
    format!(
        "#!/usr/bin/env bash\n\
         # {}.\n\
         # Run it where the scene's path leads to the scene:\n\
         #   bash FILE         all tasks, $JOBS of them at a time, by GNU parallel or xargs\n\
         #   bash FILE TASK    one of the tasks 0 to {last}; exit code 75: saved, start it again\n\
         {}\
         # Tasks that are done end at once; those that were stopped go on.\n\
         set -euo pipefail\n\
         mkdir -p {work}\n\n\
         {render}{merge}\
         case ${{1:-all}} in\n  all) ;;\n{}  *)\n    {}\n    render \"$1\"\n    ;;\nesac\n\n\
         if command -v parallel >/dev/null; then\n  \
         seq 0 {last} | parallel --quote --jobs \"${{JOBS:-1}}\" bash \"$0\"\n\
         else\n  \
         seq 0 {last} | xargs -n 1 -P \"${{JOBS:-1}}\" bash \"$0\"\n\
         fi\n{}",
        plan.describe(),
        line("#   bash FILE merge   merges the parts"),
        line("  merge) merge; exit ;;"),
        check_task(last),
        line("merge"),
    )
}

/// The lines that make sure that the script's word is the number of a task.
fn check_task(last: u64) -> String {
    format!(
        "if [[ ! $1 =~ ^(0|[1-9][0-9]{{0,8}})$ ]] || (($1 > {last})); then\n      \
         echo \"$0: there is no task '$1': they are 0 to {last}\" >&2\n      \
         exit 2\n    \
         fi"
    )
}

/// The lines that merge all pictures.
fn merge_all(plan: &Plan) -> String {
    let merge = plan.merge_picture("", &[]);
    match plan.merges() {
        1 if plan.frames.is_none() => merge,
        merges => {
            let last = merges - 1;
            format!("local picture\nfor picture in {{0..{last}}}; do\n{}done", indent(&merge))
        }
    }
}
