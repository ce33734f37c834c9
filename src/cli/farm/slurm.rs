//! `dapple farm slurm`: an array of tasks, and a merge behind it.

use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};

use super::plan::{Cut, Plan};
use crate::cli::error::CliError;
use crate::cli::settings::Typed;
use crate::cli::shell::quote;
use crate::cli::text;
use crate::files::{self, Flush};

/// How often a task that asks for another turn gets one: a limit for one that gets nothing done
/// between two notices.
const TURNS: u32 = 100;

/// How often one gets another that was killed, as by a machine without memory.
const TIMES_IF_KILLED: u32 = 3;

const EXAMPLES: &str = "\
Examples:
  dapple farm slurm scene.gltf -o out.exr --spp 4096 --parts 64 > slurm.sh
  bash slurm.sh
  dapple farm slurm scene.gltf -o out.exr --spp 4096 --parts 64 --walltime 55 --submit
  dapple farm slurm walk.glb --frames 1..240 -o walk.####.exr --sbatch=--cpus-per-task=8 --submit";

/// The flags.
#[derive(clap::Args, Debug)]
#[command(
    about = "Print or submit an array of Slurm jobs, with a merge behind it",
    long_about = "Print or submit an array of Slurm jobs, with a merge behind it.\n\n\
                  A task is told a minute before its time is over, saves, and is put back into the \
                  queue; so is one whose node is lost. Each goes on from its checkpoint. Tasks \
                  that are done end at once, so the same array may be submitted again.",
    after_help = EXAMPLES
)]
pub struct SlurmArgs {
    #[command(flatten)]
    typed: Typed,
    #[command(flatten)]
    cut: Cut,
    #[command(flatten)]
    slurm: Options,
}

/// What Slurm is told besides.
#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Slurm")]
struct Options {
    /// The partition
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    /// The account
    #[arg(long, value_name = "NAME")]
    account: Option<String>,
    /// The time that a task may take in one turn: minutes, or as in 1:30:00
    #[arg(long, value_name = "TIME", value_parser = walltime)]
    walltime: Option<String>,
    /// A further option for sbatch, as in --sbatch=--mem=8G; may be given again
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true, value_parser = sbatch_option)]
    sbatch: Vec<String>,
    /// Submits the jobs; the script is written to farm.sh in the folder of --work
    #[arg(long)]
    submit: bool,
}

/// A time as Slurm takes it: minutes, or with colons and days as in 1-12:00.
fn walltime(word: &str) -> Result<String, String> {
    let (days, clock) = match word.split_once('-') {
        Some((days, clock)) => (Some(days), clock),
        None => (None, word),
    };
    let is_number = |part: &str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let parts: Vec<&str> = clock.split(':').collect();
    let is_time =
        days.is_none_or(is_number) && parts.len() <= 3 && parts.into_iter().all(is_number);
    if is_time {
        return Ok(word.to_owned());
    }
    Err("expected minutes, as in 90, or H:M:S, as in 1:30:00".to_owned())
}

fn sbatch_option(word: &str) -> Result<String, String> {
    if word.starts_with('-') {
        return Ok(word.to_owned());
    }
    Err(format!("options begin with a dash, as in --sbatch=--{word}"))
}

/// Prints the script, or runs it.
pub fn run(args: &SlurmArgs) -> Result<ExitCode, CliError> {
    let plan = Plan::new(&args.typed, &args.cut)?;
    let script = script(&plan, &args.slurm)?;
    if !args.slurm.submit {
        text::print(&script)?;
        return Ok(ExitCode::SUCCESS);
    }
    let path = Path::new(&plan.work).join("farm.sh");
    fs::create_dir_all(&plan.work)
        .and_then(|()| {
            files::write(&path, Flush::WhenIdle, |file| {
                std::io::Write::write_all(file, script.as_bytes())
            })
        })
        .map_err(|source| CliError::not_written(&path, &source))?;
    let failed = |why: String| {
        CliError::Output(format!("{}: the jobs were not submitted: {why}", path.display()))
    };
    let status = Command::new("bash").arg(&path).status().map_err(|it| failed(it.to_string()))?;
    if !status.success() {
        return Err(failed(format!("it ended with {status}")));
    }
    Ok(ExitCode::SUCCESS)
}

/// The script that submits the jobs.
fn script(plan: &Plan, options: &Options) -> Result<String, CliError> {
    let (render, merge) = (render_job(plan, options)?, merge_job(plan, options)?);
    let work = quote(&plan.work);
    let (render_file, merge_file) = (plan.file("render.sbatch"), plan.file("merge.sbatch"));
    let (merge, told) = match merge {
        None => (String::new(), ""),
        Some(merge) => {
            let submit = format!(
                "cat >{merge_file} <<'EOF'\n{merge}EOF\n\n\
                 merge=$(sbatch --parsable --dependency=afterok:\"$render\" {merge_file})\n"
            );
            (submit, "merge: job ${merge%%;*}; ")
        }
    };
    Ok(format!(
        "#!/usr/bin/env bash\n\
         # {}, by Slurm.\n\
         # Run it where the scene's path leads to the scene: bash FILE\n\
         # Tasks that are done end at once; those that were stopped go on.\n\
         set -euo pipefail\n\
         mkdir -p {work}\n\
         rm -f {work}/*.killed\n\n\
         cat >{render_file} <<'EOF'\n{render}EOF\n\n\
         render=$(sbatch --parsable {render_file})\n\
         render=${{render%%;*}}\n\n\
         {merge}\
         echo \"render: job $render; {told}logs: \"{work}\n",
        plan.describe(),
    ))
}

/// What both jobs begin with.
fn head(plan: &Plan, options: &Options, what: &str, log: &str) -> Result<String, CliError> {
    let mut lines = vec![
        format!("--job-name={}", quote(format!("{}-{what}", plan.name))),
        // A percent sign begins a pattern there.
        format!("--output={}/{log}", quote(plan.work.replace('%', "%%"))),
        "--open-mode=append".to_owned(),
    ];
    let given = [("partition", &options.partition), ("account", &options.account)];
    let given = given.into_iter().chain([("time", &options.walltime)]);
    for (name, value) in given.filter_map(|(name, value)| Some((name, value.as_ref()?))) {
        lines.push(format!("--{name}={}", quote(value)));
    }
    lines.extend(options.sbatch.iter().cloned());
    let wrong = |line: &&String| line.contains(char::is_control);
    if let Some(line) = lines.iter().find(wrong) {
        let line = line.escape_debug();
        return Err(CliError::Usage(format!("`{line}` cannot stand in a script")));
    }
    Ok(format!("#!/usr/bin/env bash\n#SBATCH {}\n", lines.join("\n#SBATCH ")))
}

/// The cores that Slurm gives a task.
const THREADS: [&str; 2] = ["--threads", "\"${SLURM_CPUS_PER_TASK:-$SLURM_CPUS_ON_NODE}\""];

impl Plan {
    /// The words that keep a task to its cores, unless someone has said otherwise.
    fn threads(&self) -> &'static [&'static str] {
        if self.typed.contains(&"threads") { &[] } else { &THREADS }
    }
}

/// The job of the tasks.
fn render_job(plan: &Plan, options: &Options) -> Result<String, CliError> {
    let (last, work) = (plan.tasks() - 1, quote(&plan.work));
    Ok(format!(
        "{}\
         #SBATCH --array=0-{last}\n\
         #SBATCH --requeue\n\
         #SBATCH --signal=B:USR1@60\n\
         set -u\n\
         # Slurm tells this shell alone, which hands it on.\n\
         trap 'told=1; kill -USR1 \"$dapple\"' USR1\n\
         trap 'told=1; kill -TERM \"$dapple\"' TERM\n\
         task=$SLURM_ARRAY_TASK_ID\n\
         {} &\n\
         dapple=$!\n\
         while :; do\n  \
         told='' code=0\n  \
         wait \"$dapple\" || code=$?\n  \
         [ -n \"$told\" ] || break\n\
         done\n\
         case $code in\n  \
         75) turns={TURNS} ;; # Saved, to be started again.\n  \
         137) # Killed: a line each.\n    \
         echo >>{work}/\"$task\".killed\n    \
         turns={TURNS}\n    \
         [ \"$(wc -l <{work}/\"$task\".killed)\" -le {TIMES_IF_KILLED} ] || turns=0\n    \
         ;;\n  \
         *) turns=0 ;;\n\
         esac\n\
         if [ \"${{SLURM_RESTART_COUNT:-0}}\" -lt \"$turns\" ]; then\n  \
         scontrol requeue \"$SLURM_JOB_ID\"\n\
         fi\n\
         exit \"$code\"\n",
        head(plan, options, "render", "%a.log")?,
        plan.render_task("", plan.threads()),
    ))
}

/// The job of the merges, if there are any.
fn merge_job(plan: &Plan, options: &Options) -> Result<Option<String>, CliError> {
    let Some(last) = plan.merges().checked_sub(1) else { return Ok(None) };
    let log = if plan.frames.is_some() { "merge-%a.log" } else { "merge.log" };
    let (array, picture) = match plan.frames {
        Some(_) => (format!("#SBATCH --array=0-{last}\n"), "picture=$SLURM_ARRAY_TASK_ID\n"),
        None => (String::new(), ""),
    };
    Ok(Some(format!(
        "{}{array}#SBATCH --kill-on-invalid-dep=yes\nset -u\n{picture}{}\n",
        head(plan, options, "merge", log)?,
        plan.merge_picture("exec ", plan.threads()),
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_options_are_those_that_slurm_takes() {
        for good in ["90", "0", "90:30", "1:30:00", "2-12", "1-12:30", "1-12:30:00"] {
            assert_eq!(walltime(good).as_deref(), Ok(good));
        }
        for bad in ["", "abc", "2h", "1:", ":30", "-5", "1-", "1:2:3:4", "1-2-3"] {
            assert!(walltime(bad).is_err(), "{bad}");
        }
        assert_eq!(sbatch_option("--mem=8G").as_deref(), Ok("--mem=8G"));
        let refused = sbatch_option("mem=8G").expect_err("has no dash");
        assert_eq!(refused, "options begin with a dash, as in --sbatch=--mem=8G");
    }
}
