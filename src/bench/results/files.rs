//! The files of a folder of results: what each is about, and who measured it.

use super::member::{Malformed, Member};
use crate::names::choices;

/// A bench whose JSON is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bench {
    /// `bench mbvh`.
    Mbvh,
    /// `bench coherent`.
    Coherent,
    /// `bench kd`.
    Kd,
    /// `bench render`.
    Render,
    /// `bench accels`.
    Accels,
}

choices!(Bench, "bench", [
    Mbvh => "mbvh",
    Coherent => "coherent",
    Kd => "kd",
    Render => "render",
    Accels => "accels",
]);

impl Bench {
    /// The file that its figures are kept in.
    pub const fn file(self) -> &'static str {
        match self {
            Self::Mbvh => "mbvh.json",
            Self::Coherent => "coherent.json",
            Self::Kd => "kd.json",
            Self::Render => "render.json",
            Self::Accels => "structures.json",
        }
    }
}

/// What a file says of itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct About {
    /// Names of scenes and their triangles.
    pub scenes: Vec<(String, u64)>,
    /// How much was measured: rays, pictures, rounds.
    pub extent: Vec<String>,
    /// The processor, where the file tells it.
    pub processor: Option<String>,
    /// The commit, where the build was told.
    pub commit: Option<String>,
    /// The version of the program.
    pub version: Option<String>,
    /// The command.
    pub command: Option<String>,
}

/// Reads what a file says of itself.
///
/// # Errors
/// A member that is missing or of another kind.
pub fn read_about(bench: Bench, root: &Member<'_>) -> Result<About, Malformed> {
    let mut about = About { scenes: read_scenes(bench, root)?, ..About::default() };
    for (key, what) in [
        ("resolution", "pixels"),
        ("rays", "rays"),
        ("frames", "pictures"),
        ("spp", "samples"),
        ("rounds", "rounds"),
        ("threads", "threads"),
    ] {
        let Some(member) = root.optional(key) else { continue };
        let value = match key {
            "resolution" => {
                let (width, height) = read_resolution(&member)?;
                format!("{width}x{height}")
            }
            _ => member.count()?.to_string(),
        };
        // Of one there is no plural.
        let what = if value == "1" { what.strip_suffix('s').unwrap_or(what) } else { what };
        about.extent.push(format!("{value} {what}"));
    }
    if let Some(measured) = root.optional("measured") {
        let text = |key| measured.optional(key).map(|member| member.text()).transpose();
        let owned = |key| Ok::<_, Malformed>(text(key)?.map(str::to_owned));
        about.processor = owned("processor")?;
        about.commit = owned("commit")?;
        about.version = owned("version")?;
        about.command = owned("command")?;
    }
    Ok(about)
}

/// Names and triangles of all scenes of a file.
fn read_scenes(bench: Bench, root: &Member<'_>) -> Result<Vec<(String, u64)>, Malformed> {
    let one = |member: &Member<'_>, key: &str| {
        Ok((member.get(key)?.text()?.to_owned(), member.get("triangles")?.count()?))
    };
    match bench {
        Bench::Kd | Bench::Accels => Ok(vec![one(root, "scene")?]),
        _ => root.get("scenes")?.items()?.iter().map(|scene| one(scene, "name")).collect(),
    }
}

/// Pixels, as a pair of numbers or as `WxH`.
///
/// # Errors
/// If they are neither.
pub fn read_resolution(member: &Member<'_>) -> Result<(u32, u32), Malformed> {
    let wrong = || member.wrong("is not a width and a height");
    let sides: Vec<Option<u32>> = match (member.text(), member.items()) {
        (Ok(text), _) => text.split('x').map(|side| side.parse().ok()).collect(),
        (_, Ok(sides)) => {
            let side = |side: &Member<'_>| side.count().ok().and_then(|n| u32::try_from(n).ok());
            sides.iter().map(side).collect()
        }
        _ => return Err(wrong()),
    };
    match sides[..] {
        [Some(width), Some(height)] if width > 0 && height > 0 => Ok((width, height)),
        _ => Err(wrong()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn files_tell_scenes_and_where_they_come_from() {
        let file = json!({
            "resolution": [64, 32],
            "frames": 4,
            "scenes": [{ "name": "city", "triangles": 9200 }],
            "measured": { "processor": "CPU 9", "commit": null, "command": "dapple bench" },
        });
        let about = read_about(Bench::Coherent, &Member::root(&file)).expect("is well formed");
        assert_eq!(about.scenes, [("city".to_owned(), 9200)]);
        assert_eq!(about.extent, ["64x32 pixels", "4 pictures"]);
        assert_eq!(about.processor.as_deref(), Some("CPU 9"));
        assert_eq!((about.commit, about.version), (None, None));
    }

    #[test]
    fn what_is_malformed_is_named() {
        let told = |file: serde_json::Value| {
            read_about(Bench::Render, &Member::root(&file)).expect_err("wrong").to_string()
        };
        assert_eq!(told(json!([])), "the whole is not an object");
        assert_eq!(told(json!({ "scenes": {} })), "scenes is not a list");
        let scenes = json!([{ "name": "a", "triangles": -1 }]);
        assert_eq!(told(json!({ "scenes": scenes })), {
            "scenes[0].triangles is not a whole number of 0 or more"
        });
        for resolution in [json!("500"), json!("0x5"), json!([1, 2, 3]), json!(5), json!("axb")] {
            let file = json!({ "scenes": [], "resolution": resolution });
            assert_eq!(told(file), "resolution is not a width and a height");
        }
        let measured = json!({ "scenes": [], "measured": { "processor": 5 } });
        assert_eq!(told(measured), "measured.processor is not a text");
    }
}
