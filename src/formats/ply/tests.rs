use super::*;
use crate::math::{Vec2, Vec3};
use crate::texture::srgb_to_linear;

fn scene(text: &[u8]) -> Result<Scene, LoadError> {
    parse(Path::new("a.ply"), text, &LoadOptions::default())
}

fn message(text: &[u8]) -> String {
    scene(text).expect_err("the file is broken").to_string()
}

fn notices(scene: &Scene) -> Vec<&str> {
    scene.notices.iter().map(|notice| notice.message.as_str()).collect()
}

const SQUARE: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n\
    property float y\nproperty float z\nelement face 1\n\
    property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

/// The square, its numbers in binary.
fn binary(big: bool) -> Vec<u8> {
    let name = if big { "binary_big_endian" } else { "binary_little_endian" };
    let header = SQUARE.replace("ascii", name);
    let (header, body) = header.split_once("end_header\n").expect("has one");
    let mut bytes = format!("{header}end_header\n").into_bytes();
    for word in body.split_whitespace() {
        let number: f32 = word.parse().expect("a number");
        bytes.extend(if big { number.to_be_bytes() } else { number.to_le_bytes() });
    }
    bytes.push(4);
    for index in 0..4_i32 {
        bytes.extend(if big { index.to_be_bytes() } else { index.to_le_bytes() });
    }
    bytes
}

#[test]
fn all_encodings_tell_the_same() {
    let ascii = format!("{SQUARE}4 0 1 2 3\n").into_bytes();
    for bytes in [ascii, binary(false), binary(true)] {
        let scene = scene(&bytes).expect("well-formed");
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y]);
        assert_eq!(mesh.indices, [[0, 1, 2], [0, 2, 3]]);
        assert!(scene.notices.is_empty(), "{:?}", scene.notices);
        assert_eq!(scene.materials[0], Material::grey());
    }
}

/// Rows end where their lines do, so that a number too many takes no other face away.
#[test]
fn numbers_beyond_a_list_are_skipped_and_said() {
    let two = SQUARE.replace("face 1", "face 2");
    let mesh = scene(format!("{two}3 0 1 2 3\n3 0 2 3\n").as_bytes()).expect("well-formed");
    assert_eq!(mesh.meshes[0].indices, [[0, 1, 2], [0, 2, 3]]);
    let said = "1 rows have more numbers than their properties, the first in line 14: those at the \
                end are skipped";
    assert_eq!(notices(&mesh), [said]);
    // Of vertices as well.
    let more = SQUARE.replace("1 1 0\n", "1 1 0 255 255 255\n");
    let mesh = scene(format!("{more}4 0 1 2 3\n").as_bytes()).expect("well-formed");
    assert_eq!(mesh.meshes[0].indices, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.notices.len(), 1);
    let short = message(format!("{two}4 0 1 2\n3 0 2 3\n").as_bytes());
    assert_eq!(short, "a.ply:14: face 0: the line ends before it does");
    // Where lines are no rows, numbers alone count.
    let mesh = scene(format!("{two}3 0 1 2 3 0\n2\n3\n").as_bytes()).expect("well-formed");
    assert_eq!(mesh.meshes[0].indices, [[0, 1, 2], [0, 2, 3]]);
    assert!(mesh.notices.is_empty(), "{:?}", mesh.notices);
}

#[test]
fn every_truncation_is_an_error() {
    for bytes in [binary(false), binary(true)] {
        for length in 0..bytes.len() {
            let said = message(&bytes[..length]);
            assert!(said.starts_with("a.ply:"), "{said}");
        }
    }
    assert_eq!(message(SQUARE.as_bytes()), "a.ply:14: face 0: the file ends before it does");
    let cut = &binary(false)[..binary(false).len() - 30];
    assert_eq!(message(cut), "a.ply: vertex 2: the file ends before it does");
}

#[test]
fn counts_beyond_the_file_cost_nothing() {
    let vertices = SQUARE.replace("vertex 4", "vertex 4294967295");
    assert_eq!(message(vertices.as_bytes()), "a.ply:14: vertex 4: the file ends before it does");
    let vertices = SQUARE.replace("vertex 4", "vertex 4294967296");
    assert!(message(vertices.as_bytes()).contains("4294967296 vertices are too many"));
    let faces = format!("{}4 0 1 2 3\n", SQUARE.replace("face 1", "face 18446744073709551615"));
    assert_eq!(message(faces.as_bytes()), "a.ply:15: face 1: the file ends before it does");
    let list = format!("{}4000000000 0 1 2\n", SQUARE.replace("uchar int", "uint int"));
    assert_eq!(message(list.as_bytes()), "a.ply:15: face 0: the file ends before it does");
    let nothing =
        SQUARE.replace("element face 1", "element face 0\nelement x 18446744073709551615");
    let scene = scene(nothing.replace("property list uchar int vertex_indices\n", "").as_bytes());
    assert_eq!(notices(&scene.expect("is read"))[0], "elements x are not honoured");
}

#[test]
fn faces_refer_to_vertices_that_are_there() {
    let bad = format!("{SQUARE}3 0 1 4\n");
    assert_eq!(message(bad.as_bytes()), "a.ply:14: face 0: refers to vertex 4 of 4");
    let bad = format!("{SQUARE}3 0 -1 2\n");
    assert_eq!(message(bad.as_bytes()), "a.ply:14: face 0: refers to vertex -1 of 4");
    let bad = format!("{SQUARE}3 0 x 2\n");
    assert_eq!(message(bad.as_bytes()), "a.ply:14: face 0: 'x' is no number at all");
}

#[test]
fn positions_are_there_and_finite() {
    let bad = SQUARE.replace("1 1 0", "1 nan 0");
    let expected = "a.ply:12: vertex 2: its position is infinite or not a number";
    assert_eq!(message(bad.as_bytes()), expected);
    let bad = SQUARE.replace("float z", "float w");
    assert_eq!(message(bad.as_bytes()), "a.ply: element vertex: has no properties x, y and z");
}

#[test]
fn polygons_and_triangles_keep_their_order_and_small_faces_go() {
    let text = SQUARE.replace("face 1", "face 4") + "3 0 1 2\n4 0 1 2 3\n2 0 1\n3 2 3 0\n7 ";
    let scene = scene(text.as_bytes()).expect("well-formed");
    assert_eq!(scene.meshes[0].indices, [[0, 1, 2], [0, 1, 2], [0, 2, 3], [2, 3, 0]]);
    assert_eq!(
        notices(&scene),
        [
            "goes on after the last element that its header declares",
            "1 faces of fewer than three corners are skipped",
        ]
    );
}

#[test]
fn faces_may_come_before_their_vertices() {
    let text = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\n\
        element vertex 3\nproperty double x\nproperty double y\nproperty double z\nend_header\n\
        3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n";
    let scene = scene(text.as_bytes()).expect("well-formed");
    assert_eq!(scene.meshes[0].indices, [[0, 1, 2]]);
}

#[test]
fn vertices_have_normals_coordinates_and_colours() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float quality\nproperty float x\n\
        property float y\nproperty float z\nproperty float nx\nproperty float ny\n\
        property float nz\nproperty float s\nproperty float t\nproperty uchar red\n\
        property uchar green\nproperty uchar blue\nproperty uchar alpha\nelement face 1\n\
        property list uchar int vertex_indices\nend_header\n\
        7 0 0 0  0 0 2  0 0  255 0 0 255\n7 1 0 0  0 0 0  1 0  0 255 0 51\n\
        7 0 1 0  0 1 0  0 nan  0 0 128 255\n3 0 1 2\n";
    let scene = scene(text.as_bytes()).expect("well-formed");
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.normals, [Vec3::Z, Vec3::Z, Vec3::Y]);
    assert_eq!(mesh.uvs[0], [Vec2::Y, Vec2::ONE, Vec2::ZERO]);
    let blue = srgb_to_linear(128.0 / 255.0);
    let expected = [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.2], [0.0, 0.0, blue, 1.0]];
    assert_eq!(mesh.colors, expected.map(Vec4::from_array));
    assert_eq!(scene.materials[0].base_color, Vec4::ONE);
    assert_eq!(scene.materials[0].alpha_mode, AlphaMode::Blend);
    assert_eq!(notices(&scene).len(), 3);
    assert_eq!(notices(&scene)[0], "properties not honoured: quality");
}

#[test]
fn corners_may_have_coordinates_of_their_own() {
    let list = "property list uchar int vertex_indices\n";
    let text = SQUARE
        .replace("face 1", "face 2")
        .replace(list, &format!("{list}property list uchar float texcoord\n"))
        + "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 0.5 0.5 0 1\n";
    let mesh = scene(text.as_bytes()).expect("well-formed").meshes[0].clone();
    assert_eq!(mesh.indices, [[0, 1, 2], [0, 3, 4]]);
    assert_eq!(mesh.positions[3], mesh.positions[2]);
    assert_eq!(mesh.uvs[0][2..4], [Vec2::new(1.0, 0.0), Vec2::new(0.5, 0.5)]);
    let bad = text.replace("6 0 0 1 0 1 1", "4 0 0 1 0");
    assert_eq!(
        message(bad.as_bytes()),
        "a.ply:15: face 0: has 2 texture coordinates for 3 corners"
    );
}

#[test]
fn strips_beside_corners_with_coordinates_have_those_of_their_vertices() {
    let list = "property list uchar int vertex_indices\n";
    let texcoord = format!("{list}property list uchar float texcoord\n");
    let text = SQUARE.replace(list, &format!("{texcoord}element tristrips 1\n{list}"))
        + "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3\n";
    let bare = scene(text.as_bytes()).expect("well-formed");
    assert_eq!(notices(&bare), ["some corners have no texture coordinates; 0 takes their place"]);
    let text = text.replace("float z\n", "float z\nproperty float u\nproperty float v\n").replace(
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n",
        "0 0 0 0 0\n1 0 0 0 0\n1 1 0 0.5 0.25\n0 1 0 0 0.5\n",
    );
    let scene = scene(text.as_bytes()).expect("well-formed");
    let mesh = &scene.meshes[0];
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    assert_eq!(mesh.indices, [[0, 1, 2], [0, 3, 4]]);
    assert_eq!(mesh.uvs[0][2..], [Vec2::X, Vec2::new(0.5, 0.75), Vec2::new(0.0, 0.5)]);
}

#[test]
fn strips_turn_as_their_first_triangle_does() {
    let text = SQUARE.replace("face 1", "tristrips 1") + "9 0 1 2 3 -1 3 2 2 1\n";
    let mesh = scene(text.as_bytes()).expect("well-formed").meshes[0].clone();
    assert_eq!(mesh.indices, [[0, 1, 2], [2, 1, 3]]);
}

#[test]
fn strips_without_vertices_are_refused_however_many() {
    let start = SQUARE.split("element face").next().expect("a start");
    for strips in ["", "property uchar length\n"] {
        let text = format!("{start}element tristrips 18446744073709551615\n{strips}end_header\n")
            + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
        let said = message(text.as_bytes());
        assert!(said.ends_with("has no list called vertex_indices or vertex_index"), "{said}");
    }
}

#[test]
fn a_picture_that_is_missing_is_named() {
    let text = format!("{SQUARE}4 0 1 2 3\n")
        .replace("element vertex", "comment TextureFile no such.png\nelement vertex");
    let unused = scene(text.as_bytes()).expect("it is not needed");
    assert!(notices(&unused)[0].contains("there are no texture coordinates"));
    let text = text
        .replace("float z\n", "float z\nproperty float u\nproperty float v\n")
        .replace(" 0\n", " 0 0 0\n");
    let said = message(text.as_bytes());
    assert!(said.starts_with("a.ply:3: \"no such.png\": no such file; --missing"), "{said}");
    let options =
        LoadOptions { missing_texture: MissingTexture::Magenta, ..LoadOptions::default() };
    let scene = parse(Path::new("a.ply"), text.as_bytes(), &options).expect("goes on");
    assert_eq!((scene.textures.len(), scene.notices.len()), (1, 1));
}

#[test]
fn points_alone_are_told() {
    let text = SQUARE.split("element face").next().expect("a start").to_owned()
        + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
    let scene = scene(text.as_bytes()).expect("well-formed");
    assert_eq!(notices(&scene), ["has points alone, which have no area"]);
}

#[test]
fn there_is_one_scene_only() {
    let options = LoadOptions { scene: Some("0".to_owned()), ..LoadOptions::default() };
    let error = parse(Path::new("a.ply"), b"", &options).expect_err("has none");
    assert_eq!(error.to_string(), "a.ply: no scene \"0\"; it has none");
}
