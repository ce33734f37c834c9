//! The flags of `dapple merge`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::outputs::Output;
use crate::cli::settings::parse::threads;
use crate::film::Tonemap;

/// Add up parts of a picture: the bytes are those of one render.
///
/// Parts are what `dapple render --partial` writes: some of the samples, or some of the pixels, of
/// one scene with the same settings. A part that is given twice counts once.
#[derive(Args, Clone, Debug)]
#[command(override_usage = "dapple merge [OPTIONS] -o <FILE> <PART>...")]
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
    pub parts: Vec<PathBuf>,
    /// Where to write the picture: an EXR with all its layers
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Where to write a PNG to look at
    #[arg(long, value_name = "FILE")]
    pub png: Option<PathBuf>,
    /// Where to write the part that they add up to
    #[arg(long, value_name = "FILE")]
    pub partial: Option<PathBuf>,
    /// Takes what there is, if every pixel has the same samples
    #[arg(long)]
    pub incomplete: bool,
    /// Leaves out of the EXR what differs between runs: time, command, layer `cost`
    #[arg(long)]
    pub reproducible: bool,
    /// How the PNG shows light [default: as the parts were rendered with]
    #[arg(long, value_name = "CURVE")]
    pub tonemap: Option<Tonemap>,
    /// Brightens the PNG by so many stops [default: as the parts were rendered with]
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true)]
    pub exposure: Option<f32>,
    /// Threads; 0: one per core
    #[arg(long, value_name = "N", default_value = "0", value_parser = threads)]
    pub threads: usize,
    /// Prints nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

impl MergeArgs {
    /// The files that it is to write.
    pub fn outputs(&self) -> Vec<Output<'_>> {
        let exr = self.output.as_deref().map(|path| Output { flag: "-o", path, ending: "exr" });
        let png = self.png.as_deref().map(|path| Output { flag: "--png", path, ending: "png" });
        let part = self.partial.as_deref();
        let part = part.map(|path| Output { flag: "--partial", path, ending: "part" });
        [exr, png, part].into_iter().flatten().collect()
    }

    /// Whether it is to write a picture.
    pub fn makes_picture(&self) -> bool {
        self.output.is_some() || self.png.is_some()
    }
}
