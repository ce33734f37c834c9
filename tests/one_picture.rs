//! The same picture, to the bit, whatever shoots the rays and on however many threads.

use std::path::{Path, PathBuf};
use std::process::Command;

use dapple::accel::VARIANTS;
use dapple::film::{Picture, exr};
use dapple::simd::Isa;

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name)
}

/// Renders a small picture with further arguments.
fn render(folder: &Path, scene_name: &str, arguments: &[&str]) -> Picture {
    let out = folder.join("out.exr");
    let output = Command::new(env!("CARGO_BIN_EXE_dapple"))
        .arg("render")
        .arg(scene(scene_name))
        .arg("-o")
        .arg(&out)
        .args(["--resolution", "40x30", "--spp", "20", "--quiet"])
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
