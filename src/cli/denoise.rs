//! `dapple denoise`: denoised colours for a picture that is there.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::outputs;
use crate::cli::settings::parse::{finite, threads};
use crate::denoise::Denoiser;
use crate::film::{Tonemap, exr};

/// Denoise a picture by Open Image Denoise: add a layer `denoised` to its layers.
///
/// The layers `albedo` and `normal` guide it, if the picture has them. The library is looked for:
/// what DAPPLE_OIDN names, the library or a folder that holds it; or else where the system has its
/// libraries; or else in the Python package that `pip install pyoidn` installs.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple denoise noisy.exr -o clean.exr
  dapple denoise noisy.exr -o clean.exr --png clean.png --exposure 1")]
pub struct DenoiseArgs {
    /// The picture (.exr)
    picture: PathBuf,
    /// Where to write the picture with its denoised layer: an EXR
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Where to write a PNG of the denoised layer
    #[arg(long, value_name = "FILE")]
    png: Option<PathBuf>,
    /// How the PNG shows light: agx or srgb
    #[arg(long, value_name = "CURVE", default_value = "agx")]
    tonemap: Tonemap,
    /// Brightens the PNG by so many stops
    #[arg(long, value_name = "STOPS", default_value = "0", value_parser = finite)]
    #[arg(allow_negative_numbers = true)]
    exposure: f32,
    /// Threads; 0: one per core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads)]
    threads: usize,
    #[command(flatten)]
    quiet: Quiet,
}

/// Runs the command.
///
/// # Errors
/// A library that is absent or cannot be used, a picture that cannot be read, outputs that cannot
/// be written.
pub fn run(args: &DenoiseArgs) -> Result<ExitCode, CliError> {
    let outputs = outputs::of_picture(args.output.as_deref(), args.png.as_deref());
    outputs::check_picture(&outputs, &[&args.picture])?;
    let mut picture = exr::read(&args.picture)?;
    let denoiser = Denoiser::find(args.threads)?;
    let start = Instant::now();
    denoiser.denoise(&mut picture, &args.picture)?;
    let seconds = start.elapsed().as_secs_f64();
    outputs::write_picture(&outputs, &picture, args.tonemap, args.exposure, None)?;
    let shown: Vec<String> = outputs.iter().map(|it| it.path.display().to_string()).collect();
    let name = denoiser.name();
    args.quiet.tell(&format!("{}: denoised by {name} in {seconds:.2} s", shown.join(", ")));
    Ok(ExitCode::SUCCESS)
}
