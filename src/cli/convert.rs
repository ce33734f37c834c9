//! `dapple convert`: a scene as plain glTF.

use std::path::PathBuf;
use std::process::ExitCode;

use serde_json::json;

use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::outputs::{self, Output};
use crate::cli::settings::parse::{MissingTextureArg, MtlTransparencyArg};
use crate::cli::{progress, text};
use crate::export::{self, Exported};
use crate::files::{self, Flush};
use crate::formats::{self, LoadOptions};

/// Write a scene as plain binary glTF 2.0, as it was understood.
///
/// Whatever the file was (glTF, OBJ, PLY or TOML), the result has triangles of floats, a node with
/// a matrix for each placed mesh, PNG images, and of the format's extensions those alone that tell
/// how materials answer to light, and lights: compression (Draco, meshopt, KTX2, WebP), quantised
/// and sparse numbers, copies by extension, variants and poses are resolved. A picture of it is
/// that of the original, to the bit where numbers can be written exactly.
///
/// glTF has no place for some things: what shines from all around, apertures, maps of heights.
/// Animations are left out, too: without --time all is in its rest pose. Each that is left out is
/// named; with --strict that is an error.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple convert robot.obj -o robot.glb
  dapple convert compressed.glb -o plain.glb
  dapple convert walk.glb --time 1.5 -o posed.glb
  dapple convert shoe.glb --variant midnight -o midnight.glb --json")]
pub struct ConvertArgs {
    /// The scene: .gltf, .glb, .obj, .ply or .toml
    #[arg(value_name = "SCENE")]
    scene_file: PathBuf,
    /// Where it goes: binary glTF (.glb)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Which of a glTF file's scenes, by name or number from 0
    #[arg(long, value_name = "NAME|N")]
    scene: Option<String>,
    /// A variant of a glTF file's materials, by name or number from 0
    #[arg(long, value_name = "NAME|N")]
    variant: Option<String>,
    /// Which of a glTF file's animations is posed, by name or number from 0
    #[arg(long, value_name = "NAME|N")]
    animation: Option<String>,
    /// The time at which animations are posed, seconds; without, all is in its rest pose
    #[arg(long, value_name = "SECONDS")]
    time: Option<f32>,
    /// Goes on without textures that cannot be read
    #[arg(long, value_name = "COLOUR")]
    missing_texture: Option<MissingTextureArg>,
    /// What transparency means in an OBJ file's materials, as for render
    #[arg(long, value_name = "HOW")]
    mtl_transparency: Option<MtlTransparencyArg>,
    /// Refuses what is not honoured, and what would be left out
    #[arg(long)]
    strict: bool,
    /// Prints a summary as one JSON object on standard output
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    quiet: Quiet,
}

/// Runs the command.
pub fn run(args: &ConvertArgs) -> Result<ExitCode, CliError> {
    let output = Output { flag: "-o", path: &args.output, ending: "glb" };
    outputs::check(&[output], &[&args.scene_file])?;
    let options = LoadOptions {
        strict: args.strict,
        missing_texture: MissingTextureArg::option(args.missing_texture),
        mtl_transparency: args.mtl_transparency.map(MtlTransparencyArg::option),
        scene: args.scene.clone(),
        variant: args.variant.clone(),
        animation: args.animation.clone(),
        time: args.time,
        ..LoadOptions::default()
    };
    let scene = formats::load(&args.scene_file, &options)?;
    if !args.quiet.quiet {
        scene.notices.iter().for_each(progress::note);
    }
    let mut written = Exported::default();
    let mut refused = None;
    files::write(&args.output, Flush::ToDisk, |file| {
        let exported = export::write(&scene, file)?;
        if args.strict && !exported.left_out.is_empty() {
            refused = Some(exported.left_out.join("; "));
            return Err(std::io::Error::other("refused"));
        }
        written = exported;
        Ok(())
    })
    .map_err(|error| match refused.take() {
        Some(what) => {
            let file = args.scene_file.display();
            CliError::Input(format!("{file}: --strict, and this would be left out: {what}"))
        }
        None => CliError::not_written(&args.output, &error),
    })?;
    let place = args.output.display();
    for what in &written.left_out {
        args.quiet.tell(&format!("note: {place}: left out: {what}"));
    }
    let export::Exported { triangles, placements, images, bytes, left_out } = written;
    let megabytes = bytes as f64 / 1e6;
    let counts = format!("{triangles} triangles, {placements} placements, {images} images");
    args.quiet.tell(&format!("{place}: {counts}, {megabytes:.1} MB"));
    if args.json {
        let summary = json!({
            "output": args.output, "triangles": triangles, "placements": placements,
            "images": images, "bytes": bytes, "left_out": left_out,
        });
        text::print(&format!("{summary}\n"))?;
    }
    Ok(ExitCode::SUCCESS)
}
