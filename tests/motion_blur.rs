//! What moves while the shutter is open, against how long it covers each place.

#[allow(dead_code)]
mod gltf_file;

use std::fs;
use std::path::Path;
use std::process::Command;

use dapple::film::{Picture, exr};
use gltf_file::File;
use serde_json::json;

const PIXELS: usize = 60;
const FRAME: &str = "--resolution 60x2 --filter box --env 0,0,0 --spp 256";

/// A shining square of a metre that stands from x = 0 on, seen six metres wide; node `moves`, 0 the
/// square and 1 the camera, goes a metre a second along +X for four seconds.
fn scene(moves: usize) -> File {
    let mut file = File::square();
    file.document["materials"][0] = json!({"extensions": {"KHR_materials_unlit": {}}});
    let view = json!({"xmag": 3.0, "ymag": 0.1, "znear": 0.1, "zfar": 10});
    file.push("cameras", json!({"type": "orthographic", "orthographic": view}));
    // In front of x = 0 to 6 for a square that moves, of -4 to 2 if it is the camera.
    let x = [3.0, -1.0][moves];
    file.push("nodes", json!({"camera": 0, "translation": [x, 0.5, 5]}));
    let start = [[0.0, 0.0, 0.0], [x as f32, 0.5, 5.0]][moves];
    let times = file.floats(&[[0.0], [4.0]], "SCALAR");
    let places = file.floats(&[start, [start[0] + 4.0, start[1], start[2]]], "VEC3");
    file.push(
        "animations",
        json!({
            "samplers": [{"input": times, "output": places}],
            "channels": [{"sampler": 0, "target": {"node": moves, "path": "translation"}}],
        }),
    );
    file
}

fn dapple(folder: &Path, words: &str) -> String {
    let binary = env!("CARGO_BIN_EXE_dapple");
    let output = Command::new(binary).args(words.split_whitespace()).current_dir(folder).output();
    let output = output.expect("it runs");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words}: {error}");
    String::from_utf8(output.stdout).expect("text")
}

fn folder(file: &File) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("a.gltf"), file.text()).expect("written");
    folder
}

/// The green of the first row.
fn row(picture: &Picture) -> &[f32] {
    &picture.channel("G").expect("has colours")[..PIXELS]
}

#[test]
fn a_place_is_as_bright_as_the_time_is_long_that_it_is_covered() {
    for moves in [0, 1] {
        let folder = folder(&scene(moves));
        let words = format!("render a.gltf -o a.exr -q {FRAME} --time 0.5 --shutter 3");
        dapple(folder.path(), &format!("{words} --moments 256"));
        let picture = exr::read(&folder.path().join("a.exr")).expect("a picture");
        let mut errors = 0.0;
        for (pixel, &value) in row(&picture).iter().enumerate() {
            let at = (pixel as f32 + 0.5) / 10.0;
            // By a camera that moves, all comes from the right, and leaves to the left.
            let x = [at, 5.0 - at][moves];
            let covered = (x.min(3.5) - (x - 1.0).max(0.5)).max(0.0) / 3.0;
            // As many samples as moments: where in its pixel an edge is met is left to chance.
            assert!((value - covered).abs() < 0.03, "{moves}, x = {at}: {value} for {covered}");
            errors += value - covered;
        }
        // Each edge passes a pixel in some 8 of the 256 moments, by chance: a standard deviation of
        // .007 a pixel, of .001 over all.
        assert!(errors.abs() / (PIXELS as f32) < 3e-3, "{moves}: {errors}");
    }
}

#[test]
fn a_moment_is_a_picture_at_a_time_and_the_first_lies_in_the_first_half() {
    let folder = folder(&scene(0));
    let dapple = |words: &str| dapple(folder.path(), words);
    let words = format!("{FRAME} --aov samples,position,variance -q");
    dapple(&format!("render a.gltf -o one.exr {words} --time 1 --shutter 2 --moments 1"));
    dapple(&format!("render a.gltf -o middle.exr {words} --time 2"));
    dapple("diff one.exr middle.exr --fail max=0 -q");

    // Four moments, in the middles of quarters 0, 2, 1, 3 of the time: x = .375, 1.875, 1.125,
    // 2.625.
    let blurred = "--time 0 --shutter 3 --moments 4";
    dapple(&format!("render a.gltf -o a.exr {words} {blurred}"));
    for (sample, x, lit) in [(0, 5, true), (64, 5, false), (64, 20, true), (128, 20, true)]
        .into_iter()
        .chain([(128, 12, true), (255, 35, true), (255, 20, false)])
    {
        let flag = format!("--debug-sample {x},0,{sample}");
        let path = dapple(&format!("render a.gltf {FRAME} -q {blurred} {flag}"));
        let hit = path.lines().any(|line| line.contains("light found"));
        assert_eq!(hit, lit, "{flag}:\n{path}");
    }
}

#[test]
fn motion_looks_the_same_by_all_structures_and_again_from_its_header() {
    let folder = folder(&scene(1));
    let dapple = |words: &str| dapple(folder.path(), words);
    let words = format!("{FRAME} --time 0.2 --shutter 1.5 --moments 5 --aov samples,depth -q");
    dapple(&format!("render a.gltf -o a.exr {words}"));
    for (more, threads) in [("bvh2", 1), ("kd-ropes", 2), ("bvh-packet", 7), ("brute", 1)] {
        dapple(&format!("render a.gltf -o b.exr {words} --accel {more} --threads {threads}"));
        dapple("diff a.exr b.exr --fail max=0 -q");
    }
    dapple("render --from a.exr -o b.exr -q");
    dapple("diff a.exr b.exr --fail max=0 -q");
    fs::write(
        folder.path().join("a.toml"),
        "[[place]]\nfile = 'a.gltf'\n[render]\nshutter = 1.5\nmoments = 5\ntime = 0.2\n",
    )
    .expect("written");
    dapple(&format!("render a.toml -o b.exr {FRAME} --aov samples,depth -q"));
    dapple("diff a.exr b.exr --fail max=0 -q");
}

#[test]
fn what_the_first_moment_left_open_stays_as_it_was_found_there() {
    // A light whose node has no size, and so no direction, in the second half, and a camera that
    // passes what it would focus on: no sky takes the light's place, and the lens stays as it is.
    let mut file = File::square();
    let cone = json!({"outerConeAngle": 1.2, "innerConeAngle": 1.1});
    let light = json!({"lights": [{"type": "spot", "intensity": 10, "spot": cone}]});
    file.document["extensions"] = json!({"KHR_lights_punctual": light});
    let on = json!({"KHR_lights_punctual": {"light": 0}});
    let node = file.push("nodes", json!({"translation": [0.5, 0.5, 1], "extensions": on}));
    let times = file.floats(&[[0.0], [1.0]], "SCALAR");
    let sizes = file.floats(&[[1.0; 3], [0.0; 3]], "VEC3");
    let channel = json!({"sampler": 0, "target": {"node": node, "path": "scale"}});
    let step = json!({"input": times, "output": sizes, "interpolation": "STEP"});
    file.push("animations", json!({"samplers": [step], "channels": [channel]}));
    let folder = folder(&file);
    let view = "--look-from 0.5,0.5,3 --look-at 0.5,0.5,0 --aperture 0.01 --resolution 4x4 -q";
    let words = format!("render a.gltf {view} --spp 64 --sampler independent");
    dapple(folder.path(), &format!("{words} -o lit.exr --time 0"));
    dapple(folder.path(), &format!("{words} -o half.exr --time 0 --shutter 2 --moments 2"));
    let mean = |name: &str| {
        let picture = exr::read(&folder.path().join(name)).expect("a picture");
        let green = picture.channel("G").expect("has colours");
        green.iter().sum::<f32>() / green.len() as f32
    };
    let (lit, half) = (mean("lit.exr"), mean("half.exr"));
    assert!(lit > 0.1 && (half / lit - 0.5).abs() < 0.05, "{lit} {half}");
}

#[test]
fn a_moment_that_fails_leaves_what_there_is() {
    // The camera's node has no size from the middle on.
    let mut file = scene(0);
    let times = file.floats(&[[0.0], [2.0]], "SCALAR");
    let sizes = file.floats(&[[1.0; 3], [0.0; 3]], "VEC3");
    let channel = json!({"sampler": 0, "target": {"node": 1, "path": "scale"}});
    let step = json!({"input": times, "output": sizes, "interpolation": "STEP"});
    file.document["animations"][0] = json!({"samplers": [step], "channels": [channel]});
    let folder = folder(&file);
    let words = format!("render a.gltf -o a.exr {FRAME} --time 0 --shutter 4 --moments 2");
    let binary = env!("CARGO_BIN_EXE_dapple");
    let output = Command::new(binary).args(words.split_whitespace()).current_dir(&folder).output();
    let output = output.expect("it runs");
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert!(error.contains("stopped: saved with 128 to 128 of 256 samples, in 1 of 2"), "{error}");
    assert!(error.contains("the node of a camera has no directions"), "{error}");
    assert!(folder.path().join("a.exr").exists());
}
