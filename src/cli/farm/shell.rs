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

/// Runs all numbers of a function, so many at a time. Signals go to what runs: a shell that waits
/// would not hand them on. `wait -n` only wakes: some versions of bash lose the code of what a
/// signal ended, so each is asked for by its process.
const RUN: &str = r#"
# Runs $1 for the numbers 0 to $2, $JOBS at a time.
run() {
  local number code
  trap 'stop 75 USR1' USR1
  trap 'stop 143 TERM' TERM
  trap 'stop 130 TERM' INT
  trap 'tell HUP' HUP
  for ((number = 0; number <= $2; number++)); do
    while ((${#running[@]} >= JOBS)); do collect; done
    [ -z "$told" ] || break
    "$1" "$number" &
    running+=("$!")
    [ -z "$told" ] || tell TERM # It came in between.
  done
  while ((${#running[@]})); do collect; done
  code=${failed:-${told:-$stopped}}
  [ -z "$code" ] || exit "$code"
}

# Waits until one has ended, and takes down the codes of all that have.
collect() {
  local process code alive going=()
  wait -n || :
  alive=$(jobs -rp)
  for process in "${running[@]}"; do
    if [[ $'\n'$alive$'\n' == *$'\n'$process$'\n'* ]]; then
      going+=("$process")
      continue
    fi
    code=0
    wait "$process" || code=$?
    if ((code == 75 || code > 128)); then
      stopped=${stopped:-$code}
    elif ((code)); then
      failed=${failed:-$code}
    fi
  done
  running=("${going[@]}")
}

# Has those that run save and end.
stop() {
  told=${told:-$1}
  tell "$2"
}

tell() {
  kill -s "$1" "${running[@]}" 2>/dev/null || :
}

"#;

/// The script.
fn script(plan: &Plan) -> String {
    let last = plan.tasks() - 1;
    let merges = plan.merges();
    let if_merges = |text: String| if merges > 0 { text } else { String::new() };
    let merge_all = if_merges(format!("run merge {}", merges.saturating_sub(1)));
    let function = |name: &str, lines: &str| format!("{name}() {{\n{}}}\n\n", indent(lines));
    let task = plan.render_task("exec ", &[]);
    let render = function("render", &format!("local task=$1\n{task}"));
    let picture = if plan.frames.is_some() { "local picture=$1\n" } else { "" };
    let picture = format!("{picture}{}", plan.merge_picture("exec ", &[]));
    let merge = if_merges(function("merge", &picture));
    format!(
        "#!/usr/bin/env bash\n\
         # {}.\n\
         # Run it where the scene's path leads to the scene:\n\
         #   bash FILE         all tasks, $JOBS of them at a time\n\
         #   bash FILE TASK    one of the tasks 0 to {last}\n\
         {}\
         # Tasks that are done end at once; those that were stopped go on.\n\
         # Exit code 75: saved, start it again. All tasks: the code of the first that failed,\n\
         # or else of the first that was stopped.\n\
         set -euo pipefail\n\
         mkdir -p {}\n\n\
         {render}{merge}\
         running=() failed='' stopped='' told=''\n\
         {}\
         if (($# > 1)); then\n  \
         echo \"$0: one word, not $#: a task, or none for all\" >&2\n  \
         exit 2\n\
         fi\n\
         case ${{1:-all}} in\n  \
         all)\n    {}\n    run render {last}\n{}    ;;\n\
         {}  \
         *)\n    {}\n    render \"$1\"\n    ;;\n\
         esac\n",
        plan.describe(),
        if_merges("#   bash FILE merge   merges the parts\n".to_owned()),
        quote(&plan.work),
        RUN.trim_start(),
        CHECK_JOBS,
        if_merges(format!("    {merge_all}\n")),
        if_merges(format!("  merge)\n    JOBS=1\n    {merge_all}\n    ;;\n")),
        check_task(last),
    )
}

/// The lines that make sure of the variable JOBS.
const CHECK_JOBS: &str = r#"if [[ ! ${JOBS:=1} =~ ^[1-9][0-9]{0,3}$ ]]; then
      echo "$0: JOBS is '$JOBS': it is how many tasks run at a time" >&2
      exit 2
    fi"#;

/// The lines that make sure that the script's word is the number of a task.
fn check_task(last: u64) -> String {
    format!(
        "if [[ ! $1 =~ ^(0|[1-9][0-9]{{0,8}})$ ]] || (($1 > {last})); then\n      \
         echo \"$0: there is no task '$1': they are 0 to {last}\" >&2\n      \
         exit 2\n    \
         fi"
    )
}
