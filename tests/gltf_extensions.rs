//! What extensions of glTF, and colours and tangents of vertices, make of a scene.

mod gltf_file;

use dapple::camera::Projection;
use dapple::formats::{LoadError, LoadOptions, gltf};
use dapple::material::BsdfForm;
use dapple::math::{Vec3, Vec4};
use dapple::scene::Scene;
use dapple::world::{Attributes, World};
use gltf_file::{File, message};
use serde_json::{Value, json};

/// The square with copies; attributes are an accessor each.
fn with_copies(attributes: impl Fn(&mut File) -> Value) -> Result<Scene, LoadError> {
    let mut file = File::square();
    let attributes = attributes(&mut file);
    file.document["nodes"][0] = json!({
        "mesh": 0, "translation": [0, 0, 5], "scale": [2, 2, 2],
        "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}},
    });
    file.document["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    file.document["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    file.load()
}

#[test]
fn copies_stand_relative_to_their_node() {
    let scene = with_copies(|file| {
        let places = file.floats(&[[1.0, 0.0, 0.0], [0.0, 3.0, 0.0]], "VEC3");
        // A quarter turn about Z, and a half one, as normalised bytes.
        let turns = file.accessor(&[0, 0, 90, 90, 0, 0, 127, 0], 5120, 2, "VEC4");
        file.document["accessors"][turns]["normalized"] = json!(true);
        let sizes = file.floats(&[[1.0; 3], [-2.0, 1.0, 1.0]], "VEC3");
        json!({"TRANSLATION": places, "ROTATION": turns, "SCALE": sizes, "_ID": places})
    })
    .expect("loads");
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    let corner = |i: usize| scene.instances[i].transform.point(Vec3::X);
    assert!(corner(0).distance(Vec3::new(2.0, 2.0, 5.0)) < 1e-5, "{}", corner(0));
    assert!(corner(1).distance(Vec3::new(4.0, 6.0, 5.0)) < 1e-5, "{}", corner(1));
    assert!(scene.instances[1].transform.mirrored() && !scene.instances[0].transform.mirrored());
}

#[test]
fn copies_that_have_no_place_are_refused() {
    let different = with_copies(|file| {
        let (two, one) = (file.floats(&[[0.0; 3]; 2], "VEC3"), file.floats(&[[1.0; 3]], "VEC3"));
        json!({"TRANSLATION": two, "SCALE": one})
    });
    assert_eq!(
        message(different),
        "a.gltf: /nodes/0/extensions/EXT_mesh_gpu_instancing/attributes: its attributes have \
         different numbers of elements"
    );
    let still = with_copies(|file| json!({"ROTATION": file.floats(&[[0.0; 4]], "VEC4")}));
    assert!(message(still).contains("copy 0 has no place"));
    let lost = with_copies(|file| json!({"SCALE": file.floats(&[[f32::NAN; 3]], "VEC3")}));
    assert!(message(lost).contains("copy 0 has no place"));
    let wrong = with_copies(|file| json!({"SCALE": file.floats(&[[1.0; 2]], "VEC2")}));
    assert!(message(wrong).contains("must be of type VEC3"));
    let absent = with_copies(|_| json!({"TRANSLATION": 99}));
    assert!(message(absent).contains("refers to accessor 99 of 4"));
    let many = with_copies(|file| {
        let zeros = json!({"componentType": 5126, "type": "VEC3", "count": 4_194_304});
        let zeros = file.push("accessors", zeros);
        json!({"TRANSLATION": zeros, "SCALE": zeros})
    });
    assert!(many.is_ok() || message(many).contains("too many"));
}

/// Groups within groups, four deep, each placing the square by copies: one mesh, many places.
#[test]
fn groups_within_groups_share_their_meshes() {
    let mut file = File::square();
    let places = file.floats(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "VEC3");
    let copies = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}});
    let mut nodes = Vec::new();
    for depth in 0..4 {
        // Node 2 d has copies of the mesh, node 2 d + 1 the mesh, and the next group below it.
        let inner = json!([2 * depth + 2, 2 * depth + 3]);
        nodes.push(json!({"mesh": 0, "extensions": copies, "scale": [2, 2, 2]}));
        nodes.push(json!({"mesh": 0, "translation": [10, 0, 0], "children": inner}));
    }
    nodes[7].as_object_mut().expect("a node").remove("children");
    file.document["nodes"] = json!(nodes);
    file.document["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let scene = file.load().expect("loads");
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 4 * (3 + 1)));
    // Of the innermost copies, the first.
    let corner = scene.instances[12].transform.point(Vec3::ZERO);
    assert_eq!(corner, Vec3::new(32.0, 0.0, 0.0));
}

#[test]
fn without_attributes_there_are_no_copies() {
    let scene = with_copies(|_| json!({})).expect("loads");
    assert_eq!(scene.instances.len(), 0);
}

#[test]
fn a_variant_is_shown_by_its_name() {
    let mut file = File::square();
    let red = json!({"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}});
    let red = file.push("materials", red);
    let variants = json!([{"name": "white"}, {"name": "red"}]);
    file.document["extensions"] = json!({"KHR_materials_variants": {"variants": variants}});
    file.document["extensionsUsed"] = json!(["KHR_materials_variants"]);
    file.document["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_materials_variants": {"mappings": [{"material": red, "variants": [1]}]}});
    let shown = |variant: Option<&str>| {
        let variant = variant.map(str::to_owned);
        let scene = file.load_with(&LoadOptions { variant, ..LoadOptions::default() })?;
        assert_eq!(scene.contents.variants, ["white", "red"]);
        assert!(scene.contents.extensions.iter().all(|extension| extension.honoured));
        Ok(scene.materials[scene.instances[0].material.index()].base_color)
    };
    let red = Vec4::new(1.0, 0.0, 0.0, 1.0);
    for (variant, color) in
        [(None, Vec4::ONE), (Some("white"), Vec4::ONE), (Some("red"), red), (Some("1"), red)]
    {
        assert_eq!(shown(variant).map_err(|error: LoadError| error.to_string()), Ok(color));
    }
    let error = shown(Some("Rad")).expect_err("is not there").to_string();
    assert_eq!(error, "a.gltf: no variant \"Rad\"; did you mean 1 (\"red\")?");
}

#[test]
fn a_scene_that_is_not_there_is_answered_with_those_that_are() {
    let mut file = File::square();
    file.document["scenes"] = json!([{"name": "day", "nodes": [0]}, {"nodes": []}]);
    let scene = Some("Night".to_owned());
    let error = file.load_with(&LoadOptions { scene, ..LoadOptions::default() });
    assert_eq!(message(error), "a.gltf: no scene \"Night\"; it has 0 (\"day\"), 1");
}

#[test]
fn an_unlit_surface_shows_its_colour_and_reflects_nothing() {
    let mut file = File::square();
    file.document["materials"][0] = json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 1, 1]},
        "extensions": {"KHR_materials_unlit": {}},
    });
    let world = World::new(file.load().expect("loads"), BsdfForm::Conserving);
    let world = world.expect("is small");
    let at = Attributes { color: Vec4::new(1.0, 0.5, 1.0, 1.0), ..Attributes::NONE };
    let material = world.scene.instances[0].material;
    assert_eq!(world.emission(material, &at), Vec3::new(0.5, 0.125, 1.0));
    assert_eq!(world.bare_bsdf(material, &at).albedo(), Vec3::ZERO);
    assert!(world.lights.is_dark());
}

#[test]
fn colours_of_vertices_multiply_the_base_colour_and_alpha() {
    let mut file = File::square();
    let bytes: Vec<u8> = [[255, 0, 51, 255]; 3].into_iter().flatten().chain([0; 4]).collect();
    let colors = file.accessor(&bytes, 5121, 4, "VEC4");
    file.document["accessors"][colors]["normalized"] = json!(true);
    file.document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
    file.document["materials"][0] = json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0},
        "alphaMode": "BLEND", "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
    });
    let scene = file.load().expect("loads");
    let expected = [Vec4::new(1.0, 0.0, 0.2, 1.0); 3].into_iter().chain([Vec4::ZERO]);
    assert_eq!(scene.meshes[0].colors, expected.collect::<Vec<_>>());
    let world = World::new(scene, BsdfForm::Conserving).expect("is small");
    assert!(world.is_see_through(), "a vertex is clear");
    let at = Attributes { color: Vec4::new(1.0, 0.0, 0.2, 1.0), ..Attributes::NONE };
    let albedo = world.bare_bsdf(world.scene.instances[0].material, &at).albedo();
    assert!(albedo.distance(Vec3::new(0.5, 0.0, 0.1)) < 1e-6, "{albedo}");
}

#[test]
fn colours_beyond_the_range_are_told() {
    let mut file = File::square();
    let colors = file.floats(&[[2.0, -1.0, f32::NAN]; 4], "VEC3");
    file.document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(colors);
    let scene = file.load().expect("loads");
    assert_eq!(scene.meshes[0].colors, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
    assert_eq!(scene.notices.len(), 1);
    assert!(scene.notices[0].place.ends_with("/meshes/0/primitives/0/attributes/COLOR_0"));
}

#[test]
fn a_normal_map_gets_tangents_along_its_own_u() {
    let mut file = File::square();
    let image = "data:image/bmp;base64,Qk06AAAAAAAAADYAAAAoAAAAAQAAAAEAAAABABgAAAAAAAQAAAATCwAAEwsA\
        AAAAAAAAAAAA////AA==";
    file.push("images", json!({"uri": image}));
    file.push("textures", json!({"source": 0}));
    file.document["materials"][0] = json!({"normalTexture": {"index": 0}});
    let quarter = json!({"KHR_texture_transform": {"rotation": std::f32::consts::FRAC_PI_2}});
    let turned = json!({"normalTexture": {"index": 0, "extensions": quarter}});
    let turned = file.push("materials", turned);
    let mut again = file.document["meshes"][0].clone();
    again["primitives"][0]["material"] = json!(turned);
    let mesh = file.push("meshes", again);
    file.push("nodes", json!({"mesh": mesh}));
    let scene = file.load().expect("loads");
    assert_eq!(scene.meshes.len(), 2, "the maps lie differently");
    let tangent = |mesh: usize| scene.meshes[mesh].tangents[0];
    assert!(tangent(0).distance(Vec4::new(1.0, 0.0, 0.0, 1.0)) < 1e-6, "{}", tangent(0));
    // u' = v there, which points down.
    assert!(tangent(1).distance(Vec4::new(0.0, -1.0, 0.0, 1.0)) < 1e-6, "{}", tangent(1));
}

#[test]
fn quantised_positions_are_whole_numbers_that_the_node_scales() {
    let mut file = File::square();
    let numbers: Vec<u8> = [[0_i16, 0, 0, 0], [100, 0, 0, 0], [100, 100, -7, 0], [0, 100, 0, 0]]
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let positions = file.accessor(&numbers, 5122, 4, "VEC3");
    let view = file.document["accessors"][positions]["bufferView"].as_u64().expect("a number");
    file.document["bufferViews"][view as usize]["byteStride"] = json!(8);
    file.document["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(positions);
    file.document["nodes"][0]["scale"] = json!([0.01, 0.01, 0.01]);
    file.document["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    file.document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let scene = file.load().expect("loads");
    assert_eq!(scene.meshes[0].positions[2], Vec3::new(100.0, 100.0, -7.0));
    let placed = scene.instances[0].transform.point(scene.meshes[0].positions[2]);
    assert!(placed.distance(Vec3::new(1.0, 1.0, -0.07)) < 1e-6);
}

#[test]
fn cameras_keep_their_names() {
    let mut file = File::square();
    let lens = json!({"yfov": 0.5, "znear": 0.1});
    let camera = json!({"type": "perspective", "perspective": lens, "name": "door"});
    let camera = file.push("cameras", camera);
    file.push("nodes", json!({"camera": camera}));
    let scene = file.load().expect("loads");
    assert_eq!(scene.cameras[0].name, "door");
    assert_eq!(scene.cameras[0].camera.projection, Projection::Perspective { yfov: 0.5 });
}

/// A picture for other programs stands in for a WebP that is gone, and that is said.
#[test]
fn a_webp_that_is_missing_gives_way_to_its_png() {
    let folder = tempfile::tempdir().expect("a folder");
    let png = image::RgbImage::from_raw(1, 1, vec![255, 0, 255]).expect("one texel");
    png.save(folder.path().join("a.png")).expect("written");
    let load = |plain: &str| {
        let mut file = File::square();
        file.push("images", json!({"uri": "gone.webp"}));
        file.push("images", json!({"uri": plain}));
        let webp = json!({"EXT_texture_webp": {"source": 0}});
        file.push("textures", json!({"source": 1, "extensions": webp}));
        file.document["extensionsUsed"] = json!(["EXT_texture_webp"]);
        file.document["materials"][0] =
            json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
        gltf::parse(&folder.path().join("a.gltf"), &file.text(), &LoadOptions::default())
    };
    let scene = load("a.png").expect("the png is there");
    assert_eq!(scene.textures[0].name(), "a.png");
    assert_eq!(scene.textures[0].texel(0, 0).to_array(), [1.0, 0.0, 1.0, 1.0]);
    let said: Vec<_> = scene.notices.iter().map(|notice| &*notice.message).collect();
    assert_eq!(said, ["\"gone.webp\": no such file: \"a.png\" is used"]);
    let error = message(load("gone.png"));
    assert!(error.contains("gone.webp"), "{error}");
}
