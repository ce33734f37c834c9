//! A shutter that is open for some time against the mean of many stills: a fan at 10,000 turns a
//! minute, a camera on a rail, and legs that walk, by a z-test of groups of renders.

#[allow(dead_code)]
mod gltf_file;

use std::fs;
use std::path::Path;
use std::process::Command;

use dapple::film::exr;
use dapple::testing::Random;
use gltf_file::File;
use serde_json::json;

const WIDTH: usize = 32;
const HEIGHT: usize = 24;
/// Pixels of a tile, each way.
const TILE: usize = 8;
const TILES: usize = (WIDTH / TILE) * (HEIGHT / TILE);
/// Independent groups on either side, from which the test has its variances.
const GROUPS: usize = 8;
/// Stills of a group.
const STILLS: usize = 12;

/// The means of a picture's tiles, of green.
type Tiles = [f64; TILES];

/// A turn about an axis of length 1, as glTF writes it.
fn turn(axis: [f32; 3], degrees: f32) -> [f32; 4] {
    let (sine, cosine) = libm::sincosf(degrees.to_radians() * 0.5);
    [axis[0] * sine, axis[1] * sine, axis[2] * sine, cosine]
}

/// A camera that looks along -Z, with a floor and a wall of squares. For what moves there are a
/// dark material and a dark square, number 1 of each.
fn stage(camera: [f32; 3]) -> (File, usize) {
    let mut file = File::square();
    let base = json!({"baseColorFactor": [0.6, 0.6, 0.6, 1.0], "metallicFactor": 0});
    file.document["materials"][0] = json!({"doubleSided": true, "pbrMetallicRoughness": base});
    let dark = json!({"baseColorFactor": [0.1, 0.1, 0.1, 1.0], "metallicFactor": 0});
    file.push("materials", json!({"doubleSided": true, "pbrMetallicRoughness": dark}));
    let mut square = file.document["meshes"][0].clone();
    square["primitives"][0]["material"] = json!(1);
    file.push("meshes", square);
    let wall = json!({"mesh": 0, "translation": [-3, -3, -2], "scale": [6, 6, 1]});
    file.document["nodes"][0] = wall;
    let floor = turn([1.0, 0.0, 0.0], -90.0);
    file.push(
        "nodes",
        json!({"mesh": 0, "translation": [-3, -1.5, 3], "rotation": floor, "scale": [6, 6, 1]}),
    );
    let view = json!({"yfov": 0.8, "znear": 0.1});
    file.push("cameras", json!({"type": "perspective", "perspective": view}));
    let camera = file.push("nodes", json!({"camera": 0, "translation": camera}));
    (file, camera)
}

/// Adds an animation of tracks: node, property and values, evenly from 0 to `seconds`.
fn animate(file: &mut File, seconds: f32, tracks: &[(usize, &str, Vec<Vec<f32>>)]) {
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for (node, path, values) in tracks {
        let last = (values.len() - 1) as f32;
        let times: Vec<[f32; 1]> =
            (0..values.len()).map(|key| [seconds * key as f32 / last]).collect();
        let input = file.floats(&times, "SCALAR");
        let output = if *path == "rotation" {
            let values: Vec<[f32; 4]> =
                values.iter().map(|v| v[..].try_into().expect("four numbers")).collect();
            file.floats(&values, "VEC4")
        } else {
            let values: Vec<[f32; 3]> =
                values.iter().map(|v| v[..].try_into().expect("three numbers")).collect();
            file.floats(&values, "VEC3")
        };
        let target = json!({"node": node, "path": path});
        channels.push(json!({"sampler": samplers.len(), "target": target}));
        samplers.push(json!({"input": input, "output": output}));
    }
    file.push("animations", json!({"samplers": samplers, "channels": channels}));
}

/// Three blades, which turn 2.8 times in a sixtieth of a second.
fn fan() -> File {
    let (mut file, _) = stage([0.0, 0.0, 5.0]);
    let blade = |number: u8| {
        let rotation = turn([0.0, 0.0, 1.0], 120.0 * f32::from(number));
        json!({"mesh": 1, "rotation": rotation, "scale": [1.4, 0.5, 1]})
    };
    let blades: Vec<usize> = (0..3).map(|number| file.push("nodes", blade(number))).collect();
    let spinner = file.push("nodes", json!({"children": blades}));
    let tilt = turn([0.0, 1.0, 0.0], 30.0);
    file.push("nodes", json!({"children": [spinner], "rotation": tilt}));
    let turns = 10_000.0 / 60.0 / 60.0;
    let keys = (0..=12_u8).map(|key| f32::from(key) / 12.0 * turns * 360.0);
    let values = keys.map(|degrees| turn([0.0, 0.0, 1.0], degrees).to_vec()).collect();
    animate(&mut file, 1.0 / 60.0, &[(spinner, "rotation", values)]);
    file
}

/// A camera that goes past three squares and turns.
fn rail() -> File {
    let (mut file, camera) = stage([-1.0, 0.0, 5.0]);
    for x in [-1.6, 0.0, 1.1] {
        file.push("nodes", json!({"mesh": 0, "translation": [x, -0.8, x], "scale": [0.6, 1.5, 1]}));
    }
    let places = [[-1.0, 0.0, 5.0], [0.0, 0.4, 4.2], [1.0, 0.4, 5.0]];
    let turns = [-12.0, 0.0, 12.0].map(|degrees| turn([0.0, 1.0, 0.0], degrees).to_vec());
    let places = places.map(|place| place.to_vec()).to_vec();
    let tracks = [(camera, "translation", places), (camera, "rotation", turns.to_vec())];
    animate(&mut file, 1.0, &tracks);
    file
}

/// Two legs of one skin, with hips and knees, that stride.
fn walk() -> File {
    let (mut file, _) = stage([0.0, 0.0, 5.0]);
    let (mut positions, mut joints, mut weights, mut indices) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    const ROWS: u8 = 12;
    for leg in 0..2_u8 {
        let first = leg * 2 * (ROWS + 1);
        for row in 0..=ROWS {
            let y = 1.0 - 2.0 * f32::from(row) / f32::from(ROWS);
            let knee = (0.5 - 2.5 * y).clamp(0.0, 1.0);
            for side in [-0.2, 0.2] {
                positions.push([side, y, 0.4 * f32::from(leg)]);
                joints.extend([2 * leg, 2 * leg + 1, 0, 0]);
                weights.push([1.0 - knee, knee, 0.0, 0.0]);
            }
            if row < ROWS {
                let a = first + 2 * row;
                indices.extend([a, a + 1, a + 3, a, a + 3, a + 2]);
            }
        }
    }
    let count = indices.len();
    let indices = file.accessor(&indices, 5121, count, "SCALAR");
    let attributes = json!({
        "POSITION": file.floats(&positions, "VEC3"),
        "JOINTS_0": file.accessor(&joints, 5121, positions.len(), "VEC4"),
        "WEIGHTS_0": file.floats(&weights, "VEC4"),
    });
    let primitive = json!({"attributes": attributes, "indices": indices, "material": 1});
    let mesh = file.push("meshes", json!({"primitives": [primitive]}));
    let mut bones = Vec::new();
    let mut inverse = Vec::new();
    for leg in 0..2_u8 {
        let z = 0.4 * f32::from(leg);
        let knee = file.push("nodes", json!({"translation": [0, -1, 0]}));
        let hip = file.push("nodes", json!({"children": [knee], "translation": [0, 1, z]}));
        bones.extend([hip, knee]);
        for y in [1.0, 0.0] {
            let mut columns = [0.0_f32; 16];
            for axis in 0..4 {
                columns[5 * axis] = 1.0;
            }
            [columns[13], columns[14]] = [-y, -z];
            inverse.push(columns);
        }
    }
    let inverse = file.floats(&inverse, "MAT4");
    file.push("skins", json!({"joints": bones, "inverseBindMatrices": inverse}));
    file.push("nodes", json!({"mesh": mesh, "skin": 0}));
    let swing = |degrees: [f32; 3]| degrees.map(|it| turn([0.0, 0.0, 1.0], it).to_vec()).to_vec();
    let tracks = [
        (bones[0], "rotation", swing([40.0, 0.0, -40.0])),
        (bones[1], "rotation", swing([-10.0, -5.0, -50.0])),
        (bones[2], "rotation", swing([-40.0, 0.0, 40.0])),
        (bones[3], "rotation", swing([-50.0, -70.0, -10.0])),
    ];
    animate(&mut file, 0.5, &tracks);
    file
}

/// Renders `a.gltf` of a folder.
fn render(folder: &Path, words: &str, seed: usize) -> Tiles {
    let size = format!("--resolution {WIDTH}x{HEIGHT} --env 1,0.9,0.8 --filter box --max-depth 3");
    let words = format!("render a.gltf -o a.exr -q {size} {words} --seed {seed}");
    let binary = env!("CARGO_BIN_EXE_dapple");
    let output = Command::new(binary).args(words.split_whitespace()).current_dir(folder).output();
    let output = output.expect("it runs");
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    let picture = exr::read(&folder.join("a.exr")).expect("a picture");
    let green = picture.channel("G").expect("has colours");
    let mut tiles = [0.0; TILES];
    for (pixel, &value) in green.iter().enumerate() {
        let (x, y) = (pixel % WIDTH / TILE, pixel / WIDTH / TILE);
        tiles[y * (WIDTH / TILE) + x] += f64::from(value) / (TILE * TILE) as f64;
    }
    tiles
}

/// Of independent estimates of a tile: the mean, and its variance.
fn statistics(groups: &[Tiles], tile: usize) -> (f64, f64) {
    let count = groups.len() as f64;
    let mean = groups.iter().map(|group| group[tile]).sum::<f64>() / count;
    let off = groups.iter().map(|group| group[tile] - mean);
    let squares: f64 = off.map(|off| off * off).sum();
    (mean, squares / (count - 1.0) / count)
}

/// Holds a blurred picture against stills of its file; `shutter` is when it opens and how long it
/// is open, seconds.
fn compare(file: &File, shutter: [f64; 2]) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("a.gltf"), file.text()).expect("written");
    let [open, long] = shutter;
    let blurred = |group| {
        let words = format!("--time {open} --shutter {long} --spp 64");
        render(folder.path(), &words, group)
    };
    let blurred: Vec<Tiles> = (0..GROUPS).map(blurred).collect();
    let random = &mut Random::new(4, 0);
    let mut stills = [[0.0; TILES]; GROUPS];
    for (group, mean) in stills.iter_mut().enumerate() {
        for still in 0..STILLS {
            let part = (still as f64 + f64::from(random.unit())) / STILLS as f64;
            let words = format!("--time {} --spp 8", open + long * part);
            let found = render(folder.path(), &words, 1000 + group * STILLS + still);
            mean.iter_mut().zip(found).for_each(|(mean, tile)| *mean += tile / STILLS as f64);
        }
    }
    let still = render(folder.path(), &format!("--time {open} --spp 64"), 0);
    let (mut square, mut worst, mut seen) = (0.0, 0.0_f64, 0.0_f64);
    for tile in 0..TILES {
        let ((a, of_a), (b, of_b)) = (statistics(&blurred, tile), statistics(&stills, tile));
        // What is all alike has no variance: the sky, to the rounding of f32.
        let z = (a - b) / (of_a + of_b + 1e-12).sqrt();
        square += z * z / TILES as f64;
        worst = worst.max(z.abs());
        seen = seen.max((a - still[tile]).abs());
    }
    assert!(seen > 0.02, "a blurred picture is another than a still: {seen}");
    // z is as Student's t of 14 degrees of freedom or a few less: a deviation of 1.1.
    assert!(square < 2.5 && worst < 5.0, "z: {} on average, {worst} at most", square.sqrt());
}

#[test]
fn a_fan_at_ten_thousand_turns_a_minute_is_the_mean_of_stills() {
    compare(&fan(), [0.0, 1.0 / 60.0]);
}

#[test]
fn a_camera_on_a_rail_sees_the_mean_of_stills() {
    compare(&rail(), [0.2, 0.7]);
}

#[test]
fn legs_that_walk_are_the_mean_of_stills() {
    compare(&walk(), [0.05, 0.4]);
}
