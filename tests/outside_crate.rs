//! A crate outside renders a picture by the public surface alone.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::SystemTime;
use std::{env, fs};

/// What such a crate would write; `dapple` is all that it knows.
const PROGRAM: &str = r#"
use dapple::{AccelSpec, BsdfForm, Control, Isa, LoadOptions, Picture, Settings, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let settings = Settings { spp: 4, ..Settings::new(48, 48) };
    let mut scene = dapple::load(&args[1], &LoadOptions::default())?;
    scene.add_defaults(settings.aspect());
    let camera = scene.cameras[0].camera;
    let world = World::new(scene, BsdfForm::default())?;
    let accel = dapple::build(&AccelSpec::default(), world.triangles.clone(), Isa::default())?;
    let rendered = dapple::render(&world, &camera, &*accel, &settings, &Control::default());
    rendered.picture.write_exr(&args[2])?;
    let flip = dapple::diff(&Picture::read(&args[2])?, &Picture::read(&args[3])?)?.flip;
    if flip > 0.0 { Err(format!("FLIP is {flip}").into()) } else { Ok(()) }
}
"#;

/// Beside this test lie the crate's library and all that it depends on.
fn dependencies() -> PathBuf {
    let test = env::current_exe().expect("a running test");
    test.parent().expect("a folder").to_owned()
}

/// The library as the newest build made it.
fn library(folder: &Path) -> PathBuf {
    let modified = |path: &PathBuf| {
        fs::metadata(path).and_then(|data| data.modified()).unwrap_or(SystemTime::UNIX_EPOCH)
    };
    let entries = fs::read_dir(folder).expect("a folder of dependencies");
    let paths = entries.map(|entry| entry.expect("readable").path());
    let libraries = paths.filter(|path| {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        name.starts_with("libdapple-") && path.extension().is_some_and(|ending| ending == "rlib")
    });
    libraries.max_by_key(modified).expect("the library was built")
}

#[test]
fn a_crate_outside_renders_the_cornell_box() {
    let folder = tempfile::tempdir().expect("a folder");
    let (source, program) = (folder.path().join("main.rs"), folder.path().join("outside"));
    fs::write(&source, PROGRAM).expect("written");
    let dependencies = dependencies();
    let rustc = env::var_os("RUSTC").unwrap_or("rustc".into());
    let compiled = Command::new(rustc)
        .args(["--edition", "2024", "--crate-name", "outside", "-o"])
        .args([&program, &source])
        .arg("-L")
        .arg(format!("dependency={}", dependencies.display()))
        .arg("--extern")
        .arg(format!("dapple={}", library(&dependencies).display()))
        .output()
        .expect("the compiler runs");
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));

    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/cornell.gltf");
    let expected = folder.path().join("command.exr");
    let command = Command::new(env!("CARGO_BIN_EXE_dapple"))
        .arg("render")
        .arg(&scene)
        .arg("-o")
        .arg(&expected)
        .args(["--resolution", "48x48", "--spp", "4", "--quiet"])
        .status();
    assert!(command.expect("the command runs").success());
    let ran = Command::new(&program)
        .args([&scene, &folder.path().join("outside.exr"), &expected])
        .output()
        .expect("the program runs");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
}
