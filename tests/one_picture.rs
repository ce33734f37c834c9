//! The same picture, to the bit, whatever shoots the rays and on however many threads.

use std::path::{Path, PathBuf};
use std::process::Command;

use dapple::Isa;
use dapple::accel::VARIANTS;
use dapple::film::{Picture, exr};

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name)
}

/// What pictures are rendered with unless arguments say otherwise.
const SMALL: &[&str] = &["--resolution", "40x30", "--spp", "20"];

/// Renders a small picture with further arguments.
fn render(folder: &Path, scene_name: &str, arguments: &[&str]) -> Picture {
    let out = folder.join("out.exr");
    let output = Command::new(env!("CARGO_BIN_EXE_dapple"))
        .arg("render")
        .arg(scene(scene_name))
        .arg("-o")
        .arg(&out)
        .args(["--quiet"])
        .args(if arguments.contains(&"--spp") { &[] } else { SMALL })
        .args(arguments)
        .output()
        .expect("the binary runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    exr::read(&out).expect("what was written can be read")
}

/// All channels but `cost` hold the same bits.
fn assert_same(a: &Picture, b: &Picture, what: &str) {
    assert_eq!(a.channels().len(), b.channels().len(), "{what}");
    let mut compared = 0;
    for (a, b) in a.channels().iter().zip(b.channels()) {
        assert_eq!(a.name, b.name, "{what}");
        if a.name.starts_with("cost") {
            continue;
        }
        let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert!(bits(&a.samples) == bits(&b.samples), "{what}: channel {} differs", a.name);
        compared += 1;
    }
    assert!(compared >= 4, "{what}: only {compared} channels");
}

#[test]
fn every_structure_and_instruction_set_gives_the_same_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, isa) in [("cornell.gltf", "auto"), ("alpha.gltf", "portable")] {
        let expected = render(folder.path(), name, &["--accel", "brute", "--threads", "1"]);
        for variant in VARIANTS {
            let words = ["--accel", variant.id, "--threads", "7", "--isa", isa];
            let picture = render(folder.path(), name, &words);
            assert_same(&picture, &expected, &format!("{name} with {}", variant.id));
        }
        for isa in Isa::available() {
            let picture = render(folder.path(), name, &["--isa", isa.name()]);
            assert_same(&picture, &expected, &format!("{name} with --isa {isa}"));
        }
    }
}

/// Settings under which rays are as unlike one another as they get: through a lens, and from within
/// the geometry.
const CAMERAS: [&[&str]; 3] = [
    &[],
    &["--aperture", "0.05", "--focus", "3"],
    &["--look-from", "0.02,0.03,0.01", "--look-at", "0.4,0.1,-1"],
];

#[test]
fn structures_give_the_same_picture_of_every_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    // Neither 16 nor 8 divides it.
    let small = ["--resolution", "21x13", "--spp", "2", "--env", "0.5,0.6,0.7"];
    let mut pictures = 0;
    for (number, name) in scenes().iter().enumerate() {
        let common = [&small[..], CAMERAS[number / 3 % CAMERAS.len()]].concat();
        let with = |accel: &str, threads: &str| {
            let words = ["--accel", accel, "--threads", threads];
            render(folder.path(), name, &[&common[..], &words].concat())
        };
        let expected = with("brute", "1");
        // A third of the structures in each, so that each stands before some five of them.
        for (row, variant) in VARIANTS.iter().enumerate().skip(number % 3).step_by(3) {
            let threads = ["1", "2", "7"][(row / 3 + number / 3) % 3];
            let what = format!("{name} with {} on {threads} threads", variant.id);
            assert_same(&with(variant.id, threads), &expected, &what);
            pictures += 1;
        }
    }
    assert!(pictures > 4 * VARIANTS.len(), "only {pictures} pictures");
}

/// All scenes of the project.
fn scenes() -> Vec<String> {
    let files = std::fs::read_dir(scene("")).expect("a folder of scenes");
    let name = |file: std::io::Result<std::fs::DirEntry>| {
        file.expect("a file").file_name().into_string().expect("a name in UTF-8")
    };
    let mut names: Vec<_> = files.map(name).collect();
    let ending = |name: &str| Path::new(name).extension().map(std::ffi::OsStr::to_owned);
    names.retain(|name| ending(name).is_some_and(|ending| ending == "gltf" || ending == "obj"));
    names.sort();
    names
}

#[test]
fn the_number_of_threads_does_not_show() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["glass.gltf", "instanced.gltf"] {
        let expected = render(folder.path(), name, &["--threads", "1"]);
        for threads in ["2", "7"] {
            let picture = render(folder.path(), name, &["--threads", threads]);
            assert_same(&picture, &expected, &format!("{name} on {threads} threads"));
        }
        // Each thread with a cache of one line, in which every leaf takes another's place.
        for id in ["bvh2", "mbvh4", "mbvh8", "mbvh16"] {
            let accel = format!("{id}:triangles=cache,cache=1");
            let picture = render(folder.path(), name, &["--threads", "7", "--accel", &accel]);
            assert_same(&picture, &expected, &format!("{name} with {accel}"));
        }
    }
}
