//! Files packed by Draco beside their plain twins: the same triangles, and vertices where the steps
//! of the packing put them. The files are those of Draco's own encoder.

use std::fs;
use std::path::Path;
use std::process::Command;

use dapple::Picture;
use dapple::formats::{LoadOptions, gltf};
use dapple::geom::Mesh;
use dapple::math::Vec3;
use dapple::scene::Scene;

fn corpus(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/gltf");
    fs::read(folder.join(name)).expect("is part of the project")
}

fn load(bytes: &[u8]) -> Result<Scene, String> {
    let read = gltf::parse(Path::new("a.glb"), bytes, &LoadOptions::default());
    read.map_err(|error| error.to_string())
}

fn scene(name: &str) -> Scene {
    load(&corpus(name)).expect(name)
}

/// A step of positions of 14 bits in a range of 2, and what weights of 12 bits move by half a
/// metre.
const POSITION_STEP: f32 = 2.0 / 16383.0 + 0.5 / 4095.0;

/// The plain triangle, turned, whose corners lie where those of a packed one do.
fn twin(packed: &Mesh, triangle: [u32; 3], plain: &Mesh) -> Option<(usize, [u32; 3])> {
    let near = |a: u32, b: u32| {
        let away = packed.positions[a as usize] - plain.positions[b as usize];
        away.abs().max_element() <= POSITION_STEP
    };
    let turns = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b]];
    let found = |(number, &candidate): (usize, &[u32; 3])| {
        let same = |turned: &[u32; 3]| (0..3).all(|i| near(triangle[i], turned[i]));
        turns(candidate).into_iter().find(same).map(|turned| (number, turned))
    };
    plain.indices.iter().enumerate().find_map(found)
}

/// Whether each triangle has its twin, and whether all else at its corners is as near as it can be.
fn assert_twins(packed: &Mesh, plain: &Mesh) {
    assert_eq!(packed.indices.len(), plain.indices.len());
    assert_eq!(plain.indices.len(), 32, "a grid of four by four squares");
    let mut met = vec![false; plain.indices.len()];
    for &triangle in &packed.indices {
        let (number, turned) = twin(packed, triangle, plain).expect("there is one");
        assert!(!std::mem::replace(&mut met[number], true), "triangle {number} is there twice");
        for (a, b) in triangle.into_iter().zip(turned) {
            let (a, b) = (a as usize, b as usize);
            assert!((packed.normals[a] - plain.normals[b]).length() < 2.0 / 511.0);
            let tangents = packed.tangents[a] - plain.tangents[b];
            assert!(tangents.length() < 4.0 / 4095.0, "{tangents}");
            for set in 0..2 {
                let uvs = packed.uvs[set][a] - plain.uvs[set][b];
                assert!(uvs.abs().max_element() <= 1.0 / 4095.0, "{uvs}");
            }
            let colors = packed.colors[a] - plain.colors[b];
            assert!(colors.abs().max_element() <= 1.0 / 255.0, "{colors}");
        }
    }
}

/// Packed files and their twins.
const TWINS: [(&str, &str); 3] = [
    ("ok-draco-edgebreaker.glb", "ok-draco-edgebreaker-plain.glb"),
    ("ok-draco-valence.glb", "ok-draco-edgebreaker-plain.glb"),
    ("ok-draco-sequential.glb", "ok-draco-sequential-plain.glb"),
];

#[test]
fn packed_meshes_are_their_plain_twins() {
    for (packed, plain) in TWINS {
        let (packed, plain) = (scene(packed), scene(plain));
        assert!(packed.notices.is_empty(), "{:?}", packed.notices);
        assert_twins(&packed.meshes[0], &plain.meshes[0]);
    }
}

/// A file as it is seen.
fn picture(name: &str) -> Picture {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join(name), corpus(name)).expect("written");
    let output = Command::new(env!("CARGO_BIN_EXE_dapple"))
        .args(["render", name, "-o", "out.exr", "--resolution", "96x96", "--spp", "64", "-q"])
        .args(["--env", "1,1,1", "--light", "file"])
        .current_dir(folder.path())
        .output()
        .expect("the binary runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Picture::read(folder.path().join("out.exr")).expect("a picture")
}

#[test]
fn packed_meshes_look_as_their_plain_twins() {
    for (packed, plain) in TWINS {
        let difference = dapple::diff(&picture(packed), &picture(plain)).expect("of one size");
        assert!(difference.flip < 0.01, "{packed}: {}", difference.flip);
    }
    // Two that are no twins are told apart.
    let [one, other] = [TWINS[0].1, TWINS[2].1].map(picture);
    assert!(dapple::diff(&one, &other).expect("of one size").flip > 0.1);
}

/// The skin lifts half of the grid, and the morph, which is not packed, one side of it.
#[test]
fn skins_and_morphs_stay_beside() {
    let height = |name: &str, at: Vec3| {
        let mesh = &scene(name).meshes[0];
        let near = |p: &&Vec3| (p.truncate() - at.truncate()).length() < 0.01;
        mesh.positions.iter().find(near).expect("a corner").z
    };
    let corner = Vec3::new(1.0, 1.0, 0.0);
    let (skinned, morphed) = ("ok-draco-edgebreaker.glb", "ok-draco-sequential.glb");
    assert!((height(skinned, corner) - 0.5).abs() < 1e-3);
    assert!((height(morphed, corner) - 1.0).abs() < 1e-3);
}

/// What is cut or changed in a packed mesh is refused with the primitive's name, or read.
#[test]
fn broken_meshes_name_their_primitive() {
    let bytes = corpus("ok-draco-edgebreaker.glb");
    let start = bytes.windows(5).position(|window| window == b"DRACO").expect("is packed");
    let mut refused = 0;
    for at in start..bytes.len() {
        let mut broken = bytes.clone();
        broken[at] ^= 0xff;
        if let Err(error) = load(&broken) {
            let place = "a.glb: /meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
            let of_attributes = "a.glb: /meshes/0/primitives/0";
            assert!(error.starts_with(place) || error.starts_with(of_attributes), "{error}");
            refused += 1;
        }
    }
    assert!(refused > 50, "{refused}");
}

/// A container whose document is changed.
fn changed(glb: &[u8], change: impl FnOnce(&mut serde_json::Value)) -> Vec<u8> {
    let word = |at: usize| u32::from_le_bytes([glb[at], glb[at + 1], glb[at + 2], glb[at + 3]]);
    let end = 20 + word(12) as usize;
    let mut document = serde_json::from_slice(&glb[20..end]).expect("is JSON");
    change(&mut document);
    let mut text = serde_json::to_vec(&document).expect("serialises");
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = (glb.len() - end + 20 + text.len()) as u32;
    let mut made = [&glb[..8], &length.to_le_bytes()].concat();
    made.extend((text.len() as u32).to_le_bytes());
    made.extend(&glb[16..20]);
    made.extend(text);
    made.extend(&glb[end..]);
    made
}

/// What is packed and none of the primitive's attributes is left out, and named.
#[test]
fn packed_attributes_that_the_primitive_does_not_have_are_named() {
    let bytes = corpus("ok-draco-edgebreaker.glb");
    assert!(load(&changed(&bytes, |_| ())).expect("loads").notices.is_empty());
    let packed = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/attributes";
    let odd = changed(&bytes, |document| {
        document.pointer_mut(packed).expect("is there")["_FOO"] = 77.into();
    });
    let [notice] = &load(&odd).expect("loads").notices[..] else { panic!("one notice") };
    assert_eq!(notice.place, format!("a.glb: {packed}/_FOO"));
    assert!(notice.message.contains("no attribute of the primitive: it is left out"));
    assert!(notice.is_refused());
}
