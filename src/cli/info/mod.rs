//! `dapple info`: what a scene holds, or a part of a picture.

mod json;
mod part;
mod report;
mod text;

use std::path::PathBuf;
use std::process::ExitCode;

use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::text::print;
use crate::formats::{self, LoadOptions, MissingTexture};
use crate::part::is_part;
use crate::scene::defaults::bounds;
use crate::scene::{SceneMemory, Survey};
use report::Report;

/// Report what a scene holds, what of it is not honoured, and what looks like a mistake; or what is
/// in a part of a picture.
///
/// The scene is loaded as for a render; textures that cannot be read are magenta. Memory is that of
/// meshes, their placements and decoded textures, and an estimate for the structure that `render`
/// builds over meshes, each once, and over placements.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple info scenes/cornell.gltf
  dapple info model.glb --scene 1 --variant midnight
  dapple info scan.ply --json
  dapple info scene.part")]
pub struct InfoArgs {
    /// The scene: .gltf, .glb, .obj, .ply or .toml; or a part, or a checkpoint
    #[arg(value_name = "SCENE")]
    scene_file: PathBuf,
    /// Which of a glTF file's scenes, by name or number from 0
    #[arg(long, value_name = "NAME|N")]
    scene: Option<String>,
    /// A variant of a glTF file's materials, by name or number from 0
    #[arg(long, value_name = "NAME|N")]
    variant: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    quiet: Quiet,
}

/// Runs the command.
pub fn run(args: &InfoArgs) -> Result<ExitCode, CliError> {
    if is_part(&args.scene_file) {
        return part::run(&args.scene_file, args.json);
    }
    let options = LoadOptions {
        missing_texture: MissingTexture::Magenta,
        scene: args.scene.clone(),
        variant: args.variant.clone(),
        ..LoadOptions::default()
    };
    let scene = formats::load(&args.scene_file, &options)?;
    let survey = Survey::of(&scene);
    let faults = survey.find_faults(&scene);
    let file = args.scene_file.display().to_string();
    let report = Report {
        file: &file,
        bounds: bounds(&scene),
        scene: &scene,
        survey: &survey,
        memory: SceneMemory::of(&scene),
        faults,
    };
    print(&if args.json { report.to_json() } else { report.to_text() })?;
    Ok(ExitCode::SUCCESS)
}
