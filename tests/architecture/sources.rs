//! The sources of the crate, without comments, texts and tests.

use std::fs;
use std::path::{Path, PathBuf};

/// A file of the crate.
pub struct Source {
    /// Its place below the crate's folder.
    pub file: PathBuf,
    /// The names of its module, from the crate's root; none for the root itself.
    pub module: Vec<String>,
    /// What it holds, but for comments, texts and modules of tests; lines are kept.
    pub code: String,
}

impl Source {
    /// The source of a module.
    pub fn read(file: PathBuf, module: Vec<String>, text: &str) -> Self {
        Self { file, module, code: without_tests(&without_comments(text)) }
    }
}

/// All files of the crate, but for those that are compiled for tests alone.
pub fn sources() -> Vec<Source> {
    let mut sources = Vec::new();
    for (file, text) in all_files(&["src"]) {
        let below = file.strip_prefix("src").expect("below src").with_extension("");
        let mut module: Vec<String> =
            below.iter().map(|name| name.to_string_lossy().into_owned()).collect();
        if module == ["main"] {
            continue;
        }
        if module.last().is_some_and(|last| last == "mod" || last == "lib") {
            module.pop();
        }
        sources.push(Source::read(file, module, &text));
    }
    let tests: Vec<Vec<String>> = sources.iter().flat_map(modules_of_tests).collect();
    sources.retain(|source| !tests.iter().any(|test| source.module.starts_with(test)));
    sources
}

/// The modules that a source declares for tests alone: `#[cfg(test)]` before `mod name;`.
fn modules_of_tests(source: &Source) -> Vec<Vec<String>> {
    let names = source.code.split("#[cfg(test)]").skip(1).filter_map(|rest| {
        let line = rest.trim_start().lines().next()?;
        let (_, name) = line.strip_suffix(';')?.split_once("mod ")?;
        Some(name.trim().to_owned())
    });
    names.map(|name| source.module.iter().cloned().chain([name]).collect()).collect()
}

/// Rust files below folders of the crate, with their texts.
pub fn all_files(folders: &[&str]) -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    let mut pending: Vec<PathBuf> = folders.iter().map(|folder| root.join(folder)).collect();
    while let Some(folder) = pending.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of sources") {
            let path = entry.expect("readable").path();
            if path.is_dir() {
                pending.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let text = fs::read_to_string(&path).expect("readable");
                files.push((path.strip_prefix(root).expect("below the root").to_owned(), text));
            }
        }
    }
    files.sort();
    files
}

/// The text with comments and what stands in quotes taken out; lines are kept.
fn without_comments(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    for line in text.lines() {
        let mut quoted = false;
        let mut before = '\0';
        for (at, c) in line.char_indices() {
            match c {
                '/' if !quoted && line[at..].starts_with("//") => break,
                '"' if before != '\\' && before != '\'' => quoted = !quoted,
                _ if !quoted => code.push(c),
                _ => {}
            }
            before = if before == '\\' { '\0' } else { c };
        }
        code.push('\n');
    }
    code
}

/// The code with `#[cfg(test)] mod name { … }` taken out, which ends at a brace in the first
/// column.
fn without_tests(code: &str) -> String {
    let mut kept = String::with_capacity(code.len());
    let mut lines = code.lines().peekable();
    while let Some(line) = lines.next() {
        let starts = line == "#[cfg(test)]"
            && lines.peek().is_some_and(|next| next.contains("mod ") && next.ends_with('{'));
        if !starts {
            kept.push_str(line);
            kept.push('\n');
            continue;
        }
        for skipped in lines.by_ref() {
            kept.push('\n');
            if skipped == "}" {
                break;
            }
        }
    }
    kept
}
