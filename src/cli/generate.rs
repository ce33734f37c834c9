//! `dapple generate`: scenes made by rule.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Subcommand;
use serde_json::{Value, json};

use crate::camera::flight;
use crate::cli::error::CliError;
use crate::cli::flags::{Quiet, seed, whole};
use crate::cli::outputs::{self, Output};
use crate::cli::text;
use crate::files::{self, Flush};
use crate::generate::{FOREST_COPIES, FOREST_TRIANGLES, Forest, Generator, TRIANGLES};

/// Make a scene by rule from a seed, of exactly as many triangles as asked for.
#[derive(clap::Args, Debug)]
pub struct GenerateArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand, Debug)]
enum What {
    /// A machine, dense and finely tessellated: for measuring structures by.
    ///
    /// Engines, gearboxes, motors, heat exchangers and the like on a frame, with shafts, pipes,
    /// hoses and cables between them: shells, fillets, tubes along curves, honeycombs, threaded
    /// screws, springs and gears that overlap, of long thin triangles and of tiny ones, as CAD
    /// programs export them. More triangles make more units and finer ones.
    ///
    /// The file is binary glTF 2.0: a node, a mesh and a material for each part, smooth normals
    /// where it is round, and no instances, so that every triangle is its own. It has a camera, and
    /// light: three emitting rectangles, which count among the triangles, and a weak directional
    /// light. With less than a dozen triangles or so, only the latter is left.
    ///
    /// The same number and seed give the same bytes on every machine.
    #[command(after_help = "\
Examples:
  dapple generate assembly --triangles 69451 -o machine.glb
  dapple render machine.glb -o machine.exr --png machine.png
  dapple generate assembly --triangles 4304391 --seed 7 -o car.glb --json")]
    Assembly(SceneArgs),
    /// A town of houses and towers along streets, with parks, lamps and cars: few triangles, most
    /// of them large.
    ///
    /// More triangles make more blocks and more of each house. It has two directional lights, a
    /// camera, and a flight through the streets and over the roofs.
    ///
    /// The same number and seed give the same bytes on every machine.
    #[command(after_help = "\
Examples:
  dapple generate city -o city.glb --path city.txt
  dapple bench coherent city.glb --path city.txt")]
    #[command(mut_arg("triangles", |arg| arg.required(false).default_value("9200")))]
    City(SceneArgs),
    /// A kitchen: a closed room with furniture, crockery and appliances, from large walls down to
    /// tines.
    ///
    /// No ray leaves it. More triangles make all of it finer. It has emitting panels, lamps and a
    /// window, a point light of limited range over the table, a camera, and a flight around the
    /// room.
    ///
    /// The same number and seed give the same bytes on every machine.
    #[command(after_help = "\
Examples:
  dapple generate kitchen -o kitchen.glb --path kitchen.txt
  dapple render kitchen.glb -o kitchen.exr --png kitchen.png")]
    #[command(mut_arg("triangles", |arg| arg.required(false).default_value("103000")))]
    Kitchen(SceneArgs),
    /// Open land: hills around a lake, woods, rocks, a hut and a fence.
    ///
    /// More triangles make finer ground and more trees. It has two directional lights, a camera,
    /// and a flight over the water and through the woods.
    ///
    /// The same number and seed give the same bytes on every machine.
    #[command(after_help = "\
Examples:
  dapple generate landscape -o land.glb --path land.txt
  dapple generate landscape --triangles 5000000 --seed 3 -o large.glb")]
    #[command(mut_arg("triangles", |arg| arg.required(false).default_value("644000")))]
    Landscape(SceneArgs),
    /// A forest: kinds of trees, bushes, grass, ferns, flowers and stones, placed as often as you
    /// like: for scenes that are far larger than memory would hold without copies.
    ///
    /// More triangles make finer kinds, more copies make a larger forest and denser grass. The file
    /// is binary glTF 2.0 with EXT_mesh_gpu_instancing: a copy takes 32 bytes. It has a camera in a
    /// glade, and an animation that moves the camera along a trail for 24 seconds. It has no
    /// light: --scene writes a TOML scene beside it that puts it under sun and sky.
    ///
    /// The same numbers and seed give the same bytes on every machine.
    #[command(after_help = "\
Examples:
  dapple generate forest -o forest.glb --scene forest.toml
  dapple render forest.toml -o forest.exr --png forest.png
  dapple generate forest --triangles 5000000 --copies 1000000 -o large.glb --scene large.toml")]
    Forest(ForestArgs),
}

/// Flags of a forest.
#[derive(clap::Args, Debug)]
struct ForestArgs {
    /// Triangles of all kinds and of the ground, each counted once, exactly: 4000 to 60000000
    #[arg(
        long, value_name = "N", default_value_t = 40_000,
        value_parser = whole(FOREST_TRIANGLES)
    )]
    triangles: u64,
    /// Plants and stones: 1 to 100000000
    #[arg(
        long, value_name = "M", default_value_t = 5000,
        value_parser = whole(FOREST_COPIES)
    )]
    copies: u64,
    /// Where a scene goes that places the forest under sun and sky (.toml), beside it
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    common: CommonArgs,
}

/// Flags of all scenes but the forest.
#[derive(clap::Args, Debug)]
struct SceneArgs {
    /// Triangles of the scene, exactly: 1 to 20000000
    #[arg(long, value_name = "N", value_parser = whole(TRIANGLES))]
    triangles: u64,
    #[command(flatten)]
    common: CommonArgs,
}

/// Flags of all.
#[derive(clap::Args, Debug)]
struct CommonArgs {
    /// Another number, another scene
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = seed)]
    seed: u64,
    /// Where the scene goes: binary glTF (.glb)
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Where the path of a camera goes: a line each, eye, target, up and angle of view
    #[arg(long, value_name = "FILE")]
    path: Option<PathBuf>,
    #[command(flatten)]
    quiet: Quiet,
    /// Prints a summary as one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(args: &GenerateArgs) -> Result<ExitCode, CliError> {
    match &args.what {
        What::Assembly(args) => generate(Generator::Assembly, args),
        What::City(args) => generate(Generator::City, args),
        What::Kitchen(args) => generate(Generator::Kitchen, args),
        What::Landscape(args) => generate(Generator::Landscape, args),
        What::Forest(args) => generate_forest(args),
    }
}

impl CommonArgs {
    /// The outputs that it names.
    fn outputs(&self) -> Vec<Output<'_>> {
        let path = self.path.as_deref().map(|path| Output { flag: "--path", path, ending: "txt" });
        let scene = Output { flag: "-o", path: &self.output, ending: "glb" };
        std::iter::once(scene).chain(path).collect()
    }

    /// Writes the scene by `write`, and the path of its camera.
    fn write<W>(
        &self,
        write: impl FnOnce(&mut dyn Write) -> io::Result<W>,
        flight: impl FnOnce() -> Vec<flight::Pose>,
    ) -> Result<W, CliError> {
        let mut written = None;
        files::write(&self.output, Flush::ToDisk, |file| {
            written = Some(write(file)?);
            Ok(())
        })
        .map_err(|error| CliError::not_written(&self.output, &error))?;
        if let Some(path) = &self.path {
            write_text(path, &flight::write(&flight()))?;
        }
        Ok(written.expect("was written without an error"))
    }

    /// Tells what was written since `start`: `counts` in words, and `summary` as JSON.
    fn tell(
        &self,
        start: Instant,
        (counts, bytes): (&str, u64),
        mut summary: Value,
    ) -> Result<ExitCode, CliError> {
        let seconds = start.elapsed().as_secs_f64();
        let (output, megabytes) = (&self.output, bytes as f64 / 1e6);
        let place = output.display();
        self.quiet.tell(&format!("{place}: {counts}, {megabytes:.1} MB in {seconds:.2} s"));
        if self.json {
            summary["output"] = json!(output);
            summary["path"] = json!(self.path);
            summary["bytes"] = json!(bytes);
            summary["seed"] = json!(self.seed);
            summary["seconds"] = json!(seconds);
            text::print(&format!("{summary}\n"))?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn write_text(path: &Path, text: &str) -> Result<(), CliError> {
    files::write(path, Flush::ToDisk, |file| file.write_all(text.as_bytes()))
        .map_err(|error| CliError::not_written(path, &error))
}

fn generate_forest(args: &ForestArgs) -> Result<ExitCode, CliError> {
    let (start, common) = (Instant::now(), &args.common);
    let scene = args.scene.as_deref();
    let mut outputs = common.outputs();
    outputs.extend(scene.map(|path| Output { flag: "--scene", path, ending: "toml" }));
    outputs::check(&outputs, &[])?;
    if scene.is_some_and(|scene| scene.parent() != common.output.parent()) {
        let message = "--scene must be in the folder of -o, whose file it places";
        return Err(CliError::Usage(message.to_owned()));
    }
    let forest = Forest::new(args.triangles, args.copies, common.seed);
    let written = common.write(|file| forest.write(file), || forest.flight())?;
    if let Some(scene) = scene {
        let name = common.output.file_name().unwrap_or_default().to_string_lossy();
        write_text(scene, &Forest::scene(&name))?;
    }
    let counts = format!(
        "{} triangles, {} copies, {} triangles placed",
        written.triangles, written.copies, written.placed
    );
    let summary = json!({
        "scene": args.scene,
        "triangles": written.triangles,
        "copies": written.copies,
        "placed_triangles": written.placed,
        "vertices": written.vertices,
    });
    common.tell(start, (&counts, written.bytes), summary)
}

fn generate(generator: Generator, args: &SceneArgs) -> Result<ExitCode, CliError> {
    let (start, triangles, common) = (Instant::now(), args.triangles, &args.common);
    outputs::check(&common.outputs(), &[])?;
    let written = common.write(
        |file| generator.write(triangles, common.seed, file),
        || generator.flight(triangles, common.seed),
    )?;
    let counts = format!("{} triangles, {} vertices", written.triangles, written.vertices);
    let summary = json!({
        "triangles": written.triangles,
        "vertices": written.vertices,
    });
    common.tell(start, (&counts, written.bytes), summary)
}
