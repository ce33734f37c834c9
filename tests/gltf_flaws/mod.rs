//! The table of flaws: the validator's codes, dapple's verdicts, and a file for each.

use super::{Flaw, Ignored, Refused, Verdict, Warned, edited};

const fn flaw(
    code: &'static str,
    within: &'static str,
    verdict: Verdict,
    edits: &'static [(&'static str, &'static str)],
) -> Flaw {
    Flaw { code, within, verdict, edits }
}

/// Flaws of documents, by code.
#[rustfmt::skip]
pub const FLAWS: &[Flaw] = &[
    // Bounds are computed from the data; what is declared about them is not looked at.
    flaw("ACCESSOR_ELEMENT_OUT_OF_MAX_BOUND", "", Ignored, &[("/accessors/0/max", "[0, 0, 0]")]),
    flaw("ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND", "", Ignored, &[("/accessors/0/min", "[1, 1, 1]")]),
    flaw("ACCESSOR_INDEX_OOB", "", Refused, &[("index", "3")]),
    flaw("ACCESSOR_INVALID_FLOAT", "", Refused, &[("position", "null")]),
    // Only inverse bind matrices are matrices, and skins are not supported.
    flaw("ACCESSOR_MATRIX_ALIGNMENT", "", Ignored, &[("/accessors/2", r#"{"bufferView": 0,
        "byteOffset": 1, "componentType": 5121, "type": "MAT2", "count": 1}"#)]),
    flaw("ACCESSOR_MAX_MISMATCH", "", Ignored, &[("/accessors/0/max", "[9, 9, 9]")]),
    flaw("ACCESSOR_MIN_MISMATCH", "", Ignored, &[("/accessors/0/min", "[-9, -9, -9]")]),
    flaw("ACCESSOR_NORMALIZED_INVALID", "", Warned, &[("/accessors/0/normalized", "true")]),
    flaw("ACCESSOR_OFFSET_ALIGNMENT", "", Warned, &[("/accessors/2", r#"{"bufferView": 1,
        "byteOffset": 1, "componentType": 5123, "type": "SCALAR", "count": 1}"#)]),
    flaw("ACCESSOR_SMALL_BYTESTRIDE", "", Refused, &[("/bufferViews/0/byteStride", "8")]),
    flaw("ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE", "", Refused, &[("/accessors/0/sparse",
        r#"{"count": 4, "indices": {"bufferView": 1, "componentType": 5123},
        "values": {"bufferView": 0}}"#)]),
    flaw("ACCESSOR_SPARSE_INDEX_OOB", "", Refused, &[("index", "3"), ("/accessors/0/sparse",
        r#"{"count": 1, "indices": {"bufferView": 1, "componentType": 5123},
        "values": {"bufferView": 0}}"#)]),
    flaw("ACCESSOR_TOO_LONG", "", Refused, &[("/accessors/0/count", "4")]),
    flaw("ACCESSOR_TOTAL_OFFSET_ALIGNMENT", "", Warned, &[("/accessors/2", r#"{"bufferView": 2,
        "componentType": 5123, "type": "SCALAR", "count": 1}"#),
        ("/bufferViews/2", r#"{"buffer": 0, "byteOffset": 1, "byteLength": 2}"#)]),
    // Normalised; the lengths say nothing.
    flaw("ACCESSOR_VECTOR3_NON_UNIT", "", Warned, &[
        ("/meshes/0/primitives/0/attributes/NORMAL", "0")]),
    flaw("ARRAY_LENGTH_NOT_IN_LIST", "", Refused, &[("/nodes/0/translation", "[1, 2]")]),
    flaw("ASSET_MIN_VERSION_GREATER_THAN_VERSION", "", Refused, &[
        ("/asset/minVersion", r#""2.1""#)]),
    flaw("BUFFER_BYTE_LENGTH_MISMATCH", "", Refused, &[("/buffers/0/byteLength", "45")]),
    flaw("BUFFER_VIEW_INVALID_BYTE_STRIDE", "", Warned, &[
        ("/bufferViews/0/byteStride", "12"), ("/bufferViews/0/target", "34963")]),
    flaw("BUFFER_VIEW_TOO_BIG_BYTE_STRIDE", "", Ignored, &[
        ("/bufferViews/1/byteStride", "16"), ("/accessors/1", r#"{"bufferView": 1, "count": 1,
        "componentType": 5123, "type": "SCALAR"}"#), ("/meshes/0/primitives/0/indices", "null")]),
    flaw("BUFFER_VIEW_TOO_LONG", "", Refused, &[("/bufferViews/1/byteLength", "9")]),
    flaw("CAMERA_XMAG_YMAG_NEGATIVE", "", Warned, &[("/cameras/0", r#"{"type": "orthographic",
        "orthographic": {"xmag": -1, "ymag": 1, "znear": 0, "zfar": 1}}"#)]),
    flaw("CAMERA_XMAG_YMAG_ZERO", "", Refused, &[("/cameras/0", r#"{"type": "orthographic",
        "orthographic": {"xmag": 0, "ymag": 1, "znear": 0, "zfar": 1}}"#)]),
    flaw("CAMERA_YFOV_GEQUAL_PI", "", Refused, &[("/cameras/0/perspective/yfov", "3.2")]),
    flaw("CAMERA_ZFAR_LEQUAL_ZNEAR", "", Ignored, &[("/cameras/0/perspective/zfar", "0.1")]),
    flaw("DUPLICATE_ELEMENTS", "extensionsUsed", Warned, &[
        ("/extensionsUsed", r#"["A_b", "A_b"]"#)]),
    flaw("DUPLICATE_ELEMENTS", "extensionsRequired", Refused, &[
        ("/extensionsRequired", r#"["A_b", "A_b"]"#)]),
    flaw("DUPLICATE_ELEMENTS", "", Refused, &[("/scenes/0/nodes", "[0, 0]")]),
    flaw("EMPTY_ENTITY", "", Ignored, &[("/samplers", "[]")]),
    flaw("IMAGE_UNRECOGNIZED_FORMAT", "", Refused, &[
        ("/images", r#"[{"uri": "data:image/png;base64,AAAA"}]"#),
        ("/textures", r#"[{"source": 0}]"#),
        ("/materials/0/emissiveTexture", r#"{"index": 0}"#)]),
    flaw("INVALID_EXTENSION_NAME_FORMAT", "", Warned, &[("/extensionsUsed", r#"["ab"]"#)]),
    flaw("INVALID_URI", "", Refused, &[("/buffers/0/uri", r#""data:;base64,!!!!""#)]),
    flaw("IO_ERROR", "", Refused, &[("/buffers/0/uri", r#""no-such-file.bin""#)]),
    flaw("MATERIAL_ALPHA_CUTOFF_INVALID_MODE", "", Ignored, &[("/materials/0/alphaCutoff", "0.3")]),
    flaw("MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT", "", Refused, &[
        ("/accessors/0/type", r#""VEC2""#)]),
    flaw("MESH_PRIMITIVE_INCOMPATIBLE_MODE", "", Warned, &[("/accessors/1/count", "4")]),
    flaw("MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT", "", Refused, &[
        ("/accessors/1/componentType", "5122")]),
    flaw("MESH_PRIMITIVE_NO_POSITION", "", Warned, &[
        ("/meshes/0/primitives/0/attributes/POSITION", "null")]),
    flaw("MESH_PRIMITIVE_TOO_FEW_TEXCOORDS", "", Warned, &[
        ("/images", concat!(
            r#"[{"uri": "data:image/bmp;base64,Qk06AAAAAAAAADYAAAAoAAAAAQAAAAEAAAABABgA"#,
            r#"AAAAAAQAAAATCwAAEwsAAAAAAAAAAAAA////AA=="}]"#)),
        ("/textures", r#"[{"source": 0}]"#), ("/materials/0/emissiveTexture", r#"{"index": 0}"#)]),
    flaw("MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT", "", Refused, &[
        ("/meshes/0/primitives/0/attributes/NORMAL", "2"), ("/accessors/2", r#"{"bufferView": 0,
        "componentType": 5126, "type": "VEC3", "count": 2}"#)]),
    // The one is honoured; of the others it is said that they have no part in it.
    flaw("MULTIPLE_EXTENSIONS", "", Warned, &[("/extensionsUsed", r#"["KHR_materials_ior",
        "KHR_materials_unlit"]"#), ("/materials/0/extensions",
        r#"{"KHR_materials_unlit": {}, "KHR_materials_ior": {}}"#)]),
    flaw("NODE_EMPTY", "", Ignored, &[("/nodes/1", "{}")]),
    flaw("NODE_LOOP", "", Refused, &[("/nodes/2", r#"{"children": [2]}"#)]),
    flaw("NODE_MATRIX_TRS", "", Refused, &[("/nodes/0/scale", "[1, 1, 1]"),
        ("/nodes/0/matrix", "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]")]),
    flaw("NODE_PARENT_OVERRIDE", "", Refused, &[("/scenes/0/nodes", "[1, 2]"),
        ("/nodes/1/children", "[0]"), ("/nodes/2", r#"{"children": [0]}"#)]),
    flaw("NON_OBJECT_EXTRAS", "", Ignored, &[("/nodes/0/extras", "7")]),
    flaw("NON_RELATIVE_URI", "", Refused, &[("/buffers/0/uri", r#""https://example.org/a.bin""#)]),
    flaw("ONE_OF_MISMATCH", "", Warned, &[
        ("/cameras/0/orthographic", r#"{"xmag": 1, "ymag": 1, "znear": 0, "zfar": 1}"#)]),
    flaw("ROTATION_NON_UNIT", "", Warned, &[("/nodes/0/rotation", "[0, 0, 0, 2]")]),
    flaw("SCENE_NON_ROOT_NODE", "", Refused, &[("/nodes/0/children", "[1]")]),
    flaw("TYPE_MISMATCH", "", Refused, &[("/materials/0/name", "5")]),
    flaw("UNDECLARED_EXTENSION", "", Warned, &[
        ("/materials/0/extensions", r#"{"KHR_materials_ior": {"ior": 1.4}}"#)]),
    flaw("UNDEFINED_PROPERTY", "", Refused, &[("/accessors/0/count", "null")]),
    flaw("UNEXPECTED_PROPERTY", "", Ignored, &[("/nodes/0/colour", "7")]),
    flaw("UNKNOWN_ASSET_MAJOR_VERSION", "", Refused, &[("/asset/version", r#""3.0""#)]),
    flaw("UNRESOLVED_REFERENCE", "", Refused, &[("/nodes/0/mesh", "1")]),
    // The members that others depend on are not needed.
    flaw("UNSATISFIED_DEPENDENCY", "", Ignored, &[("/extensionsUsed", "null"),
        ("/extensionsRequired", r#"["KHR_materials_ior"]"#)]),
    flaw("UNSUPPORTED_EXTENSION", "", Warned, &[("/extensionsUsed", r#"["A_b"]"#)]),
    // The validator knows that it is not used; dapple does not know the extension.
    flaw("UNUSED_EXTENSION_REQUIRED", "", Refused, &[("/extensionsRequired", r#"["A_b"]"#)]),
    flaw("UNUSED_OBJECT", "", Ignored, &[("/materials/1", "{}")]),
    flaw("VALUE_MULTIPLE_OF", "", Warned, &[("/bufferViews/1/byteStride", "5"),
        ("/accessors/1/count", "1"), ("/meshes/0/primitives/0/indices", "null")]),
    flaw("VALUE_NOT_IN_LIST", "", Refused, &[("/accessors/0/type", r#""VEC5""#)]),
    flaw("VALUE_NOT_IN_RANGE", "cameras", Refused, &[("/cameras/0/perspective/znear", "0")]),
    flaw("VALUE_NOT_IN_RANGE", "materials", Warned, &[
        ("/materials/0/pbrMetallicRoughness/roughnessFactor", "1.2")]),
    flaw("VALUE_NOT_IN_RANGE", "", Refused, &[("/bufferViews/0/byteLength", "0")]),
    // The whole document instead of a part of it.
    flaw("INVALID_JSON", "", Refused, &[("/asset", "null")]),
];

/// A container of the sound document, its chunks as given.
fn container(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, content) in chunks {
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(*kind);
        bytes.extend(*content);
    }
    with_length(bytes, 0)
}

/// Declares the length that the container has, and `more`.
fn with_length(mut bytes: Vec<u8>, more: i32) -> Vec<u8> {
    let length = (bytes.len() as i32 + more) as u32;
    bytes[8..12].copy_from_slice(&length.to_le_bytes());
    bytes
}

fn sound() -> Vec<u8> {
    container(&[(b"JSON", &padded())])
}

fn padded() -> Vec<u8> {
    let mut json = edited(&[]);
    json.resize(json.len().next_multiple_of(4), b' ');
    json
}

fn changed(at: usize, byte: u8) -> Vec<u8> {
    let mut bytes = sound();
    bytes[at] = byte;
    bytes
}

fn followed_by(more: &[u8]) -> Vec<u8> {
    [&sound()[..], more].concat()
}

type BinaryFlaw = (&'static str, Verdict, fn() -> Vec<u8>);

/// Flaws of containers, and of files that are no JSON.
pub const BINARY_FLAWS: &[BinaryFlaw] = &[
    ("none", Ignored, sound),
    ("INVALID_JSON", Refused, || b"{".to_vec()),
    ("INVALID_JSON", Refused, Vec::new),
    ("INVALID_JSON", Refused, || [b"\xef\xbb\xbf", &edited(&[])[..]].concat()),
    ("GLB_CHUNK_LENGTH_UNALIGNED", Ignored, || {
        container(&[(b"JSON", &[&padded()[..], b" "].concat())])
    }),
    ("GLB_CHUNK_TOO_BIG", Refused, || changed(15, 1)),
    ("GLB_DUPLICATE_CHUNK", Refused, || container(&[(b"JSON", &padded()), (b"JSON", b"{}")])),
    ("GLB_EXTRA_DATA", Warned, || followed_by(b"more")),
    ("GLB_INVALID_MAGIC", Refused, || changed(3, b'f')),
    ("GLB_INVALID_VERSION", Refused, || changed(4, 1)),
    ("GLB_LENGTH_MISMATCH", Refused, || with_length(sound(), 4)),
    ("GLB_LENGTH_TOO_SMALL", Refused, || with_length(sound(), 4 - sound().len() as i32)),
    ("GLB_UNEXPECTED_END_OF_CHUNK_HEADER", Refused, || with_length(followed_by(b"abcd"), 0)),
    ("GLB_UNEXPECTED_END_OF_HEADER", Refused, || b"glTF\x02\0\0\0".to_vec()),
    ("GLB_UNEXPECTED_FIRST_CHUNK", Refused, || container(&[(b"BIN\0", b"abcd")])),
    ("GLB_UNKNOWN_CHUNK_TYPE", Ignored, || container(&[(b"JSON", &padded()), (b"What", b"abcd")])),
];
