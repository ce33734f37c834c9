//! Files that are broken, odd or meant to break something: OBJ, MTL, PLY, TOML,
//! NumPy, images, and what glTF files have packed: meshes of Draco, textures of KTX2.
//!
//! The corpora of the fuzz targets are replayed here, as they are, cut short and with bytes
//! changed. A file whose name starts with `ok-` is to be read, `bad-` to be refused.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use dapple::formats::obj::{check_mtl, check_obj};
use dapple::formats::{
    EnvironmentImage, LoadError, LoadOptions, MissingTexture, NotFinite, gltf, npy, obj, ply, toml,
};
use dapple::texture::{FileLevels, Image};
use proptest::prelude::*;

type Check = fn(&[u8]) -> Result<(), String>;

const CHECKS: [(&str, Check); 8] = [
    ("toml", |bytes| toml::check(bytes).map_err(|error| error.to_string())),
    ("obj", |bytes| check_obj(bytes).map_err(|error| error.to_string())),
    ("mtl", |bytes| check_mtl(bytes).map_err(|error| error.to_string())),
    ("ply", |bytes| {
        let read = ply::parse(Path::new("fuzz.ply"), bytes, &LoadOptions::default());
        read.map(drop).map_err(|error| error.to_string())
    }),
    ("npy", |bytes| {
        let read = npy::read_f32_from(bytes, bytes.len() as u64, Path::new("fuzz.npy"), 8);
        read.map(drop).map_err(|error| error.to_string())
    }),
    ("draco", |bytes| gltf::check_draco(bytes).map_err(|error| error.to_string())),
    ("ktx2", |bytes| {
        // What is odd about levels below the first is a note.
        let read = Image::decode_noting(bytes, "fuzz.ktx2", FileLevels::All);
        let (_, notes) = read.map_err(|error| format!("fuzz.ktx2: {error}"))?;
        if notes.is_empty() { Ok(()) } else { Err(format!("fuzz.ktx2: {}", notes.join(", "))) }
    }),
    ("image", |bytes| {
        // As a texture, also by an ending: tga has no signature. An environment is stricter. It is
        // enough that one of them reads the file.
        let textures = ["fuzz.image", "fuzz.tga"].map(|name| Image::decode(bytes, name).is_ok());
        let (source, length) = (Cursor::new(bytes), bytes.len() as u64);
        let environment =
            EnvironmentImage::decode(source, length, Path::new("fuzz.image"), NotFinite::Refuse);
        if textures.contains(&true) {
            return Ok(());
        }
        environment.map(drop).map_err(|error| error.to_string())
    }),
];

fn corpus(kind: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(kind);
    let entries = fs::read_dir(&folder).expect("the corpus is part of the project");
    let mut files: Vec<(String, Vec<u8>)> = entries
        .map(|entry| {
            let path = entry.expect("the folder can be read").path();
            let name = path.file_name().expect("it is a file").to_string_lossy().into_owned();
            (name, fs::read(&path).expect("the corpus can be read"))
        })
        .collect();
    files.sort();
    assert!(files.len() >= 8, "{} files of {kind}", files.len());
    files
}

#[test]
fn the_corpora_are_read_or_refused_as_their_names_say() {
    for (kind, check) in CHECKS {
        for (name, bytes) in corpus(kind) {
            let outcome = check(&bytes);
            // What a fuzzer adds has other names; it must only end.
            if name.starts_with("ok-") {
                assert_eq!(outcome, Ok(()), "{name}");
            } else if name.starts_with("bad-") {
                let message = outcome.expect_err(&name);
                assert!(message.starts_with(&format!("fuzz.{kind}:")), "{name}: {message}");
            }
        }
    }
}

#[test]
fn no_part_of_a_file_makes_a_reader_panic() {
    for (kind, check) in CHECKS {
        for (_, bytes) in corpus(kind) {
            for length in 0..bytes.len().min(400) {
                let _ = check(&bytes[..length]);
                let _ = check(&bytes[length..]);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_changed_byte_makes_a_reader_panic(
        pick in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        for (kind, check) in CHECKS {
            let files = corpus(kind);
            let mut bytes = pick.get(&files).1.clone();
            for (at, byte) in &changes {
                if !bytes.is_empty() {
                    let at = at.index(bytes.len());
                    bytes[at] = *byte;
                }
            }
            let _ = check(&bytes);
        }
    }

    #[test]
    fn no_sequence_of_statements_makes_the_reader_panic(
        lines in prop::collection::vec(
            "(v|vt|vn|f|f|f|g|o|usemtl|mtllib|s|l|map_Kd)( -?[0-9]{1,2}(/-?[0-9]?){0,3}){0,7}",
            0..40,
        ),
    ) {
        let _ = check_obj(lines.join("\n").as_bytes());
        let _ = check_mtl(format!("newmtl a\n{}", lines.join("\n")).as_bytes());
    }
}

/// A folder with files in it.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("the system's temporary folder is writable");
    for (name, text) in files {
        fs::write(folder.path().join(name), text).expect("the folder is writable");
    }
    folder
}

fn load(folder: &Path, options: &LoadOptions) -> Result<dapple::scene::Scene, LoadError> {
    obj::load(&folder.join("a.obj"), options)
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

#[test]
fn missing_textures_are_listed_all_at_once() {
    let folder = folder(&[
        ("a.obj", &format!("mtllib a.mtl\nusemtl m\n{TRIANGLE}")),
        ("a.mtl", "newmtl m\nmap_Kd one.png\nmap_d ../two.png\nbump C:\\three.png\n"),
    ]);
    let error = load(folder.path(), &LoadOptions::default()).expect_err("three are missing");
    let message = error.to_string();
    for part in ["a.mtl:2: \"one.png\"", "a.mtl:3: \"../two.png\"", "three.png", "3 references"] {
        assert!(message.contains(part), "{message}");
    }
    let goes_on =
        LoadOptions { missing_texture: MissingTexture::Magenta, ..LoadOptions::default() };
    let scene = load(folder.path(), &goes_on).expect("it goes on without");
    assert_eq!((scene.textures.len(), scene.notices.len()), (1, 3));
}

#[test]
fn a_missing_library_is_said_and_its_materials_are_grey() {
    let text = format!("mtllib gone.mtl ../out.mtl\nusemtl m\n{TRIANGLE}");
    let folder = folder(&[("a.obj", &text)]);
    let scene = load(folder.path(), &LoadOptions::default()).expect("it goes on without");
    let said: Vec<_> = scene.notices.iter().map(|notice| &*notice.message).collect();
    assert_eq!(
        said,
        [
            "material library \"gone.mtl\" is missing",
            "material library \"../out.mtl\" is not read: it leaves the scene's folder",
            "no material \"m\": it is grey",
        ]
    );
    assert!(scene.notices[2].place.ends_with("a.obj:2"));
    assert_eq!(scene.materials[scene.instances[0].material.index()].base_color.x, 0.8);
}

#[test]
fn libraries_are_found_by_names_with_spaces_and_after_their_use() {
    let text = format!("usemtl many, many spaces  \n{TRIANGLE}mtllib my materials.mtl\n");
    let folder = folder(&[
        ("a.obj", &text),
        ("my materials.mtl", "newmtl many, many spaces\nKd 0.25 0.5 0.75\n"),
    ]);
    let scene = load(folder.path(), &LoadOptions::default()).expect("it is well-formed");
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    assert_eq!(scene.materials[0].base_color.y, 0.5);
}

#[test]
fn what_is_no_file_is_an_error_with_its_name() {
    let folder = folder(&[]);
    for name in ["gone.obj", "."] {
        let path: PathBuf = folder.path().join(name);
        let error = obj::load(&path, &LoadOptions::default()).expect_err("it is no file");
        assert!(error.to_string().contains(path.to_str().expect("is text")), "{error}");
    }
}
