//! What the files hold: for people and for programs.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::folder::Kept;

/// A paragraph for each file.
pub fn to_text(kept: &[Kept]) -> String {
    let mut text = String::new();
    for (i, file) in kept.iter().enumerate() {
        let gap = if i > 0 { "\n" } else { "" };
        let _ = writeln!(text, "{gap}{}, by bench {}", file.path.display(), file.bench);
        let about = &file.about;
        let scenes: Vec<_> = about.scenes.iter().map(label).collect();
        let version = about.version.as_ref().map(|version| format!("dapple {version}"));
        let commit = match (&version, &about.commit) {
            (version, Some(commit)) => {
                let version = version.as_ref().map_or(String::new(), |it| format!(", {it}"));
                Some(format!("{commit}{version}"))
            }
            (Some(version), None) => Some(format!("the build was not told, {version}")),
            (None, None) => None,
        };
        let rows = [
            ("scenes", Some(scenes.join(", "))),
            ("extent", Some(about.extent.join(", ")).filter(|extent| !extent.is_empty())),
            ("processor", about.processor.clone()),
            ("commit", commit),
            ("command", about.command.clone()),
        ];
        for (name, value) in rows {
            let value = value.as_deref().unwrap_or("the file does not tell");
            let _ = writeln!(text, "  {name:10} {value}");
        }
    }
    text
}

/// A scene's name and size; many names tell their size already.
fn label((name, triangles): &(String, u64)) -> String {
    if name.ends_with(&format!("-{triangles}")) {
        name.clone()
    } else {
        format!("{name} of {triangles} triangles")
    }
}

/// The same as an object.
pub fn to_json(kept: &[Kept]) -> Value {
    let file = |file: &Kept| {
        let about = &file.about;
        let scene =
            |(name, triangles): &(String, u64)| json!({ "name": name, "triangles": triangles });
        json!({
            "file": file.path.display().to_string(),
            "bench": file.bench.name(),
            "scenes": about.scenes.iter().map(scene).collect::<Vec<_>>(),
            "extent": about.extent,
            "processor": about.processor,
            "commit": about.commit,
            "version": about.version,
            "command": about.command,
        })
    };
    json!({ "files": kept.iter().map(file).collect::<Vec<_>>() })
}
