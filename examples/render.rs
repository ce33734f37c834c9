//! A scene's file to an EXR: `cargo run --release --example render -- SCENE.gltf PICTURE.exr`.

use std::error::Error;
use std::path::PathBuf;

use dapple::{AccelSpec, BsdfForm, Control, Isa, LoadOptions, Settings, World};

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args_os().skip(1).map(PathBuf::from);
    let file = args.next().unwrap_or("scenes/cornell.gltf".into());
    let output = args.next().unwrap_or(std::env::temp_dir().join("cornell.exr"));

    let settings = Settings { spp: 16, ..Settings::new(128, 128) };
    let mut scene = dapple::load(&file, &LoadOptions::default())?;
    // A camera that sees all and a neutral sky, where the file has neither.
    scene.add_defaults(settings.aspect());
    let camera = scene.cameras[0].camera;
    let world = World::new(scene, BsdfForm::default())?;
    let accel = dapple::build(&AccelSpec::default(), world.triangles.clone(), Isa::default())?;
    let rendered = dapple::render(&world, camera, &*accel, &settings, &Control::default());
    rendered.picture.write_exr(&output)?;
    Ok(())
}
