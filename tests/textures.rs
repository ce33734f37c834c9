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

/// The bytes of a picture of the scene, and what the render tells of textures.
fn render(folder: &Path, memory: &str, words: &str) -> (Vec<u8>, Value) {
    let out = folder.join("out.exr");
    let start = Instant::now();
    let output = Command::new(env!("CARGO_BIN_EXE_dapple"))
        .args(["render", "scene.gltf", "-o", "out.exr", "--env", "1,1,1", "--reproducible"])
        .args(["--json", "-q", "--look-from", "2,3,9", "--look-at", "2,1,1"])
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
    let words = "--resolution 96x64 --spp 16";
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
    let words = "--resolution 96x64 --spp 4";
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

/// A hundred textures of 4096 by 4096: 4.2 GB of texels in 512 MiB. Its times are printed.
#[test]
#[ignore = "takes minutes, 1 GB of disk and 6 GB of memory"]
fn a_hundred_large_textures_give_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    write_scene(folder.path(), 100, 4096);
    let words = "--resolution 1280x720 --spp 16";
    let (unlimited, _) = render(folder.path(), "1TiB", words);
    let (limited, told) = render(folder.path(), "512MiB", words);
    assert!(limited == unlimited, "{told}");
    assert_eq!(told["tiled"], 100);
}
