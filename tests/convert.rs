//! `dapple convert`: what is written is what was read, without what glTF needs extensions for.

#[allow(dead_code)] // others need more of it
mod gltf_file;

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::Command;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use dapple::math::TextureId;
use dapple::scene::{Material, Scene};
use dapple::{LoadOptions, load};
use gltf_file::File;
use serde_json::json;

/// Extensions that plain files may have: how materials answer to light, and lights.
const PLAIN: [&str; 3] = ["KHR_materials_", "KHR_lights_punctual", "KHR_texture_transform"];

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder")
}

fn dapple(words: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_dapple")).args(words).output().expect("runs");
    (output.status.code(), String::from_utf8(output.stderr).expect("text"))
}

fn convert(from: &Path, to: &Path) -> String {
    let (code, told) = dapple(&["convert", path(from), "-o", path(to)]);
    assert_eq!(code, Some(0), "{told}");
    told
}

fn path(path: &Path) -> &str {
    path.to_str().expect("is text")
}

fn own(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn read(path: &Path) -> Scene {
    load(path, &LoadOptions::default()).expect("is a scene")
}

/// A material with nothing to tell which number its textures have.
fn without_numbers(material: &Material) -> Material {
    let mut material = material.clone();
    material.textures_mut().for_each(|texture| texture.texture = TextureId(0));
    material
}

fn assert_same(scene: &Scene, original: &Scene, name: &str) {
    assert_eq!(scene.instances.len(), original.instances.len(), "{name}");
    for (a, b) in scene.instances.iter().zip(&original.instances) {
        assert_eq!(a.transform, b.transform, "{name}");
        let (mesh, other) = (&scene.meshes[a.mesh.index()], &original.meshes[b.mesh.index()]);
        assert_eq!(mesh.positions, other.positions, "{name}: {}", other.name);
        assert_eq!(mesh.indices, other.indices, "{name}: {}", other.name);
        assert_eq!(
            (&mesh.uvs, &mesh.more_uvs, &mesh.colors),
            (&other.uvs, &other.more_uvs, &other.colors),
            "{name}: {}",
            other.name
        );
        // Unit vectors are made so again when they are read.
        assert_eq!(mesh.normals.len(), other.normals.len(), "{name}: {}", other.name);
        for (a, b) in mesh.normals.iter().zip(&other.normals) {
            assert!(a.distance(*b) < 1e-6, "{name}: {a} {b}");
        }
        let material = &original.materials[b.material.index()];
        let [ours, theirs] = [&scene.materials[a.material.index()], material].map(without_numbers);
        assert_eq!(ours, theirs, "{name}");
    }
    assert_eq!(scene.lights.len(), original.lights.len(), "{name}");
    for (a, b) in scene.lights.iter().zip(&original.lights) {
        assert_eq!((a.kind, a.position, a.range), (b.kind, b.position, b.range), "{name}");
        assert_eq!(a.intensity, b.intensity, "{name}");
        assert!(a.direction.distance(b.direction) < 1e-6, "{name}");
    }
    assert_eq!(scene.cameras.len(), original.cameras.len(), "{name}");
    for (a, b) in scene.cameras.iter().zip(&original.cameras) {
        assert_eq!((&a.name, a.aspect), (&b.name, b.aspect), "{name}");
        assert_eq!(a.camera.projection, b.camera.projection, "{name}");
        assert!(a.camera.to_world.abs_diff_eq(b.camera.to_world, 1e-5), "{name}");
    }
}

#[test]
fn scenes_of_all_kinds_are_read_back_as_they_were() {
    let folder = folder();
    let scenes = fs::read_dir(own("scenes")).expect("is there").map(|entry| entry.unwrap().path());
    let mut count = 0;
    for scene in scenes.filter(|path| path.extension().is_some_and(|it| it == "gltf")) {
        let name = scene.file_stem().unwrap().to_str().unwrap().to_owned();
        let made = folder.path().join(format!("{name}.glb"));
        convert(&scene, &made);
        let (ours, original) = (read(&made), read(&scene));
        assert_same(&ours, &original, &name);
        for extension in &ours.contents.extensions {
            let plain = PLAIN.iter().any(|plain| extension.name.starts_with(plain));
            assert!(plain && extension.honoured, "{name}: {}", extension.name);
        }
        count += 1;
    }
    assert!(count >= 15, "{count}");
}

#[test]
fn what_is_packed_is_unpacked() {
    let folder = folder();
    for name in [
        "ok-draco-edgebreaker.glb",
        "ok-draco-sequential.glb",
        "ok-meshopt-khr.gltf",
        "ok-sparse.gltf",
    ] {
        let packed = own("fuzz/corpus/gltf").join(name);
        let made = folder.path().join("plain.glb");
        convert(&packed, &made);
        assert_same(&read(&made), &read(&packed), name);
        let text = String::from_utf8_lossy(&fs::read(&made).unwrap()).into_owned();
        assert!(!["draco", "meshopt", "sparse"].iter().any(|word| text.contains(word)), "{name}");
    }
}

/// A square whose textures, of three texels, are looked up by four sets of coordinates.
fn four_sets() -> File {
    let mut file = File::square();
    let mut png = Vec::new();
    let texels = vec![255, 0, 0, 0, 255, 0, 0, 0, 0];
    let image = image::RgbImage::from_raw(3, 1, texels).expect("three texels");
    image.write_to(&mut Cursor::new(&mut png), image::ImageFormat::Png).expect("encodes");
    let [red, green, black] = [1.0, 3.0, 5.0].map(|sixths: f32| sixths / 6.0);
    for (set, u) in [(0, black), (1, green), (2, red), (3, green), (70_000, black)] {
        let uvs = file.floats(&[[u, 0.5]; 4], "VEC2");
        let attributes = &mut file.document["meshes"][0]["primitives"][0]["attributes"];
        attributes[format!("TEXCOORD_{set}")] = json!(uvs);
    }
    let uri = format!("data:image/png;base64,{}", STANDARD.encode(png));
    file.push("images", json!({ "uri": uri }));
    file.push("samplers", json!({ "magFilter": 9728, "minFilter": 9728 }));
    file.push("textures", json!({ "source": 0, "sampler": 0 }));
    let texture = |set: u32| json!({ "index": 0, "texCoord": set });
    // Green, rough and no metal; no emission and no lacquer where it is black.
    file.document["materials"][0] = json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": texture(3), "metallicRoughnessTexture": texture(1),
        },
        "emissiveFactor": [1, 1, 1],
        "emissiveTexture": texture(0),
        "extensions": { "KHR_materials_clearcoat": {
            "clearcoatFactor": 1, "clearcoatTexture": texture(70_000),
        } },
    });
    file.document["extensionsUsed"] = json!(["KHR_materials_clearcoat"]);
    file
}

/// More than two, and of any number: kept by `convert`, and looked up to the bit.
#[test]
fn all_sets_of_texture_coordinates_that_a_material_looks_up_are_kept() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("a.gltf"), four_sets().text()).expect("written");
    convert(&at("a.gltf"), &at("b.glb"));
    let (ours, original) = (read(&at("b.glb")), read(&at("a.gltf")));
    assert_same(&ours, &original, "four sets");
    // Set 2, which nothing looks up, is not kept.
    assert_eq!(original.meshes[0].uv_sets().count(), 4);
    for (from, to) in [("a.gltf", "a.exr"), ("b.glb", "b.exr")] {
        let words = "--strict --spp 4 --resolution 16x16 --reproducible -q --env 1,1,1 --fov 30 \
                     --look-from 0.5,0.5,1 --look-at 0.5,0.5,0";
        let words: Vec<&str> = words.split_whitespace().collect();
        let (code, told) =
            dapple(&[&["render", path(&at(from)), "-o", path(&at(to))], &words[..]].concat());
        assert_eq!(code, Some(0), "{told}");
    }
    let [a, b] = ["a.exr", "b.exr"].map(|name| dapple::Picture::read(at(name)).expect("a picture"));
    let middle = |channel| a.channel(channel).expect("a colour")[8 * 16 + 8];
    assert!(middle("G") > 0.8 && middle("R") < 0.1, "{} {}", middle("R"), middle("G"));
    for channel in ["R", "G", "B"] {
        assert!(a.channel(channel) == b.channel(channel), "{channel}");
    }
}

#[test]
fn a_picture_of_it_is_the_same_to_the_bit() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let scene = own("scenes/cornell.gltf");
    convert(&scene, &at("plain.glb"));
    for (from, to) in [(&scene, "a.exr"), (&at("plain.glb"), "b.exr")] {
        let words = ["--spp", "4", "--resolution", "48x48", "--reproducible", "-q"];
        let (code, told) =
            dapple(&[&["render", path(from), "-o", path(&at(to))], &words[..]].concat());
        assert_eq!(code, Some(0), "{told}");
    }
    let read = |name| dapple::Picture::read(at(name)).expect("a picture");
    let [a, b] = [read("a.exr"), read("b.exr")];
    assert_eq!(dapple::diff(&a, &b).expect("same size").errors.rmse, 0.0);
}

#[test]
fn what_has_no_place_is_named_and_refused_under_strict() {
    let folder = folder();
    let made = folder.path().join("tower.glb");
    let told = convert(&own("scenes/tower.obj"), &made);
    assert!(told.contains("left out: material \"brick wall\": a map of heights"), "{told}");
    fs::remove_file(&made).unwrap();
    let scene = own("scenes/tower.obj");
    let (code, told) = dapple(&["convert", path(&scene), "-o", path(&made), "--strict"]);
    assert_eq!(code, Some(3), "{told}");
    assert!(told.contains("--strict") && told.contains("a map of heights"), "{told}");
    assert!(!made.exists() && fs::read_dir(folder.path()).unwrap().count() == 0);
}

/// What render is told of a scene, convert is told as well.
#[test]
fn an_obj_file_is_converted_as_it_is_rendered() {
    let folder = folder();
    let [obj, made] = ["a.obj", "a.glb"].map(|name| folder.path().join(name));
    fs::write(&obj, "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n").unwrap();
    fs::write(folder.path().join("a.mtl"), "newmtl m\nTr 0.25\nmap_Kd no.png\n").unwrap();
    let alpha = |how: &str| {
        let flags = ["--mtl-transparency", how, "--missing-texture", "magenta"];
        let words = [&["convert", path(&obj), "-o", path(&made)], &flags[..]].concat();
        let (code, told) = dapple(&words);
        assert_eq!(code, Some(0), "{told}");
        let scene = read(&made);
        assert_eq!(scene.textures.len(), 1);
        scene.materials[scene.instances[0].material.index()].base_color.w
    };
    assert_eq!((alpha("d"), alpha("tr")), (0.25, 0.75));
    let (code, told) = dapple(&["convert", path(&obj), "-o", path(&made)]);
    assert!(code == Some(3) && told.contains("--missing-texture magenta goes on"), "{told}");
}

/// A square a tenth of a millimetre before a camera whose sight begins nearer still.
fn near_camera(animated: bool) -> File {
    let mut file = File::square();
    file.document["nodes"][0]["scale"] = json!([1e-4, 1e-4, 1e-4]);
    file.document["nodes"][0]["translation"] = json!([-5e-5, -5e-5, -5e-4]);
    let lens = json!({"yfov": 0.5, "znear": 1e-4, "zfar": 7.5, "aspectRatio": 1});
    file.push("cameras", json!({"type": "perspective", "perspective": lens}));
    file.push("nodes", json!({"camera": 0}));
    if animated {
        let times = file.floats(&[[0.0], [2.0]], "SCALAR");
        let places = file.floats(&[[-5e-5, -5e-5, -5e-4], [0.0, 0.0, -5e-4]], "VEC3");
        let channel = json!({"sampler": 0, "target": {"node": 0, "path": "translation"}});
        let samplers = json!([{"input": times, "output": places}]);
        file.push("animations", json!({"samplers": samplers, "channels": [channel]}));
    }
    file
}

/// What render is asked to refuse it must find in the original alone.
#[test]
fn planes_of_cameras_are_kept_or_cut_nothing() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("a.gltf"), near_camera(false).text()).expect("written");
    // One of a TOML scene has no planes: such are chosen.
    let toml = "[[place]]\nfile = \"a.gltf\"\n[[camera]]\nlook-from = [0, 0, 0]\n\
                look-at = [0, 0, -1]\nfov = 30\n";
    fs::write(at("b.toml"), toml).expect("written");
    for scene in ["a.gltf", "b.toml"] {
        convert(&at(scene), &at("c.glb"));
        let strict = LoadOptions { strict: true, ..LoadOptions::default() };
        let made = load(at("c.glb"), &strict).expect("nothing is cut");
        let planes = made.cameras[0].planes.expect("glTF has them");
        if scene == "a.gltf" {
            assert_eq!((planes.near, planes.far), (1e-4, Some(7.5)));
        } else {
            assert!(planes.near < 5e-4 && planes.near > 1e-4 && planes.far.is_none(), "{planes:?}");
        }
    }
}

#[test]
fn animations_are_left_out_and_named_unless_a_time_is_given() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let (scene, made) = (at("a.gltf"), at("a.glb"));
    fs::write(&scene, near_camera(true).text()).expect("written");
    let told = convert(&scene, &made);
    let said = "left out: ";
    assert!(told.contains(said) && told.contains("/animations: all is in its rest pose"), "{told}");
    fs::remove_file(&made).expect("is there");
    let words = ["convert", path(&scene), "-o", path(&made), "--strict"];
    let (code, told) = dapple(&words);
    assert!(code == Some(3) && told.contains("would be left out") && !made.exists(), "{told}");
    let (code, told) = dapple(&[&words[..], &["--time", "1"]].concat());
    assert!(code == Some(0) && !told.contains(said), "{told}");
    let place = read(&made).instances[0].transform.to_world().translation;
    assert!((place.x + 2.5e-5).abs() < 1e-9, "{place}");
}
