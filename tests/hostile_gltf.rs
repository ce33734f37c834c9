//! glTF files that are broken, odd or meant to break something, and files that refer to others.
//!
//! The corpus of the fuzz target is replayed here, as it is, cut short and with bytes and values
//! changed. A file whose name starts with `ok-` is to be read, `bad-` to be refused.

use std::fs;
use std::path::Path;

use dapple::formats::{LoadError, LoadOptions, MissingTexture, gltf, load};
use dapple::scene::Scene;
use proptest::prelude::*;
use serde_json::{Value, json};

/// The corpus, names and contents.
fn corpus() -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/gltf");
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("the corpus is part of the project") {
        let path = entry.expect("the folder can be read").path();
        let name = path.file_name().expect("it is a file").to_string_lossy().into_owned();
        files.push((name, fs::read(&path).expect("the corpus can be read")));
    }
    files.sort();
    assert!(files.len() >= 50, "{} files", files.len());
    files
}

fn parse(bytes: &[u8]) -> Result<Scene, LoadError> {
    gltf::parse(Path::new("no-such-folder/a.gltf"), bytes, &LoadOptions::default())
}

/// Parses, posed at a time, and checks what everything else relies on.
fn check(bytes: &[u8]) -> Result<Scene, LoadError> {
    let options = LoadOptions { time: Some(0.37), ..LoadOptions::default() };
    let scene = gltf::parse(Path::new("no-such-folder/a.gltf"), bytes, &options)?;
    for mesh in &scene.meshes {
        let count = mesh.positions.len();
        assert!(mesh.positions.iter().all(|p| p.is_finite()));
        assert!(mesh.indices.iter().flatten().all(|&index| (index as usize) < count));
        assert!(mesh.normals.is_empty() || mesh.normals.len() == count);
        assert!(mesh.tangents.is_empty() || mesh.tangents.len() == count);
        assert!(mesh.colors.is_empty() || mesh.colors.len() == count);
        assert!(mesh.uv_sets().all(|set| set.is_empty() || set.len() == count));
    }
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh.index()];
        let mut corners = mesh.indices.iter().flatten();
        let place = |&i: &u32| instance.transform.point(mesh.positions[i as usize]);
        assert!(corners.all(|i| place(i).is_finite()));
        let mut material = scene.materials[instance.material.index()].clone();
        let sets = mesh.uv_sets().count();
        assert!(material.textures_mut().all(|reference| (reference.uv_set as usize) < sets));
    }
    for material in &mut scene.materials.clone() {
        for reference in material.textures_mut() {
            assert!(reference.texture.index() < scene.textures.len());
        }
    }
    Ok(scene)
}

#[test]
fn the_corpus_is_read_or_refused_as_its_names_say() {
    for (name, bytes) in corpus() {
        match check(&bytes) {
            Ok(_) => {
                assert!(name.starts_with("ok-"), "{name} is read");
                assert!(parse(&bytes).is_ok(), "{name} is read at rest");
            }
            Err(error) => {
                assert!(name.starts_with("bad-"), "{error}");
                assert!(error.to_string().starts_with("no-such-folder/a.gltf: "), "{error}");
            }
        }
    }
}

#[test]
fn lights_and_cameras_stand_where_their_nodes_are() {
    let files = corpus();
    let (_, bytes) =
        files.iter().find(|(name, _)| name == "ok-lights-and-cameras.gltf").expect("is there");
    let scene = check(bytes).expect("loads");
    let heights: Vec<f32> = scene.lights.iter().map(|light| light.position.z).collect();
    assert_eq!(heights, [0.0, 1.0, 2.0]);
    assert_eq!(scene.lights[0].intensity.to_array(), [10.0; 3]);
    assert_eq!(scene.lights[2].range, Some(3.0));
    let names: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
    assert_eq!(names, ["", "side"]);
    let towards = scene.cameras[0].camera.to_world.matrix3.z_axis;
    assert!(towards.distance(dapple::math::Affine3A::IDENTITY.matrix3.x_axis) < 1e-6);
}

/// Numbers of all kinds of properties go where pointers lead, and nowhere else.
#[test]
fn pointers_of_the_corpus_are_followed_or_named() {
    let files = corpus();
    let load = |wanted: &str| {
        let (_, bytes) = files.iter().find(|(name, _)| name == wanted).expect("is there");
        check(bytes).expect("loads")
    };
    let scene = load("ok-pointers.gltf");
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    assert!(scene.materials.iter().any(|it| it.emissive != dapple::math::Vec3::ZERO));
    let scene = load("ok-pointers-hostile.gltf");
    assert_eq!(scene.notices.len(), 7, "{:?}", scene.notices);
    let said = |message: &str| message.starts_with("animates ");
    assert!(scene.notices.iter().all(|notice| said(&notice.message)), "{:?}", scene.notices);
}

#[test]
fn containers_cut_anywhere_are_refused() {
    for (name, bytes) in corpus().iter().filter(|(_, bytes)| bytes.starts_with(b"glTF")) {
        for end in 0..bytes.len() {
            assert!(check(&bytes[..end]).is_err(), "{name} cut at {end}");
        }
    }
}

/// Calls `visit` with the pointer to every value within `value`.
fn each_pointer(value: &Value, place: &str, visit: &mut dyn FnMut(&str)) {
    visit(place);
    match value {
        Value::Array(elements) => {
            for (i, element) in elements.iter().enumerate() {
                each_pointer(element, &format!("{place}/{i}"), visit);
            }
        }
        Value::Object(members) => {
            for (key, member) in members {
                each_pointer(member, &format!("{place}/{key}"), visit);
            }
        }
        _ => {}
    }
}

#[test]
fn any_value_replaced_by_any_other_is_read_or_refused() {
    let others = [
        json!(null),
        json!(true),
        json!(0),
        json!(-1),
        json!(0.5),
        json!(3),
        json!(4294967295_u64),
        json!(u64::MAX),
        json!(1e38),
        json!(1e300),
        json!(""),
        json!("VEC3"),
        json!([]),
        json!([1, 2, 3]),
        json!({}),
    ];
    let mut tried = 0;
    for (_, bytes) in corpus().iter().filter(|(name, _)| name.starts_with("ok-")) {
        // The containers' documents lose their binary chunk, which is one more change.
        let document = if bytes.starts_with(b"glTF") {
            let length = u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]]) as usize;
            &bytes[20..20 + length]
        } else {
            bytes
        };
        let document: Value = serde_json::from_slice(document).expect("it is JSON");
        let mut pointers = Vec::new();
        each_pointer(&document, "", &mut |place| pointers.push(place.to_owned()));
        for pointer in &pointers {
            for other in &others {
                let mut changed = document.clone();
                *changed.pointer_mut(pointer).expect("it is there") = other.clone();
                let _ = check(&serde_json::to_vec(&changed).expect("serialises"));
                tried += 1;
            }
        }
    }
    assert!(tried > 5000, "{tried} documents");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None,
        ..ProptestConfig::default() })]

    #[test]
    fn changed_bytes_are_read_or_refused(
        file in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let files = corpus();
        let (_, bytes) = &files[file.index(files.len())];
        let mut bytes = bytes.clone();
        for (at, byte) in changes {
            if !bytes.is_empty() {
                let at = at.index(bytes.len());
                bytes[at] = byte;
            }
        }
        let _ = check(&bytes);
    }
}

/// A triangle whose document has `members` too, with the textures that it names.
fn triangle(members: &Value) -> Vec<u8> {
    let sparse = "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let mut document = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 36, "uri": sparse}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
            {"bufferView": 0, "componentType": 5126, "type": "VEC2", "count": 3},
        ],
        "meshes": [{"primitives": [
            {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0},
        ]}],
        "materials": [{}],
        "nodes": [{"mesh": 0}],
    });
    for (key, member) in members.as_object().expect("an object") {
        document[key] = member.clone();
    }
    serde_json::to_vec(&document).expect("serialises")
}

fn two_missing_textures() -> Vec<u8> {
    triangle(&json!({
        "images": [{"uri": "one%20word.png"}, {"uri": "two.png"}, {"uri": "unused.png"}],
        "textures": [{"source": 0}, {"source": 1}, {"source": 2}],
        "materials": [
            {"emissiveTexture": {"index": 0}, "normalTexture": {"index": 1}},
            {"emissiveTexture": {"index": 2}},
        ],
    }))
}

#[test]
fn all_missing_textures_are_listed_at_once() {
    let error = parse(&two_missing_textures()).expect_err("they are missing");
    assert_eq!(
        error.to_string(),
        "no-such-folder/a.gltf: 2 references cannot be used:\n  \
         /images/0: \"one%20word.png\": no such file\n  \
         /images/1: \"two.png\": no such file\n\
         --missing-texture magenta goes on without"
    );
}

#[test]
fn missing_textures_are_magenta_where_that_is_asked_for() {
    let options =
        LoadOptions { missing_texture: MissingTexture::Magenta, ..LoadOptions::default() };
    let scene = gltf::parse(Path::new("a.gltf"), &two_missing_textures(), &options);
    let scene = scene.expect("loads");
    assert_eq!((scene.textures.len(), scene.notices.len()), (2, 2));
    let color = scene.textures[0].sample(dapple::math::Vec2::ZERO);
    assert_eq!(color.to_array(), [1.0, 0.0, 1.0, 1.0]);
    assert_eq!(scene.notices[1].place, "a.gltf: /images/1");
    // A normal of magenta would be none.
    let material = &scene.materials[scene.instances[0].material.index()];
    assert!(material.emissive_texture.is_some() && material.normal_texture.is_none());
}

#[test]
fn files_beside_the_scene_are_found_and_those_elsewhere_are_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).expect("a folder");
    let bytes: Vec<u8> = [0.0_f32; 9].iter().flat_map(|x| x.to_le_bytes()).collect();
    fs::write(inner.join("two words.bin"), &bytes).expect("writes");
    fs::write(folder.path().join("outside.bin"), &bytes).expect("writes");

    let with = |uri: &str| {
        let path = inner.join("a.gltf");
        let members = json!({"buffers": [{"byteLength": 36, "uri": uri}]});
        fs::write(&path, triangle(&members)).expect("writes");
        load(&path, &LoadOptions::default()).map(|scene| scene.meshes.len())
    };
    assert_eq!(with("two%20words.bin").expect("loads"), 1);
    assert_eq!(with("two words.bin").expect("loads"), 1);
    let error = with("../outside.bin").expect_err("is outside");
    assert!(error.to_string().contains("leads out of the scene's folder"), "{error}");
    let absolute = folder.path().join("outside.bin");
    assert!(with(&absolute.to_string_lossy()).is_err());
}

#[test]
fn strict_makes_notices_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.gltf");
    let [plain, strict] =
        [false, true].map(|strict| LoadOptions { strict, ..LoadOptions::default() });
    let unknown = json!({"extensionsUsed": ["VENDOR_unheard_of"]});
    fs::write(&path, triangle(&unknown)).expect("writes");
    assert_eq!(load(&path, &plain).expect("loads").notices.len(), 1);
    assert!(matches!(load(&path, &strict), Err(LoadError::Strict { .. })));
    // A rest pose is what the format has where nobody asks for a time.
    fs::write(&path, triangle(&json!({"animations": [{}]}))).expect("writes");
    assert_eq!(load(&path, &strict).expect("loads").notices.len(), 1);
}

#[test]
fn primitives_of_the_same_accessors_are_one_mesh() {
    let primitive = json!({"attributes": {"POSITION": 0}});
    let scene = parse(&triangle(&json!({
        "meshes": [{"primitives": [primitive]}, {"primitives": [primitive, primitive]}],
        "nodes": [{"mesh": 0}, {"mesh": 1}, {"mesh": 0, "scale": [-1, 1, 1]}],
    })));
    let scene = scene.expect("loads");
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 4));
    let mirrored = |i: usize| scene.instances[i].transform.mirrored();
    assert!(mirrored(3) && !mirrored(0));
}

#[test]
fn a_small_file_cannot_ask_for_millions_of_instances_or_vertices() {
    let mesh: Vec<Value> = vec![json!({"attributes": {"POSITION": 0}}); 3000];
    let nodes: Vec<Value> = vec![json!({"mesh": 0}); 3000];
    let error = parse(&triangle(&json!({"meshes": [{"primitives": mesh}], "nodes": nodes})));
    assert!(error.expect_err("are 9 million").to_string().contains("placed meshes"));

    let zeros = json!({"componentType": 5126, "type": "VEC3", "count": 4_000_000});
    let accessors: Vec<Value> = vec![zeros; 200];
    let primitives: Vec<Value> =
        (0..200).map(|i| json!({"attributes": {"POSITION": i, "NORMAL": 0}})).collect();
    let members = json!({"accessors": accessors, "meshes": [{"primitives": primitives}]});
    let error = parse(&triangle(&members)).expect_err("are 18 GB");
    assert!(error.to_string().contains("far more memory"), "{error}");
}
