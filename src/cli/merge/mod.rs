//! `dapple merge`: parts in, a picture or a larger part out.
//!
//! | file | what it does |
//! |---|---|
//! | `args` | its flags |
//! | `gaps` | the commands that fill what is missing |
//! | `picture` | the picture, some lines at a time |

mod args;
mod gaps;
mod picture;

use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use crate::cli::error::CliError;
use crate::cli::input::run_on_threads;
use crate::cli::outputs;
use crate::cli::progress::say;
use crate::cli::text::format_count;
use crate::files::{self, Flush};
use crate::part::{Merge, PartError};
pub use args::MergeArgs;

/// Runs the command.
pub fn run(args: &MergeArgs) -> Result<ExitCode, CliError> {
    let outputs = args.outputs();
    if outputs.is_empty() {
        return Err(CliError::Usage("nowhere to put the picture: give -o FILE.exr".to_owned()));
    }
    let inputs: Vec<&Path> = args.parts.iter().map(PathBuf::as_path).collect();
    outputs::check(&outputs, &inputs)?;
    let merge = Merge::new(&args.parts, args.makes_picture())?;
    check_gaps(args, &merge)?;
    if !args.quiet {
        for (a, b) in merge.repeated() {
            let (a, b) = (a.path().display(), b.path().display());
            say(&format!("note: {b}: the same samples as {a}; they count once"));
        }
    }
    if merge.lost_count() > 0 {
        say(&format!("warning: {} samples were not finite and are left out", merge.lost_count()));
    }
    run_on_threads(args.threads, || {
        outputs::try_all([
            args.partial.as_ref().map_or(Ok(()), |path| write_part(path, &merge)),
            if args.makes_picture() { picture::write(args, &merge) } else { Ok(()) },
        ])
    })??;
    if !args.quiet {
        let made: Vec<String> = outputs.iter().map(|it| it.path.display().to_string()).collect();
        let count = format_count(merge.parts().len() as u64, "part", "parts");
        let spp = merge.head().spp;
        say(&format!("{}: {count} of a picture of {spp} spp", made.join(", ")));
    }
    Ok(ExitCode::SUCCESS)
}

/// Makes sure that there is enough for what is asked for.
fn check_gaps(args: &MergeArgs, merge: &Merge) -> Result<(), CliError> {
    if merge.gaps().is_empty() {
        return Ok(());
    }
    if !args.incomplete {
        return Err(PartError::Gap(gaps::describe(merge)?).into());
    }
    if args.partial.is_some() {
        let message = "--incomplete makes pictures only: a part has no gaps".to_owned();
        return Err(CliError::Usage(message));
    }
    if !merge.is_even() {
        let uneven = "some pixels have other samples than others: they make no picture";
        let message = format!("{uneven}\n{}", gaps::describe(merge)?);
        return Err(PartError::Gap(message).into());
    }
    let counted = gaps::describe_samples(merge);
    say(&format!("note: incomplete: {counted}"));
    Ok(())
}

fn write_part(path: &Path, merge: &Merge) -> Result<(), CliError> {
    let mut wrong = None;
    let written = files::write(path, Flush::ToDisk, |file| match merge.write_part(file) {
        Ok(written) => written,
        Err(error) => {
            wrong = Some(error);
            Err(io::Error::other("not written"))
        }
    });
    match wrong {
        Some(error) => Err(error.into()),
        None => written.map_err(|source| CliError::not_written(path, &source)),
    }
}
