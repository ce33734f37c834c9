//! `dapple generate`: scenes made by rule.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Subcommand;
use serde_json::json;

use super::outputs::{self, Output};
use super::progress::say;
use super::{CliError, Quiet, table};
use crate::files::{self, Flush};
use crate::scene::generate::{Generator, TRIANGLES};

/// Make a scene by rule from a seed, of exactly as many triangles as asked for.
#[derive(clap::Args, Debug)]
pub struct GenerateArgs {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand, Debug)]
enum What {
    Assembly(SceneArgs),
}

/// A machine, dense and finely tessellated: for measuring structures by.
///
/// Engines, gearboxes, motors, heat exchangers and the like on a frame, with shafts, pipes, hoses
/// and cables between them: shells, fillets, tubes along curves, honeycombs, threaded screws,
/// springs and gears that overlap, of long thin triangles and of tiny ones, as CAD programs export
/// them. More triangles make more units and finer ones.
///
/// The file is binary glTF 2.0: a node, a mesh and a material a part, smooth normals where it is
/// round, no instances, so that every triangle is its own. It brings a camera, and light: three
/// emitting rectangles, which count among the triangles, and a weak directional light, which alone
/// is left where there are less than a dozen triangles or so.
///
/// The same number and seed give the same bytes on every machine.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple generate assembly --triangles 69451 -o machine.glb
  dapple render machine.glb -o machine.exr --png machine.png
  dapple generate assembly --triangles 4304391 --seed 7 -o car.glb --json")]
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
    }
}

fn generate(generator: Generator, args: &SceneArgs) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    outputs::check(&[Output { flag: "-o", path: &args.output, ending: "glb" }], &[])?;
    let mut written = None;
    files::write(&args.output, Flush::ToDisk, |file| {
        written = Some(generator.write(args.triangles, args.seed, file)?);
        Ok(())
    })
    .map_err(|error| CliError::not_written(&args.output, &error))?;
    let written = written.expect("was written without an error");
    let seconds = start.elapsed().as_secs_f64();
    if !args.quiet.quiet {
        say(&format!(
            "{}: {} triangles, {} vertices, {:.1} MB in {seconds:.2} s",
            args.output.display(),
            written.triangles,
            written.vertices,
            written.bytes as f64 / 1e6,
        ));
    }
    if args.json {
        let summary = json!({
            "output": args.output,
            "triangles": written.triangles,
            "vertices": written.vertices,
            "bytes": written.bytes,
            "seed": args.seed,
            "seconds": seconds,
        });
        table::print(&format!("{summary}\n"))?;
    }
    Ok(ExitCode::SUCCESS)
}
