//! Command lines of the documents, and how they are run.

use std::fs::{self, File};
use std::path::Path;
use std::process::{self, Stdio};

use super::markdown::Document;
use super::root;

/// A folder that looks like the project's own to a command.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// With the scenes, the golden pictures and a few rays.
    pub fn new() -> Self {
        let folder = Self(tempfile::tempdir().expect("temporary folders can be made"));
        for name in ["scenes", "golden"] {
            copy(&root().join(name), &folder.0.path().join(name));
        }
        copy(&root().join("tests/cmd/rays.in/rays.npy"), &folder.0.path().join("rays.npy"));
        folder
    }

    /// Puts a file into it.
    pub fn place(&self, name: &str, text: String) {
        let path = self.0.path().join(name);
        fs::create_dir_all(path.parent().expect("is below the folder")).expect("is writable");
        fs::write(path, text).expect("is writable");
    }
}

fn copy(from: &Path, to: &Path) {
    if !from.is_dir() {
        fs::copy(from, to).expect("can be copied");
        return;
    }
    fs::create_dir(to).expect("is writable");
    for entry in fs::read_dir(from).expect("is readable") {
        let entry = entry.expect("is readable");
        copy(&entry.path(), &to.join(entry.file_name()));
    }
}

/// A line that a reader may type.
pub struct Command {
    place: String,
    /// Without `dapple` itself.
    words: Vec<String>,
    /// Where its standard output goes.
    output: Option<String>,
    /// The exit code that the document tells of.
    code: i32,
}

impl Command {
    /// All of a document that are to be run, in their order.
    pub fn of(document: &Document) -> Vec<Self> {
        // The README's main commands stand in indented blocks.
        let indented = document.prose().filter(|(_, line)| line.starts_with("    cargo run "));
        let mut lines: Vec<(usize, String)> =
            indented.map(|(number, line)| (number, line.trim().to_owned())).collect();
        for block in document.blocks() {
            if block.language != "sh" || !block.tag.is_empty() {
                continue;
            }
            let text = block.lines.join("\n").replace("\\\n", " ");
            lines.extend(text.lines().map(|line| (block.first, line.to_owned())));
        }
        let place = |number| format!("{}:{number}", document.name);
        lines.iter().filter_map(|(number, line)| Self::parse(place(number), line)).collect()
    }

    fn parse(place: String, line: &str) -> Option<Self> {
        let (line, code) = line.split_once(" # exit code ").unwrap_or((line, "0"));
        let line = line.strip_prefix("cargo run --release -- ").or(line.strip_prefix("dapple "))?;
        let (line, output) = line.split_once(" > ").map_or((line, None), |(a, b)| (a, Some(b)));
        let code = code.trim().parse().unwrap_or_else(|_| panic!("{place}: exit code {code}"));
        Some(Self { place, words: words(line), output: output.map(|o| o.trim().into()), code })
    }

    /// Runs it, at a size that takes no time, and holds it to its exit code.
    pub fn run(&self, folder: &Folder) {
        let folder = folder.0.path();
        let words = reduced(&self.words);
        let stdout = self.output.as_ref().map_or_else(Stdio::null, |name| {
            File::create(folder.join(name)).expect("is writable").into()
        });
        let mut command = process::Command::new(env!("CARGO_BIN_EXE_dapple"));
        command.args(&words).current_dir(folder).stdin(Stdio::null()).stdout(stdout);
        let output = command.stderr(Stdio::piped()).output().expect("the binary runs");
        let message = String::from_utf8_lossy(&output.stderr);
        let told = format!("{}: dapple {}\n{message}", self.place, words.join(" "));
        assert_eq!(output.status.code(), Some(self.code), "{told}");
    }
}

/// Words as a shell parts them, but for what no document needs: escapes and variables.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in line.chars() {
        match (c, quote) {
            (c, Some(open)) if c == open => quote = None,
            ('"' | '\'', None) => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            (' ', None) => words.extend(word.take()),
            (c, _) => word.get_or_insert_default().push(c),
        }
    }
    assert!(quote.is_none(), "{line}: a quotation is not closed");
    words.extend(word);
    words
}

/// Flags by which a command does less, and whether it works on a scene that may be a smaller one.
fn reduction(words: &[String]) -> (&'static [(&'static str, &'static str)], bool) {
    let has = |flag: &str| words.iter().any(|word| word == flag);
    let two: Vec<&str> = words.iter().take(2).map(String::as_str).collect();
    match two[..] {
        ["render", ..] if has("--debug-sample") => (&[], false),
        ["render", ..] if has("--crop") => (&[("--spp", "1")], false),
        // As many as four parts need.
        ["render", ..] if has("--part") => (&[("--spp", "64"), ("--resolution", "16x12")], false),
        ["render", ..] if has("--shutter") => (&[("--spp", "2"), ("--resolution", "32x24")], false),
        ["render", ..] => (&[("--spp", "2"), ("--resolution", "32x24")], false),
        ["golden", _] if words.get(2).is_some_and(|word| word == "golden") => {
            (&[("--only", "furnace")], false)
        }
        ["generate", "forest"] => (&[("--triangles", "5000"), ("--copies", "60")], false),
        ["generate", _] => (&[("--triangles", "2000")], false),
        ["validate", ..] => (&[("--rays", "2000"), ("--brute-rays", "200")], true),
        ["bench", "accels"] => (&[("--rays", "300"), ("--rounds", "1")], true),
        ["bench", "kd"] => (&[("--rays", "300")], true),
        ["bench", "mbvh"] => (&[("--rays", "100"), ("--rounds", "1")], true),
        ["bench", "render"] => {
            (&[("--resolution", "16x12"), ("--spp", "1"), ("--rounds", "1")], true)
        }
        ["bench", "coherent"] => {
            (&[("--resolution", "32x32"), ("--frames", "1"), ("--rounds", "1")], true)
        }
        _ => (&[], false),
    }
}

/// Whether a word names a file of one of these endings.
pub fn has_ending(word: &str, endings: &[&str]) -> bool {
    Path::new(word).extension().is_some_and(|ending| endings.iter().any(|it| ending == *it))
}

fn reduced(words: &[String]) -> Vec<String> {
    let (flags, any_scene) = reduction(words);
    let mut words = words.to_vec();
    for (flag, value) in flags {
        if let Some(at) = words.iter().position(|word| word == flag) {
            (*value).clone_into(&mut words[at + 1]);
        } else {
            // Before what is handed on to another command.
            let end = words.iter().position(|word| word == "--").unwrap_or(words.len());
            words.splice(end..end, [(*flag).to_owned(), (*value).to_owned()]);
        }
    }
    if any_scene {
        let large = |word: &&mut String| has_ending(word, &["glb", "gltf"]);
        for word in words.iter_mut().filter(large) {
            "scenes/cornell.gltf".clone_into(word);
        }
    }
    words
}

#[test]
fn words_are_parted_as_by_a_shell() {
    assert_eq!(words("a  'b c' \"\" d\"e f\"g"), ["a", "b c", "", "de fg"]);
    let small = reduced(&words("render a.gltf --spp 64 -o a.exr"));
    assert_eq!(small.join(" "), "render a.gltf --spp 2 -o a.exr --resolution 32x24");
    let small = reduced(&words("golden check golden -- --accel bvh2"));
    assert_eq!(small.join(" "), "golden check golden --only furnace -- --accel bvh2");
}
