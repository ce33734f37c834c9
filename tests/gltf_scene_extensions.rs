//! What extensions of nodes, scenes, animations and textures of glTF make of a scene.

mod gltf_file;

use std::fs;
use std::path::Path;

use dapple::formats::{LoadOptions, gltf};
use dapple::math::{Vec2, Vec3};
use dapple::scene::Scene;
use gltf_file::{File, message};
use serde_json::{Value, json};

fn hidden() -> Value {
    json!({"KHR_node_visibility": {"visible": false}})
}

#[test]
fn what_is_below_a_hidden_node_is_not_seen() {
    let mut file = File::square();
    let light = json!({"lights": [{"type": "point"}]});
    file.document["extensions"] = json!({"KHR_lights_punctual": light});
    file.document["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_node_visibility"]);
    let shines = json!({"KHR_lights_punctual": {"light": 0}});
    file.push("nodes", json!({"mesh": 0, "children": [2], "extensions": hidden()}));
    file.push("nodes", json!({"mesh": 0, "extensions": shines.clone()}));
    file.push("nodes", json!({"extensions": shines}));
    let scene = file.load().expect("loads");
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    assert_eq!((scene.instances.len(), scene.lights.len()), (1, 1));

    file.document["nodes"][1]["extensions"]["KHR_node_visibility"]["visible"] = json!(1);
    assert!(message(file.load()).contains("must be true or false"));
}

/// The square with further coordinates, and a material that looks them up.
fn with_sets(sets: &[u64]) -> File {
    let mut file = File::square();
    for set in 1..4_u8 {
        let uvs = file.floats(&[[f32::from(set), 0.5]; 4], "VEC2");
        let attributes = &mut file.document["meshes"][0]["primitives"][0]["attributes"];
        attributes[format!("TEXCOORD_{set}")] = json!(uvs);
    }
    let white = "data:image/bmp;base64,Qk06AAAAAAAAADYAAAAoAAAAAQAAAAEAAAABABgAAAAAAAQAAAATCwAA\
                 EwsAAAAAAAAAAAAA////AA==";
    file.push("images", json!({"uri": white}));
    file.push("textures", json!({"source": 0}));
    let texture = |set: u64| json!({"index": 0, "texCoord": set});
    let mut material = json!({"pbrMetallicRoughness": {"baseColorTexture": texture(sets[0])}});
    if let Some(&set) = sets.get(1) {
        material["emissiveTexture"] = texture(set);
    }
    if let Some(&set) = sets.get(2) {
        material["normalTexture"] = texture(set);
    }
    file.document["materials"][0] = material;
    file
}

#[test]
fn a_mesh_keeps_the_sets_of_coordinates_that_its_material_looks_up() {
    let cases: [(&[u64], &[f32]); 4] = [
        (&[3, 2], &[3.0, 2.0]),
        (&[1, 3], &[1.0, 3.0]),
        (&[2], &[2.0]),
        // In the order of the material's textures: base colour, normals, emission.
        (&[1, 2, 3], &[1.0, 3.0, 2.0]),
    ];
    for (sets, kept) in cases {
        let mut scene = with_sets(sets).load().expect("loads");
        assert!(scene.notices.is_empty(), "{:?}", scene.notices);
        let mesh = scene.meshes[0].clone();
        assert_eq!(mesh.uv_sets().count(), kept.len().max(2));
        for (texture, &expected) in scene.materials[0].textures_mut().zip(kept) {
            let found = mesh.uv_set(texture.uv_set as usize)[0];
            assert_eq!(found, Vec2::new(expected, 0.5), "{sets:?}");
        }
    }
    for missing in [256, u64::from(u32::MAX)] {
        let scene = with_sets(&[1, missing, 3]).load().expect("loads");
        let said: Vec<&str> = scene.notices.iter().map(|notice| &*notice.message).collect();
        assert_eq!(said, ["has no such texture coordinates as its material's textures need"]);
    }
    assert!(message(with_sets(&[1 << 32]).load()).contains("beyond all sets"));
}

/// A cube of one texel a face, of that colour each, and alpha to divide by.
fn surrounded(colors: [[u8; 4]; 6], rotation: &Value) -> Scene {
    let folder = tempfile::tempdir().expect("a folder");
    let mut file = File::square();
    for (i, color) in colors.iter().enumerate() {
        let face = image::RgbaImage::from_raw(1, 1, color.to_vec()).expect("one texel");
        face.save(folder.path().join(format!("{i}.png"))).expect("written");
        file.push("images", json!({"uri": format!("{i}.png")}));
    }
    let light = json!({"specularImages": [[0, 1, 2, 3, 4, 5]], "specularImageSize": 1,
        "irradianceCoefficients": [], "intensity": 2, "rotation": rotation});
    file.document["extensions"] = json!({"EXT_lights_image_based": {"lights": [light]}});
    file.document["extensionsUsed"] = json!(["EXT_lights_image_based"]);
    let shines = json!({"EXT_lights_image_based": {"light": 0}});
    file.push("scenes", json!({"nodes": [0], "extensions": shines}));
    let path = folder.path().join("a.gltf");
    gltf::parse(&path, &file.text(), &LoadOptions::default()).expect("loads")
}

#[test]
fn images_of_light_stand_around_the_scene() {
    let (black, white) = ([0, 0, 0, 255], [255, 255, 255, 51]);
    let mut colors = [black; 6];
    (colors[0], colors[2]) = (white, [255, 0, 0, 255]);
    let scene = surrounded(colors, &json!([0, 0, 0, 1]));
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    let light = scene.environment.expect("there is light");
    assert!((light.radiance(Vec3::X) - Vec3::splat(10.0)).length() < 0.1);
    assert_eq!(light.radiance(-Vec3::X), Vec3::ZERO);
    assert!((light.radiance(Vec3::Y) - Vec3::new(2.0, 0.0, 0.0)).length() < 0.1);

    // A quarter turn about Y takes +X to -Z.
    let half = 0.5_f32.sqrt();
    let turned = surrounded(colors, &json!([0, half, 0, half])).environment.expect("light");
    assert!((turned.radiance(-Vec3::Z) - Vec3::splat(10.0)).length() < 0.1);
    assert_eq!(turned.radiance(Vec3::X), Vec3::ZERO);
}

#[test]
fn pointers_animate_materials_transforms_of_textures_and_visibility() {
    let mut file = with_sets(&[0]);
    file.push("nodes", json!({"mesh": 0, "extensions": {"KHR_node_visibility": {}}}));
    file.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] =
        json!({"KHR_texture_transform": {}});
    let times = file.floats(&[[0.0], [2.0]], "SCALAR");
    let colors = file.floats(&[[0.0, 0.0, 0.0, 1.0], [1.0, 0.5, 0.0, 1.0]], "VEC4");
    let offsets = file.floats(&[[0.0, 0.0], [1.0, 3.0]], "VEC2");
    let shown = file.accessor(&[1, 0], 5121, 2, "SCALAR");
    let places = file.floats(&[[0.0; 3], [4.0, 0.0, 0.0]], "VEC3");
    let texture = "/materials/0/pbrMetallicRoughness/baseColorTexture/extensions";
    let targets = [
        ("/materials/0/pbrMetallicRoughness/baseColorFactor".to_owned(), colors, "LINEAR"),
        (format!("{texture}/KHR_texture_transform/offset"), offsets, "LINEAR"),
        ("/nodes/1/extensions/KHR_node_visibility/visible".to_owned(), shown, "STEP"),
        ("/nodes/0/translation".to_owned(), places, "LINEAR"),
    ];
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    for (i, (pointer, values, how)) in targets.iter().enumerate() {
        samplers.push(json!({"input": times, "output": values, "interpolation": how}));
        let pointer = json!({"KHR_animation_pointer": {"pointer": pointer}});
        let target = json!({"path": "pointer", "extensions": pointer});
        channels.push(json!({"sampler": i, "target": target}));
    }
    file.push("animations", json!({"samplers": samplers, "channels": channels}));
    file.document["extensionsUsed"] =
        json!(["KHR_animation_pointer", "KHR_texture_transform", "KHR_node_visibility"]);
    let at = |time: f32| {
        let options = LoadOptions { time: Some(time), ..LoadOptions::default() };
        file.load_with(&options).expect("loads")
    };
    let mut scene = at(1.0);
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    assert_eq!(scene.instances.len(), 2);
    assert_eq!(scene.instances[0].transform.point(Vec3::ZERO), Vec3::new(2.0, 0.0, 0.0));
    let texture = scene.materials[0].textures_mut().next().expect("one");
    assert_eq!(texture.offset, Vec2::new(0.5, 1.5));
    assert_eq!(scene.materials[0].base_color.truncate(), Vec3::new(0.5, 0.25, 0.0));
    assert_eq!(at(2.0).instances.len(), 1);

    // Undeclared it is honoured as all extensions are, and said.
    file.document["extensionsUsed"] = json!(["KHR_texture_transform", "KHR_node_visibility"]);
    let mut scene = file.load_with(&options(1.0)).expect("loads");
    let notices = &scene.notices;
    assert!(notices[0].message.contains("KHR_animation_pointer is used without being declared"));
    assert_eq!(notices.len(), 1, "{notices:?}");
    assert_eq!(scene.materials[0].base_color.truncate(), Vec3::new(0.5, 0.25, 0.0));
    assert_eq!(scene.materials[0].textures_mut().next().expect("one").offset, Vec2::new(0.5, 1.5));
}

fn options(time: f32) -> LoadOptions {
    LoadOptions { time: Some(time), ..LoadOptions::default() }
}

/// What is no number of the object model cannot be animated, nor can objects that are not there.
#[test]
fn pointers_to_what_cannot_be_animated_are_named() {
    let mut file = File::square();
    let times = file.floats(&[[0.0], [2.0]], "SCALAR");
    let colors = file.floats(&[[0.0, 0.0, 0.0, 1.0], [1.0, 0.5, 0.0, 1.0]], "VEC4");
    let numbers = file.floats(&[[0.0], [1.0]], "SCALAR");
    let sampler = |output: usize| json!({"input": times, "output": output});
    file.document["materials"][0] = json!({"pbrMetallicRoughness": {"metallicFactor": 0}});
    let samplers = [sampler(colors), sampler(numbers)];
    file.push("animations", json!({"samplers": samplers, "channels": []}));
    file.document["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    for (sampler, pointer) in [
        (0, "/materials/0/pbrMetallicRoughness/baseColourFactor"),
        (1, "/materials/0/extensions/KHR_materials_sheen/sheenRoughnessFactor"),
        (1, "/materials/0/alphaMode"),
        (1, "/materials/0/doubleSided"),
        (1, "/nodes/0/foo"),
        (1, "/nodes/0/mesh"),
        (1, "/nodes/0/children/0"),
        (1, "/nodes/9/scale"),
        (1, "/meshes/0/primitives/0/material"),
        (1, "/extensions/KHR_lights_punctual/lights/0/intensity"),
    ] {
        let extensions = json!({"KHR_animation_pointer": {"pointer": pointer}});
        let target = json!({"path": "pointer", "extensions": extensions});
        file.document["animations"][0]["channels"] =
            json!([{"sampler": sampler, "target": target}]);
        let scene = file.load_with(&options(1.0)).expect("loads");
        let [notice] = &scene.notices[..] else { panic!("{pointer}: {:?}", scene.notices) };
        let place = "a.gltf: /animations/0/channels/0/target/extensions/KHR_animation_pointer";
        assert_eq!(notice.place, format!("{place}/pointer"));
        let said = notice.message.split_once("which ").map_or("", |it| it.1);
        let wanted = if pointer.ends_with("scale") {
            "takes 3 numbers and not 1"
        } else {
            "leads to nothing that can be animated"
        };
        assert_eq!(said, wanted, "{pointer}");
        assert!(notice.message.contains(pointer) && notice.is_refused(), "{notice:?}");
        assert_eq!((scene.instances.len(), scene.materials.len()), (1, 1));
    }
}

/// A node that has a matrix is moved by a pointer as by a channel of its own.
#[test]
fn a_pointer_moves_a_node_of_a_matrix() {
    let mut file = File::square();
    file.document["nodes"][0]["matrix"] = json!([2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]);
    let times = file.floats(&[[0.0], [2.0]], "SCALAR");
    let places = file.floats(&[[0.0; 3], [4.0, 0.0, 0.0]], "VEC3");
    let extensions = json!({"KHR_animation_pointer": {"pointer": "/nodes/0/translation"}});
    let target = json!({"path": "pointer", "extensions": extensions});
    file.push(
        "animations",
        json!({"samplers": [{"input": times, "output": places}],
            "channels": [{"sampler": 0, "target": target}]}),
    );
    file.document["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    let scene = file.load_with(&options(1.0)).expect("loads");
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    let at = |x| scene.instances[0].transform.point(Vec3::new(x, 0.0, 0.0));
    assert!(at(0.0).distance(Vec3::new(2.0, 0.0, 0.0)) < 1e-6, "{}", at(0.0));
    assert!(at(1.0).distance(Vec3::new(4.0, 0.0, 0.0)) < 1e-6, "{}", at(1.0));
}

/// A texture of KTX2, and of AVIF, which is not read, beside a plain one.
fn with_texture(extension: &str, uri: &str, plain: bool) -> Result<Scene, String> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    let folder = tempfile::tempdir().expect("a folder");
    let copy = |kind: &str, name: &str| {
        fs::copy(corpus.join(kind).join(name), folder.path().join(name)).expect("copied");
    };
    copy("ktx2", "ok-uastc.ktx2");
    copy("image", "ok-rgb.png");
    let mut file = File::square();
    file.push("images", json!({"uri": uri}));
    file.push("images", json!({"uri": "ok-rgb.png"}));
    let mut texture = json!({"extensions": {extension: {"source": 0}}});
    if plain {
        texture["source"] = json!(1);
    }
    file.push("textures", texture);
    file.document["extensionsUsed"] = json!([extension]);
    file.document["materials"][0] =
        json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let path = folder.path().join("a.gltf");
    let read = gltf::parse(&path, &file.text(), &LoadOptions::default());
    read.map_err(|error| error.to_string())
}

#[test]
fn packed_textures_come_before_plain_ones() {
    for plain in [true, false] {
        let scene = with_texture("KHR_texture_basisu", "ok-uastc.ktx2", plain).expect("loads");
        assert!(scene.notices.is_empty(), "{:?}", scene.notices);
        assert_eq!(scene.textures[0].size(), [13, 10]);
    }
    let scene = with_texture("KHR_texture_basisu", "gone.ktx2", true).expect("loads");
    assert_eq!(scene.textures[0].name(), "ok-rgb.png");
    assert!(scene.notices[0].message.contains("gone.ktx2"));
    let said = with_texture("KHR_texture_basisu", "gone.ktx2", false).expect_err("has none");
    assert!(said.contains("gone.ktx2"), "{said}");
}

/// KTX2, WebP, PNG: the first that can be used is.
#[test]
fn each_image_of_a_texture_stands_in_for_those_before() {
    let folder = tempfile::tempdir().expect("a folder");
    let texel = image::RgbImage::from_raw(1, 1, vec![9, 99, 199]).expect("one texel");
    for name in ["a.webp", "a.png"] {
        texel.save(folder.path().join(name)).expect("written");
    }
    fs::write(folder.path().join("cut.ktx2"), b"\xabKTX 20\xbb\r\n\x1a\n").expect("written");
    fs::write(folder.path().join("cut.webp"), b"RIFF\x04\0\0\0WEBP").expect("written");
    let load = |names: [&str; 3]| {
        let mut file = File::square();
        for name in names {
            file.push("images", json!({"uri": name}));
        }
        let extensions = json!({
            "KHR_texture_basisu": {"source": 0}, "EXT_texture_webp": {"source": 1},
        });
        file.push("textures", json!({"source": 2, "extensions": extensions}));
        file.document["extensionsUsed"] = json!(["KHR_texture_basisu", "EXT_texture_webp"]);
        file.document["materials"][0] =
            json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
        let path = folder.path().join("a.gltf");
        gltf::parse(&path, &file.text(), &LoadOptions::default())
    };
    for (names, used) in [
        (["gone.ktx2", "a.webp", "gone.png"], "a.webp"),
        (["cut.ktx2", "a.webp", "a.png"], "a.webp"),
        (["cut.ktx2", "cut.webp", "a.png"], "a.png"),
        (["gone.ktx2", "gone.webp", "a.png"], "a.png"),
    ] {
        let scene = load(names).expect("has one");
        assert_eq!(scene.textures[0].name(), used, "{names:?}");
        let said: Vec<&str> = scene.notices.iter().map(|notice| &*notice.message).collect();
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(said[0].starts_with(&format!("{:?}: ", names[0])), "{said:?}");
        assert!(said[0].ends_with(&format!(": {used:?} is used")), "{said:?}");
    }
    let said = message(load(["gone.ktx2", "gone.webp", "gone.png"]));
    assert!(said.contains("gone.ktx2"), "{said}");
}

#[test]
fn a_plain_texture_stands_in_for_avif() {
    let scene = with_texture("EXT_texture_avif", "a.avif", true).expect("loads");
    assert_eq!(scene.textures[0].name(), "ok-rgb.png");
    assert!(scene.notices[0].message.contains("the texture's other image is used"));
    let said = with_texture("EXT_texture_avif", "a.avif", false).expect_err("has none");
    assert!(said.contains("is of AVIF alone"), "{said}");
}

/// Attributes by the second version of the codec, and colours of 8 and 16 bits, beside what the
/// reference decoder makes of them.
#[test]
fn views_packed_by_meshopt_are_those_of_the_reference_decoder() {
    let load = |name: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/gltf");
        dapple::load(folder.join(name), &LoadOptions::default()).expect(name)
    };
    let (packed, plain) = (load("ok-meshopt-khr.gltf"), load("ok-meshopt-khr-plain.gltf"));
    assert!(packed.notices.is_empty(), "{:?}", packed.notices);
    assert_eq!(plain.meshes.len(), 2);
    for (packed, plain) in packed.meshes.iter().zip(&plain.meshes) {
        assert_eq!(packed.positions, plain.positions);
        assert_eq!(packed.normals, plain.normals);
        assert_eq!(packed.colors, plain.colors);
        assert_eq!(packed.indices, plain.indices);
    }
}
