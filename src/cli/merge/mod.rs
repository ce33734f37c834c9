//! `dapple merge`: parts in, a picture or a larger part out.
//!
//! | file | what it does |
//! |---|---|
//! | `gaps` | the commands that fill what is missing |
//! | `picture` | the picture, some lines at a time |

mod gaps;
mod picture;

use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;

use crate::cli::error::CliError;
use crate::cli::input::run_on_threads;
use crate::cli::outputs::{self, Output};
use crate::cli::progress::say;
use crate::cli::settings::parse::threads;
use crate::files::{self, Flush};
use crate::film::Tonemap;
use crate::part::{Merge, PartError};

/// Add up parts of a picture: the bytes are those of one render.
///
/// Parts are what `dapple render --partial` writes: some of the samples, or some of the pixels, of
/// one scene with the same settings. A part that is given twice counts once.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  dapple render scene.gltf --spp 256 --part 0/2 --partial a.part
  dapple render scene.gltf --spp 256 --part 1/2 --partial b.part
  dapple merge a.part b.part -o scene.exr --png scene.png

  dapple merge node1/*.part --partial node1.part
  dapple render scene.gltf --samples 256..512 --partial more.part
  dapple merge a.part b.part more.part -o better.exr")]
pub struct MergeArgs {
    /// The parts
    #[arg(value_name = "PART", required = true)]
    parts: Vec<PathBuf>,
    /// Where to write the picture: an EXR with all its layers
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Where to write a PNG to look at
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// Where to write the part that they add up to
    #[arg(long, value_name = "FILE")]
    partial: Option<PathBuf>,
    /// Takes what there is, if every pixel has the same samples
    #[arg(long)]
    incomplete: bool,
    /// Leaves out of the EXR what differs between runs: time, command, layer `cost`
    #[arg(long)]
    reproducible: bool,
    /// How the PNG shows light [default: as the parts were rendered with]
    #[arg(long, value_name = "CURVE")]
    tonemap: Option<Tonemap>,
    /// Brightens the PNG by so many stops [default: as the parts were rendered with]
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true)]
    exposure: Option<f32>,
    /// Threads; 0: one per core
    #[arg(long, value_name = "N", default_value = "0", value_parser = threads)]
    threads: usize,
    /// Prints nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

impl MergeArgs {
    fn outputs(&self) -> Vec<Output<'_>> {
        let exr = self.output.as_deref().map(|path| Output { flag: "-o", path, ending: "exr" });
        let png = self.png.as_deref().map(|path| Output { flag: "--png", path, ending: "png" });
        let part = self.partial.as_deref();
        let part = part.map(|path| Output { flag: "--partial", path, ending: "part" });
        [exr, png, part].into_iter().flatten().collect()
    }

    fn makes_picture(&self) -> bool {
        self.output.is_some() || self.png.is_some()
    }
}

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
    run_on_threads(args.threads, || {
        outputs::try_all([
            args.partial.as_ref().map_or(Ok(()), |path| write_part(path, &merge)),
            if args.makes_picture() { picture::write(args, &merge) } else { Ok(()) },
        ])
    })??;
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
