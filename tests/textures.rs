//! Textures that do not fit in the memory that they may take: the same picture, byte by byte.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use dapple::film::exr;
use image::{DynamicImage, GrayImage, ImageFormat, RgbImage, RgbaImage};
use rayon::prelude::*;
use serde_json::{Value, json};

/// A floor and a wall of square tiles, each with a texture of its own: `count` of them, of so many
/// texels a side. Light goes from one to the other.
fn write_scene(folder: &Path, count: usize, side: u32) {
    (0..count).into_par_iter().for_each(|number| {
        let path = folder.join(format!("{number}.png"));
        picture(number as u32, side).save_with_format(path, ImageFormat::Png).expect("written");
    });
    let corners: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let mut bytes: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let uvs: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    bytes.extend(uvs.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    let columns = (count as f64 / 2.0).sqrt().ceil() as usize;
    let node = |number: usize| {
        let (on_wall, at) = (number % 2 == 1, number / 2);
        let (x, y) = ((at % columns) as f64, (at / columns) as f64);
        if on_wall {
            json!({ "mesh": number, "translation": [x, y, 0] })
        } else {
            // Lying: up is towards the viewer.
            let half = std::f64::consts::FRAC_1_SQRT_2;
            let turned = [-half, 0.0, 0.0, half];
            json!({ "mesh": number, "translation": [x, 0, y + 1.0], "rotation": turned })
        }
    };
    let each = |make: &dyn Fn(usize) -> Value| (0..count).map(make).collect::<Vec<_>>();
    let document = json!({
        "asset": { "version": "2.0" },
        "buffers": [{
            "byteLength": bytes.len(),
            "uri": format!("data:;base64,{}", STANDARD.encode(&bytes)),
        }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 32 },
            { "buffer": 0, "byteOffset": 80, "byteLength": 12 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
              "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
        "images": each(&|number| json!({ "uri": format!("{number}.png") })),
        "textures": each(&|number| json!({ "source": number })),
        "materials": each(&|number| json!({ "pbrMetallicRoughness": {
            "baseColorTexture": { "index": number }, "metallicFactor": 0,
        }})),
        "meshes": each(&|number| json!({ "primitives": [{
            "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2, "material": number,
        }]})),
        "nodes": each(&node),
        "scenes": [{ "nodes": (0..count).collect::<Vec<_>>() }],
        "scene": 0,
    });
    fs::write(folder.join("scene.gltf"), document.to_string()).expect("written");
}

/// Waves and grain; one in four is grey, one in four has alpha.
fn picture(number: u32, side: u32) -> DynamicImage {
    let value = |x: u32, y: u32| {
        let (x, y) = (x.wrapping_add(number * 977), y.wrapping_mul(number % 7 + 1));
        let grain = (x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b)) >> 28;
        ((x / 3 + y / 5) % 224 + grain) as u8
    };
    match number % 4 {
        0 => GrayImage::from_fn(side, side, |x, y| [value(x, y)].into()).into(),
        1 => RgbaImage::from_fn(side, side, |x, y| {
            [value(x, y), (x >> 4) as u8, number as u8, value(y, x) | 3].into()
        })
        .into(),
        _ => RgbImage::from_fn(side, side, |x, y| [value(x, y), value(y, x), (x ^ y) as u8].into())
            .into(),
    }
}

/// Where the tiles are seen from.
const VIEW: &str = "--look-from 2,3,9 --look-at 2,1,1";

/// The bytes of a picture of the scene, and what the render tells of textures.
fn render(folder: &Path, memory: &str, words: &str) -> (Vec<u8>, Value) {
    let out = folder.join("out.exr");
    let start = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_dapple"))
        .args(["render", "scene.gltf", "-o", "out.exr", "--env", "1,1,1", "--reproducible"])
        .args(["--json", "-q"])
        .args(words.split_whitespace())
        .args(["--texture-memory", memory])
        .current_dir(folder)
        .output()
        .expect("the binary runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let told: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    eprintln!("{memory}: {:.1} s, {told}", start.elapsed().as_secs_f64());
    (fs::read(out).expect("written"), told["textures"].clone())
}

/// The mean of green in `out.exr`.
fn mean_green(folder: &Path) -> f32 {
    let picture = exr::read(&folder.join("out.exr")).expect("a picture");
    let green = picture.channel("G").expect("green");
    green.iter().sum::<f32>() / green.len() as f32
}

#[test]
fn levels_are_the_same_in_tiles_and_as_bright_as_the_images() {
    let folder = tempfile::tempdir().expect("a folder");
    write_scene(folder.path(), 24, 512);
    let words = &format!("--resolution 96x64 --spp 16 {VIEW}");
    render(folder.path(), "1TiB", words);
    let without = mean_green(folder.path());
    let words = format!("{words} --texture-lod on");
    let (unlimited, told) = render(folder.path(), "1TiB", &words);
    let with = mean_green(folder.path());
    assert!((with / without - 1.0).abs() < 0.02, "{with} and {without}");
    assert_eq!((&told["images"], &told["tiled"]), (&json!(24 * 10), &json!(0)));
    let (limited, told) = render(folder.path(), "2MiB", &words);
    assert!(limited == unlimited, "{told}");
    assert!(told["tiled"].as_u64().expect("a number") > 24, "{told}");
}

#[test]
fn a_small_limit_gives_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    write_scene(folder.path(), 24, 512);
    let words = &format!("--resolution 96x64 --spp 4 {VIEW}");
    let (unlimited, told) = render(folder.path(), "1TiB", words);
    assert_eq!(told["tiled"], 0);
    for threads in ["1", "3"] {
        let words = format!("{words} --threads {threads}");
        let (limited, told) = render(folder.path(), "2MiB", &words);
        assert!(limited == unlimited, "{told}");
        assert_eq!((&told["images"], &told["tiled"]), (&json!(24), &json!(24)));
        let figure = |name: &str| told["tiles"][name].as_u64().expect("a number");
        assert!(figure("evicted") > 0 && figure("peak_bytes") <= 2 << 20, "{told}");
    }
}

/// A KTX2 file of a picture of so many texels a side, whose levels have a colour each.
fn levels_of_colors(side: u32, colors: &[[u8; 3]]) -> Vec<u8> {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/ktx2/ok-uastc.ktx2");
    let sample = fs::read(sample).expect("is part of the project");
    let words = [0, 1, side, side, 0, 0, 1, colors.len() as u32, 0];
    let (descriptor_at, descriptor) = (80 + 24 * colors.len(), &sample[176..220]);
    let mut file = sample[..12].to_vec();
    file.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    file.extend([descriptor_at as u32, 44, 0, 0].iter().flat_map(|word| word.to_le_bytes()));
    file.extend([0; 16]);
    let (mut index, mut blocks) = (Vec::new(), Vec::new());
    for (number, color) in colors.iter().enumerate() {
        let [r, g, b] = color.map(u128::from);
        // UASTC's mode of one colour: five bits of mode, then four bytes.
        let block: u128 = 0x17 | r << 5 | g << 13 | b << 21 | 255 << 29;
        let count = (side >> number).max(1).div_ceil(4).pow(2);
        let length = u64::from(count * 16);
        let start = (descriptor_at + descriptor.len() + blocks.len()) as u64;
        index.extend([start, length, length].iter().flat_map(|long| long.to_le_bytes()));
        blocks.extend(block.to_le_bytes().repeat(count as usize));
    }
    [file, index, descriptor.to_vec(), blocks].concat()
}

/// The mean of a square of four pixels in the middle of `out.exr`.
fn middle(folder: &Path, side: usize) -> [f32; 3] {
    let picture = exr::read(&folder.join("out.exr")).expect("a picture");
    ["R", "G", "B"].map(|name| {
        let values = picture.channel(name).expect("a colour");
        let at = |y: usize, x: usize| values[(side / 2 - 1 + y) * side + side / 2 - 1 + x];
        (at(0, 0) + at(0, 1) + at(1, 0) + at(1, 1)) / 4.0
    })
}

/// What its file holds is seen from afar, in memory and in tiles; the rest is made from the last.
#[test]
fn levels_of_a_ktx2_file_are_seen_where_the_footprint_asks_for_them() {
    let folder = tempfile::tempdir().expect("a folder");
    write_scene(folder.path(), 1, 64);
    let text = fs::read_to_string(folder.path().join("scene.gltf")).expect("written");
    let mut document: Value = serde_json::from_str(&text).expect("JSON");
    document["nodes"] = json!([{ "mesh": 0 }]);
    document["images"] = json!([{ "uri": "0.ktx2" }]);
    let basis = json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } });
    document["textures"] = json!([basis]);
    document["extensionsUsed"] = json!(["KHR_texture_basisu"]);
    fs::write(folder.path().join("scene.gltf"), document.to_string()).expect("written");
    let [red, green, blue] = [[255, 0, 0], [0, 255, 0], [0, 0, 255]];
    fs::write(folder.path().join("0.ktx2"), levels_of_colors(64, &[red, green, blue]))
        .expect("written");
    // The square is one by one and fills the frame: so many texels a pixel.
    let seen = |side: usize, lod: &str| {
        let words = format!(
            "--resolution {side}x{side} --spp 4 --fov 6 --texture-lod {lod} \
             --look-from 0.5,0.5,9.5 --look-at 0.5,0.5,0 --strict"
        );
        let (unlimited, told) = render(folder.path(), "1TiB", &words);
        let whole = middle(folder.path(), side);
        let (limited, in_tiles) = render(folder.path(), "1KiB", &words);
        assert!(limited == unlimited, "{told} {in_tiles}");
        assert_eq!(in_tiles["tiled"], 1);
        assert_eq!(told["images"], if lod == "on" { 7 } else { 1 });
        whole.map(|value| value > 0.1)
    };
    assert_eq!(seen(128, "on"), [true, false, false]);
    assert_eq!(seen(32, "on"), [false, true, false]);
    for side in [16, 8, 4] {
        assert_eq!(seen(side, "on"), [false, false, true], "{side}");
        assert_eq!(seen(side, "off"), [true, false, false], "{side}");
    }
}

/// A hundred textures of 4096 by 4096: 4.2 GB of texels in 512 MiB. Its times are printed.
#[test]
#[ignore = "takes minutes, 1 GB of disk and 6 GB of memory"]
fn a_hundred_large_textures_give_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    write_scene(folder.path(), 100, 4096);
    let words = &format!("--resolution 1280x720 --spp 16 {VIEW}");
    let (unlimited, _) = render(folder.path(), "1TiB", words);
    let (limited, told) = render(folder.path(), "512MiB", words);
    assert!(limited == unlimited, "{told}");
    assert_eq!(told["tiled"], 100);
}
