//! What the Khronos glTF validator reports, and what dapple does about it.
//!
//! One table maps the validator's codes to verdicts; each row comes with a small file of our own
//! that has exactly this flaw. Beyond these, the table can be held against any folder of files with
//! the validator's reports beside them (`x.gltf` and `x.gltf.report.json`), such as the validator's
//! own tests: set `DAPPLE_GLTF_VALIDATOR` to the folder.

use std::fs;
use std::path::{Path, PathBuf};

use base64::prelude::{BASE64_STANDARD, Engine};
use dapple::formats::{LoadError, LoadOptions, gltf};
use dapple::scene::Scene;
use serde_json::{Value, json};

mod gltf_flaws;
use gltf_flaws::{BINARY_FLAWS, FLAWS};

/// What dapple does about a flaw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    /// The file loads without a word: the flaw cannot change the picture.
    Ignored,
    /// The file loads with a notice.
    Warned,
    /// The file does not load.
    Refused,
}
use Verdict::{Ignored, Refused, Warned};

/// A row of the table.
struct Flaw {
    /// The validator's code.
    code: &'static str,
    /// Only where the pointer has this segment; empty: anywhere. The first row that fits counts.
    within: &'static str,
    verdict: Verdict,
    /// Changes that give the sound file the flaw: pointers and JSON. See [`edited`].
    edits: &'static [(&'static str, &'static str)],
}

/// A triangle with everything that flaws may need.
fn sound_document() -> Value {
    json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": [],
        "extensionsRequired": [],
        "buffers": [{"byteLength": 44, "uri": ""}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 8},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
            {"bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 3},
        ],
        "images": [], "textures": [],
        "materials": [{"pbrMetallicRoughness": {}}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "nodes": [{"mesh": 0}, {"camera": 0}],
        "scenes": [{"nodes": [0, 1]}],
        "scene": 0,
    })
}

/// Positions and indices of the triangle.
const POSITIONS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
const INDICES: [u16; 4] = [0, 1, 2, 0];

/// The sound file with changes. The pseudo pointers `position` and `index` replace the first number
/// of the buffer's two parts; JSON `null` stands for a NaN there, and for removal elsewhere.
fn edited(edits: &[(&str, &str)]) -> Vec<u8> {
    let (mut positions, mut indices) = (POSITIONS, INDICES);
    let mut document = sound_document();
    let mut own_uri = false;
    for &(pointer, text) in edits {
        let value: Value = serde_json::from_str(text).unwrap_or_else(|e| panic!("{text}: {e}"));
        match pointer {
            "position" => positions[0] = value.as_f64().map_or(f32::NAN, |x| x as f32),
            "index" => indices[0] = value.as_u64().expect("an index") as u16,
            _ => set(&mut document, pointer, value),
        }
        own_uri |= pointer == "/buffers/0/uri" || pointer == "/buffers";
    }
    if !own_uri {
        let bytes = positions.iter().flat_map(|x| x.to_le_bytes());
        let bytes = bytes.chain(indices.iter().flat_map(|i| i.to_le_bytes()));
        let text = BASE64_STANDARD.encode(bytes.collect::<Vec<u8>>());
        let uri = format!("data:application/octet-stream;base64,{text}");
        set(&mut document, "/buffers/0/uri", uri.into());
    }
    serde_json::to_vec(&document).expect("serialises")
}

fn set(document: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    match document.pointer_mut(parent).unwrap_or_else(|| panic!("{parent} exists")) {
        Value::Object(members) if value.is_null() => drop(members.remove(key)),
        Value::Object(members) => drop(members.insert(key.to_owned(), value)),
        Value::Array(elements) => {
            let index: usize = key.parse().expect("an index");
            if index < elements.len() {
                elements[index] = value;
            } else {
                elements.push(value);
            }
        }
        other => panic!("{other} has no members"),
    }
}

fn parse(bytes: &[u8], path: &Path) -> Result<Scene, LoadError> {
    gltf::parse(path, bytes, &LoadOptions::default())
}

fn verdict(result: &Result<Scene, LoadError>) -> Verdict {
    match result {
        Err(_) => Refused,
        Ok(scene) if scene.notices.is_empty() => Ignored,
        Ok(_) => Warned,
    }
}

/// The error or the notices, for a message.
fn account(result: &Result<Scene, LoadError>) -> String {
    match result {
        Err(error) => error.to_string(),
        Ok(scene) => format!("{:?}", scene.notices),
    }
}

#[test]
fn the_sound_file_loads_without_a_word() {
    let result = parse(&edited(&[]), Path::new("sound.gltf"));
    assert_eq!(verdict(&result), Ignored, "{}", account(&result));
    let scene = result.expect("loads");
    assert_eq!((scene.instances.len(), scene.cameras.len()), (1, 1));
    assert_eq!(scene.meshes[0].indices, [[0, 1, 2]]);
}

#[test]
fn each_flaw_meets_the_verdict_of_the_table() {
    let mut wrong = Vec::new();
    for Flaw { code, within, verdict: expected, edits } in FLAWS {
        let result = parse(&edited(edits), Path::new("flaw.gltf"));
        if verdict(&result) != *expected {
            wrong.push(format!("{code} {within}: not {expected:?}: {}", account(&result)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn each_flaw_of_a_container_meets_the_verdict_of_the_table() {
    let mut wrong = Vec::new();
    for (code, expected, flaw) in BINARY_FLAWS {
        let result = parse(&flaw(), Path::new("flaw.glb"));
        if verdict(&result) != *expected {
            wrong.push(format!("{code}: not {expected:?}: {}", account(&result)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The verdict that the table gives a message of a report.
fn expected(code: &str, pointer: &str) -> Option<Verdict> {
    let fits = |flaw: &&Flaw| {
        flaw.code == code
            && (flaw.within.is_empty() || pointer.split('/').any(|part| part == flaw.within))
    };
    FLAWS.iter().find(fits).map(|flaw| flaw.verdict)
}

/// Whether a report also says that nothing uses the object that a pointer leads into: its data are
/// then never read.
fn is_unused(messages: &[Value], pointer: &str) -> bool {
    messages.iter().any(|message| {
        let unused = message["pointer"].as_str().unwrap_or_default();
        let inside = pointer.strip_prefix(unused);
        message["code"] == "UNUSED_OBJECT"
            && inside.is_some_and(|rest| !rest.starts_with(char::is_numeric))
    })
}

/// Flaws that only a look at the data can find.
const IN_THE_DATA: [&str; 1] = ["ACCESSOR_INVALID_FLOAT"];

#[test]
fn a_folder_of_reports_agrees_with_the_table() {
    let Some(folder) = std::env::var_os("DAPPLE_GLTF_VALIDATOR") else {
        eprintln!("skipped: DAPPLE_GLTF_VALIDATOR names no folder");
        return;
    };
    let (mut files, mut wrong) = (0, Vec::new());
    for report in reports(Path::new(&folder)) {
        let file = PathBuf::from(report.to_string_lossy().trim_end_matches(".report.json"));
        let text = fs::read(&report).expect("the report is read");
        let parsed: Value = serde_json::from_slice(&text).expect("the report is JSON");
        let messages = parsed["issues"]["messages"].as_array().cloned().unwrap_or_default();

        let mut most = Ignored;
        for message in &messages {
            let code = message["code"].as_str().expect("a code");
            let pointer = message["pointer"].as_str().unwrap_or_default();
            match expected(code, pointer) {
                _ if IN_THE_DATA.contains(&code) && is_unused(&messages, pointer) => {}
                Some(verdict) => most = most.max(verdict),
                None => wrong.push(format!("{}: no row for {code}", file.display())),
            }
        }
        let result = parse(&fs::read(&file).expect("the file is read"), &file);
        files += 1;
        let agrees = verdict(&result) == most || most == Ignored && is_no_flaw(&result);
        if !agrees {
            wrong.push(format!("{}: not {most:?}: {}", file.display(), account(&result)));
        }
    }
    assert!(files > 0, "the folder has reports");
    assert!(wrong.is_empty(), "{} of {files}:\n{}", wrong.len(), wrong.join("\n"));
}

/// Whether the file is sound and only lacks, or asks for, what it may: buffers without any data,
/// and features that dapple does not have yet.
fn is_no_flaw(result: &Result<Scene, LoadError>) -> bool {
    match result {
        Ok(scene) => scene.notices.iter().all(|notice| notice.message.contains("supported")),
        Err(LoadError::References { broken, .. }) => {
            broken.iter().all(|broken| broken.reason.contains("neither a URI nor"))
        }
        Err(_) => false,
    }
}

fn reports(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("the folder is read") {
        let path = entry.expect("the entry is read").path();
        if path.is_dir() {
            found.extend(reports(&path));
        } else if path.to_string_lossy().ends_with(".report.json") {
            found.push(path);
        }
    }
    found.sort();
    found
}
