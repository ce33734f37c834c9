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
        dapple(folder.path(), &format!("render a.gltf -o a.exr -q {FRAME} --time 0.5 --shutter 3"));
        let picture = exr::read(&folder.path().join("a.exr")).expect("a picture");
        let mut errors = 0.0;
        for (pixel, &value) in row(&picture).iter().enumerate() {
            let at = (pixel as f32 + 0.5) / 10.0;
            // By a camera that moves, all comes from the right, and leaves to the left.
            let x = [at, 5.0 - at][moves];
            let covered = (x.min(3.5) - (x - 1.0).max(0.5)).max(0.0) / 3.0;
            // Time and place are stratified, though not together: a standard deviation of some
            // .007 where an edge passes.
            assert!((value - covered).abs() < 0.03, "{moves}, x = {at}: {value} for {covered}");
            errors += value - covered;
        }
        assert!(errors.abs() / (PIXELS as f32) < 3e-3, "{moves}: {errors}");
    }
}

#[test]
fn each_sample_has_a_time_of_its_own_which_is_told() {
    let folder = folder(&scene(0));
    let dapple = |words: &str| dapple(folder.path(), words);
    let mut seen = [false; 16];
    for sample in 0..64 {
        let flag = format!("--debug-sample 20,0,{sample}");
        let path = dapple(&format!("render a.gltf {FRAME} -q --time 0 --shutter 3 {flag}"));
        let told = path.lines().find_map(|line| line.strip_prefix("time ")).expect("is told");
        let time: f32 = told.split(' ').next().expect("a number").parse().expect("a number");
        assert!((0.0..1.0).contains(&time));
        seen[(time * 16.0) as usize] = true;
        // The middle of the pixel is at x = 2.05; the square is there from 1.05 to 2.05 seconds,
        // but for the pixel's width.
        let lit = path.lines().any(|line| line.contains("light found"));
        let at = 3.0 * time;
        if (at - 1.05).abs() > 0.06 && (at - 2.05).abs() > 0.06 {
            assert_eq!(lit, (1.05..2.05).contains(&at), "{flag}:\n{path}");
        }
    }
    assert!(seen.iter().all(|&seen| seen), "spread over all of the time: {seen:?}");
}

#[test]
fn motion_looks_the_same_by_all_structures_and_again_from_its_header() {
    let folder = folder(&scene(1));
    let dapple = |words: &str| dapple(folder.path(), words);
    let words = format!("{FRAME} --time 0.2 --shutter 1.5 --aov samples,depth -q");
    dapple(&format!("render a.gltf -o a.exr {words}"));
    for (more, threads) in [("bvh2", 1), ("kd-ropes", 2), ("bvh-packet", 7), ("brute", 1)] {
        dapple(&format!("render a.gltf -o b.exr {words} --accel {more} --threads {threads}"));
        dapple("diff a.exr b.exr --fail max=0 -q");
    }
    dapple("render --from a.exr -o b.exr -q");
    dapple("diff a.exr b.exr --fail max=0 -q");
    fs::write(
        folder.path().join("a.toml"),
        "[[place]]\nfile = 'a.gltf'\n[render]\nshutter = 1.5\ntime = 0.2\n",
    )
    .expect("written");
    dapple(&format!("render a.toml -o b.exr {FRAME} --aov samples,depth -q"));
    dapple("diff a.exr b.exr --fail max=0 -q");
}

#[test]
fn a_light_shines_as_long_as_its_node_has_directions() {
    // Its node has no size, and so no direction, in the second half.
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
    dapple(folder.path(), &format!("{words} -o half.exr --time 0 --shutter 2"));
    let mean = |name: &str| {
        let picture = exr::read(&folder.path().join(name)).expect("a picture");
        let green = picture.channel("G").expect("has colours");
        green.iter().sum::<f32>() / green.len() as f32
    };
    let (lit, half) = (mean("lit.exr"), mean("half.exr"));
    assert!(lit > 0.1 && (half / lit - 0.5).abs() < 0.05, "{lit} {half}");
}

#[test]
fn a_camera_that_looks_nowhere_at_times_is_refused() {
    // Its node has no size from the middle on.
    let mut file = scene(0);
    let times = file.floats(&[[0.0], [2.0]], "SCALAR");
    let sizes = file.floats(&[[1.0; 3], [0.0; 3]], "VEC3");
    let channel = json!({"sampler": 0, "target": {"node": 1, "path": "scale"}});
    let step = json!({"input": times, "output": sizes, "interpolation": "STEP"});
    file.document["animations"][0] = json!({"samplers": [step], "channels": [channel]});
    let folder = folder(&file);
    let words = format!("render a.gltf -o a.exr {FRAME} --time 0 --shutter 4");
    let binary = env!("CARGO_BIN_EXE_dapple");
    let output = Command::new(binary).args(words.split_whitespace()).current_dir(&folder).output();
    let output = output.expect("it runs");
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert!(error.contains("a.gltf: /nodes/1: its camera looks nowhere at times"), "{error}");
}
