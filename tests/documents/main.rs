//! The README and `docs/` say what is true: their commands run, their links lead somewhere, and
//! their tables are those of the results that the bench wrote.

mod commands;
mod markdown;
mod tables;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use commands::{Command, Folder};
use markdown::{Document, anchor};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// All that a reader is sent to.
const DOCUMENTS: &[&str] = &[
    "README.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "docs/guide.md",
    "docs/farms.md",
    "docs/structures.md",
    "docs/results.md",
    "docs/peers.md",
    "docs/formats.md",
    "docs/accuracy.md",
    "docs/design.md",
];

fn read(name: &str) -> Document {
    let text = fs::read_to_string(root().join(name));
    Document::new(name, text.unwrap_or_else(|error| panic!("{name}: {error}")))
}

/// Runs a document's commands in their order, in a folder of their own, at a reduced size.
fn run(name: &str, at_least: usize) {
    let document = read(name);
    let folder = Folder::new();
    document.files().for_each(|(file, text)| folder.place(file, text));
    let commands = Command::of(&document);
    assert!(commands.len() >= at_least, "{name}: {} commands", commands.len());
    for command in &commands {
        command.run(&folder);
    }
}

#[test]
fn the_commands_of_the_readme_run() {
    run("README.md", 11);
}

#[test]
fn the_commands_of_the_guide_run() {
    run("docs/guide.md", 45);
}

#[test]
fn the_commands_of_the_other_documents_run() {
    for name in DOCUMENTS.iter().filter(|name| !["README.md", "docs/guide.md"].contains(name)) {
        run(name, 0);
    }
}

#[test]
fn commands_that_are_not_run_have_a_reason() {
    let documents = DOCUMENTS.iter().map(|name| read(name));
    let left_out: Vec<_> = documents.flat_map(|document| document.left_out()).collect();
    for (place, reason) in &left_out {
        assert!(reason.len() > 10, "{place}: why is it not run?");
    }
    assert!(left_out.len() <= 11, "{left_out:?}");
}

#[test]
fn links_lead_somewhere() {
    let mut links = 0;
    for name in DOCUMENTS {
        let document = read(name);
        let folder = Path::new(name).parent().expect("is a file");
        for link in document.links().filter(|link| !link.contains("://")) {
            let (path, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if path.is_empty() { (*name).into() } else { folder.join(path) };
            assert!(root().join(&target).exists(), "{name}: {link}");
            if !heading.is_empty() {
                let target = read(target.to_str().expect("is ASCII"));
                let anchors: BTreeSet<_> = target.headings().map(anchor).collect();
                assert!(anchors.contains(heading), "{name}: {link}: {anchors:?}");
            }
            links += 1;
        }
    }
    assert!(links >= 60, "{links} links");
}

#[test]
fn paths_are_those_of_the_project() {
    let folders = ["src/", "tests/", "docs/", "examples/", "fuzz/", "golden/", "scenes/", ".ci/"];
    let mut paths = 0;
    for name in DOCUMENTS {
        let document = read(name);
        let is_path = |code: &&str| folders.iter().any(|folder| code.starts_with(folder));
        for path in document.code().filter(is_path).filter(|path| !path.contains([' ', '*', ':'])) {
            assert!(root().join(path).exists(), "{name}: {path}");
            paths += 1;
        }
    }
    assert!(paths >= 80, "{paths} paths");
}

#[test]
fn names_in_the_design_are_those_of_the_sources() {
    // Words of the language, not of the project.
    const KEYWORDS: [&str; 3] = ["enum", "match", "mod"];
    let sources = ["src", "tests"].map(|folder| sources(&root().join(folder))).concat();
    let document = read("docs/design.md");
    let is_name = |code: &&str| {
        let named = code.chars().all(|c| c.is_ascii_alphanumeric() || "_:!".contains(c));
        named && code.len() > 1 && !KEYWORDS.contains(code)
    };
    for name in document.code().filter(is_name) {
        let last = name.trim_end_matches('!').rsplit("::").next().expect("has a last part");
        let defines = |kind: &str| {
            let defined = format!("{kind} {last}");
            sources
                .split(&*defined)
                .skip(1)
                .any(|rest| !rest.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_'))
        };
        let kinds =
            ["fn", "struct", "enum", "trait", "const", "static", "mod", "macro_rules!", "let"];
        let variant =
            sources.contains(&format!("    {last},")) || sources.contains(&format!("    {last}("));
        assert!(kinds.into_iter().any(defines) || variant, "{name} is defined nowhere");
    }
}

/// All Rust sources of a folder, one after the other.
fn sources(folder: &Path) -> String {
    let entries = fs::read_dir(folder).expect("is readable").map(|entry| entry.expect("is there"));
    let text = |path: PathBuf| {
        if path.is_dir() {
            sources(&path)
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            fs::read_to_string(path).expect("is text")
        } else {
            String::new()
        }
    };
    entries.map(|entry| text(entry.path())).collect()
}

#[test]
fn programs_of_the_guide_are_those_of_the_examples() {
    let example = fs::read_to_string(root().join("examples/render.rs")).expect("is there");
    let (guide, mut lines) = (read("docs/guide.md"), 0);
    for block in guide.blocks().iter().filter(|block| block.language == "rust") {
        for line in &block.lines {
            assert!(example.lines().any(|other| other.trim() == *line), "{line}");
            lines += 1;
        }
    }
    assert!(lines >= 8, "{lines} lines");
}

#[test]
fn every_document_is_linked_from_the_readme() {
    let readme = read("README.md");
    let links: BTreeSet<_> = readme.links().collect();
    for name in DOCUMENTS.iter().filter(|name| **name != "README.md") {
        assert!(links.contains(name), "{name}");
    }
}

#[test]
fn every_picture_of_the_gallery_is_shown() {
    let guide = read("docs/guide.md");
    for entry in fs::read_dir(root().join("docs/gallery")).expect("is there") {
        let name = entry.expect("is readable").file_name();
        let link = format!("gallery/{}", name.to_string_lossy());
        assert!(guide.links().any(|other| other == link), "{link}");
    }
}
