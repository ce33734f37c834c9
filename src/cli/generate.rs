//! `dapple generate`: scenes made by rule.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Subcommand;
use serde_json::json;

use crate::camera::flight;
use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::outputs::{self, Output};
use crate::cli::text;
use crate::files::{self, Flush};
use crate::generate::{Generator, TRIANGLES};

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
}

/// Flags of all scenes.
#[derive(clap::Args, Debug)]
struct SceneArgs {
    /// Triangles of the scene, exactly: 1 to 20000000
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(TRIANGLES))]
    triangles: u64,
    /// Another number, another scene
    #[arg(long, value_name = "S", default_value_t = 0)]
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
    }
}

fn generate(generator: Generator, args: &SceneArgs) -> Result<ExitCode, CliError> {
    let (start, triangles) = (Instant::now(), args.triangles);
    let path = args.path.as_deref().map(|path| Output { flag: "--path", path, ending: "txt" });
    let scene = Output { flag: "-o", path: &args.output, ending: "glb" };
    outputs::check(&std::iter::once(scene).chain(path).collect::<Vec<_>>(), &[])?;
    let mut written = None;
    files::write(&args.output, Flush::ToDisk, |file| {
        written = Some(generator.write(triangles, args.seed, file)?);
        Ok(())
    })
    .map_err(|error| CliError::not_written(&args.output, &error))?;
    if let Some(path) = &args.path {
        let text = flight::write(&generator.flight(triangles, args.seed));
        files::write(path, Flush::ToDisk, |file| file.write_all(text.as_bytes()))
            .map_err(|error| CliError::not_written(path, &error))?;
    }
    let written = written.expect("was written without an error");
    let seconds = start.elapsed().as_secs_f64();
    args.quiet.tell(&format!(
        "{}: {} triangles, {} vertices, {:.1} MB in {seconds:.2} s",
        args.output.display(),
        written.triangles,
        written.vertices,
        written.bytes as f64 / 1e6,
    ));
    if args.json {
        let summary = json!({
            "output": args.output,
            "path": args.path,
            "triangles": written.triangles,
            "vertices": written.vertices,
            "bytes": written.bytes,
            "seed": args.seed,
            "seconds": seconds,
        });
        text::print(&format!("{summary}\n"))?;
    }
    Ok(ExitCode::SUCCESS)
}
