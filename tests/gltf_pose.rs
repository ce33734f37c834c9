//! Skins and morph targets of glTF: what they bend, stands bent as the file has it at rest.

mod gltf_file;

use dapple::math::Vec3;
use dapple::scene::Scene;
use gltf_file::{File, message};
use serde_json::{Value, json};

/// The square, its left side held by node 1 and its right side by node 2, as `nodes` places them;
/// node 0, which carries it, is somewhere else.
fn skinned(nodes: [Value; 2], joints: [[u8; 4]; 4]) -> File {
    let mut file = File::square();
    let joints = file.accessor(&joints.concat(), 5121, 4, "VEC4");
    let weights = file.floats(&[[1.0, 0.0, 0.0, 0.0]; 4], "VEC4");
    let attributes = &mut file.document["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    file.document["nodes"][0] = json!({"mesh": 0, "skin": 0, "translation": [50, 0, 0]});
    for node in nodes {
        file.push("nodes", node);
    }
    file.push("skins", json!({"joints": [1, 2]}));
    file
}

const SIDES: [[u8; 4]; 4] = [[0; 4], [1, 0, 0, 0], [1, 0, 0, 0], [0; 4]];

/// Corners of the only instance in the world.
fn corners(scene: &Scene) -> Vec<Vec3> {
    let instance = &scene.instances[0];
    let mesh = &scene.meshes[instance.mesh.index()];
    mesh.positions.iter().map(|&p| instance.transform.point(p)).collect()
}

#[test]
fn a_skin_holds_each_vertex_by_its_joint_and_not_by_its_node() {
    let file = skinned([json!({}), json!({"translation": [2, 0, 1]})], SIDES);
    let scene = file.load().expect("loads");
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    let expected = [[0.0, 0.0, 0.0], [3.0, 0.0, 1.0], [3.0, 1.0, 1.0], [0.0, 1.0, 0.0]];
    assert_eq!(corners(&scene), expected.map(Vec3::from_array));
}

#[test]
fn inverse_bind_matrices_come_first() {
    let mut file = skinned([json!({}), json!({"rotation": [0, 0, 1, 0]})], SIDES);
    // The second joint's origin is the lower right corner.
    let mut matrices = [[0.0_f32; 16]; 2];
    for matrix in &mut matrices {
        for i in [0, 5, 10, 15] {
            matrix[i] = 1.0;
        }
    }
    matrices[1][12] = -1.0;
    let matrices = file.floats(&matrices, "MAT4");
    file.document["skins"][0]["inverseBindMatrices"] = json!(matrices);
    let scene = file.load().expect("loads");
    let expected = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(corners(&scene), expected.map(Vec3::from_array));
}

#[test]
fn a_mirrored_skin_keeps_its_front() {
    let mirror = json!({"scale": [-1, 1, 1]});
    let scene = skinned([mirror.clone(), mirror], SIDES).load().expect("loads");
    let mesh = &scene.meshes[0];
    let corner = |k: usize| mesh.positions[mesh.indices[0][k] as usize];
    let normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalize();
    assert_eq!((normal, mesh.normals[0]), (Vec3::Z, Vec3::Z));
}

#[test]
fn broken_skins_are_refused() {
    let plain = || [json!({}), json!({})];
    let beyond = skinned(plain(), [[0; 4], [2, 0, 0, 0], [0; 4], [0; 4]]);
    let said = "a.gltf: /meshes/0/primitives/0: a vertex follows joint 2 of 2";
    assert_eq!(message(beyond.load()), said);
    let mut nothing = skinned(plain(), SIDES);
    nothing.document["skins"][0]["joints"] = json!([]);
    assert!(message(nothing.load()).contains("must name at least one node"));
    let mut few = skinned(plain(), SIDES);
    let matrix = few.floats(&[[1.0; 16]], "MAT4");
    few.document["skins"][0]["inverseBindMatrices"] = json!(matrix);
    assert!(message(few.load()).contains("has 1 inverse bind matrices for 2 joints"));
    let far = [json!({"translation": [3e38, 0, 0]}), json!({})];
    assert!(message(skinned(far, [[0; 4]; 4]).load()).contains("beyond 32-bit floats"));
}

#[test]
fn a_skin_whose_joints_are_elsewhere_is_told() {
    let mut file = skinned([json!({}), json!({})], SIDES);
    file.document["scenes"] = json!([{"nodes": [0]}]);
    let scene = file.load().expect("loads");
    assert_eq!(corners(&scene)[0], Vec3::new(50.0, 0.0, 0.0));
    assert_eq!(scene.notices.len(), 1);
    assert!(scene.notices[0].message.contains("joints are not in the scene"));
}

#[test]
fn weights_of_a_node_go_before_those_of_its_mesh() {
    let mut file = File::square();
    let lift = file.floats(&[[0.0, 0.0, 2.0]; 4], "VEC3");
    file.document["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": lift}]);
    file.document["meshes"][0]["weights"] = json!([0.5]);
    file.push("nodes", json!({"mesh": 0, "weights": [2]}));
    file.push("nodes", json!({"mesh": 0, "weights": [0]}));
    let scene = file.load().expect("loads");
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    let height = |i: usize| scene.meshes[scene.instances[i].mesh.index()].positions[0].z;
    assert_eq!([0, 1, 2].map(height), [1.0, 4.0, 0.0]);
    file.document["nodes"][1]["weights"] = json!([null]);
    assert!(message(file.load()).contains("/nodes/1/weights/0"));
}

/// The square, whose node an animation moves from x = 0 to x = 4 and turns by half a circle about
/// Z within two seconds.
fn animated() -> File {
    let mut file = File::square();
    let times = file.floats(&[[1.0], [3.0]], "SCALAR");
    let places = file.floats(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]], "VEC3");
    let turns = file.floats(&[[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0]], "VEC4");
    let sampler = |output: usize| json!({"input": times, "output": output});
    let channel = |sampler: usize, path: &str| {
        let target = json!({"node": 0, "path": path});
        json!({"sampler": sampler, "target": target})
    };
    file.document["nodes"][0]["scale"] = json!([2, 2, 2]);
    file.push(
        "animations",
        json!({
            "samplers": [sampler(places), sampler(turns)],
            "channels": [channel(0, "translation"), channel(1, "rotation")],
        }),
    );
    file
}

fn at(file: &File, time: f32) -> Result<Scene, dapple::formats::LoadError> {
    let options = dapple::formats::LoadOptions { time: Some(time), ..Default::default() };
    file.load_with(&options)
}

#[test]
fn an_animation_is_posed_at_a_time_and_keeps_what_it_does_not_move() {
    let file = animated();
    let rest = file.load().expect("loads");
    assert_eq!(corners(&rest)[1], Vec3::new(2.0, 0.0, 0.0));
    assert!(rest.notices[0].message.contains("--time"), "{:?}", rest.notices);
    for (time, corner) in
        [(0.0, [2.0, 0.0]), (2.0, [2.0, 2.0]), (3.0, [2.0, 0.0]), (9.0, [2.0, 0.0])]
    {
        let scene = at(&file, time).expect("loads");
        assert!(scene.notices.is_empty(), "{:?}", scene.notices);
        let expected = Vec3::new(corner[0], corner[1], 0.0);
        assert!(corners(&scene)[1].distance(expected) < 1e-5, "{time}: {:?}", corners(&scene));
    }
    assert!(corners(&at(&file, 3.0).expect("loads"))[0].distance(Vec3::X * 4.0) < 1e-5);
    let still = at(&File::square(), 1.0).expect("loads");
    assert!(still.notices[0].message.contains("there is no animation"));
}

/// Pointers to properties of nodes are as channels of them; all else that they move stands still,
/// which is said.
#[test]
fn what_pointers_move_bends_while_the_shutter_is_open() {
    let mut file = skinned([json!({}), json!({})], SIDES);
    let lift = file.floats(&[[0.0, 0.0, 2.0]; 4], "VEC3");
    file.document["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": lift}]);
    let times = file.floats(&[[0.0], [2.0]], "SCALAR");
    let rises = file.floats(&[[0.0], [1.0]], "SCALAR");
    let places = file.floats(&[[0.0; 3], [4.0, 0.0, 0.0]], "VEC3");
    let sampler = |output: usize| json!({"input": times, "output": output});
    let channel = |sampler: usize, pointer: &str| {
        let extension = json!({"KHR_animation_pointer": {"pointer": pointer}});
        json!({"sampler": sampler, "target": {"path": "pointer", "extensions": extension}})
    };
    let channels = [channel(0, "/nodes/0/weights"), channel(1, "/nodes/2/translation")];
    let samplers = [sampler(rises), sampler(places)];
    file.push("animations", json!({"samplers": samplers, "channels": channels}));
    file.document["extensionsUsed"] = json!(["KHR_animation_pointer"]);
    let load = |file: &File| {
        let (time, shutter) = (Some(1.0), Some(1.0));
        let options = dapple::formats::LoadOptions { time, shutter, ..Default::default() };
        file.load_with(&options).expect("loads")
    };
    let scene = load(&file);
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    let mesh = scene.instances[0].mesh;
    let seen = |time: f32| [0, 1].map(|corner| scene.mesh_at(mesh, time).position(corner));
    assert_eq!(seen(0.0), [Vec3::new(0.0, 0.0, 1.0), Vec3::new(3.0, 0.0, 1.0)]);
    assert_eq!(seen(0.5), [Vec3::new(0.0, 0.0, 1.5), Vec3::new(4.0, 0.0, 1.5)]);

    let cutoff = channel(0, "/materials/0/alphaCutoff");
    file.document["animations"][0]["channels"].as_array_mut().expect("a list").push(cutoff);
    let scene = load(&file);
    let said: Vec<&str> = scene.notices.iter().map(|it| it.message.as_str()).collect();
    assert_eq!(said, ["\"/materials/0/alphaCutoff\" stands still while the shutter is open"]);
}

#[test]
fn broken_animations_are_refused() {
    for (pointer, value, said) in [
        ("/animations/0/channels/0/sampler", json!(2), "sampler"),
        ("/animations/0/channels/0/target/node", json!(7), "node"),
        ("/animations/0/samplers/0/interpolation", json!("CUBIC"), "none of STEP"),
        ("/animations/0/samplers/0/interpolation", json!("CUBICSPLINE"), "2 times do not go"),
        ("/animations/0/samplers/0/output", json!(99), "accessor"),
        ("/animations/0/samplers/0/output", json!(0), "2 times do not go"),
    ] {
        let mut file = animated();
        *file.document.pointer_mut(pointer).unwrap_or(&mut Value::Null) = value.clone();
        if file.document.pointer(pointer).is_none() {
            file.document["animations"][0]["samplers"][0]["interpolation"] = value;
        }
        let said_then = message(at(&file, 2.0));
        assert!(said_then.contains(said), "{said_then}");
    }
}

#[test]
fn an_animation_is_chosen_by_name_or_number() {
    let mut file = animated();
    let mut other = file.document["animations"][0].clone();
    other["channels"].as_array_mut().expect("a list").truncate(1);
    other["name"] = json!("slide");
    file.push("animations", other);
    let options = |animation: &str| dapple::formats::LoadOptions {
        animation: Some(animation.to_owned()),
        time: Some(2.0),
        ..Default::default()
    };
    let first = at(&file, 2.0).expect("loads");
    assert!(first.notices[0].message.contains("--animation"), "{:?}", first.notices);
    for (wanted, corner) in [("0", [2.0, 2.0]), ("1", [4.0, 0.0]), ("slide", [4.0, 0.0])] {
        let scene = file.load_with(&options(wanted)).expect("loads");
        assert!(scene.notices.is_empty(), "{:?}", scene.notices);
        let expected = Vec3::new(corner[0], corner[1], 0.0);
        assert!(corners(&scene)[1].distance(expected) < 1e-5, "{wanted}: {:?}", corners(&scene));
    }
    let error = message(file.load_with(&options("glide")));
    assert!(error.contains("no animation \"glide\"; did you mean 1 (\"slide\")"), "{error}");
}

#[test]
fn what_is_not_morphed_is_told() {
    let mut file = File::square();
    let colors = file.floats(&[[1.0, 0.0, 0.0]; 4], "VEC3");
    file.document["meshes"][0]["primitives"][0]["targets"] = json!([{"COLOR_0": colors}]);
    let scene = file.load().expect("loads");
    let notice = &scene.notices[0];
    assert!(notice.place.ends_with("/primitives/0/targets/0/COLOR_0"), "{notice:?}");
    assert!(notice.message.contains("not morphed"), "{notice:?}");
}
