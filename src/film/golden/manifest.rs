//! The manifest of a folder of golden pictures.

use crate::files;
use crate::film::FilmError;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// The manifest's name in its folder.
pub const MANIFEST: &str = "golden.toml";

/// The largest manifest that is read: a limit against what is no manifest at all.
const MAX_BYTES: u64 = 1 << 20;

/// One entry of a manifest, with paths that can be opened.
#[derive(Clone, Debug, PartialEq)]
pub struct GoldenScene {
    /// Its name in tables and for `--only`.
    pub name: String,
    /// The scene.
    pub file: PathBuf,
    /// The picture that renders are compared with.
    pub golden: PathBuf,
    /// Arguments of `dapple render`; `{folder}` in the manifest is its folder here.
    pub render: Vec<String>,
    /// When a render counts as the same.
    pub limits: Limits,
}

/// How two pictures are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Rule {
    /// Pixel by pixel: the same samples were taken.
    #[default]
    Pixels,
    /// By a z-test over tiles: the same expectation, from other samples.
    Ztest,
}

/// When a render counts as the same as its golden picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// Which of the limits below count.
    pub rule: Rule,
    /// A pixel is off if a channel differs by more than this times `max(1, |golden|)`.
    pub tolerance: f64,
    /// The greatest share of pixels that may be off.
    pub pixels_off: f64,
    /// The greatest mean FLIP (HDR), of either rule.
    pub flip: f64,
    /// The greatest relMSE, of either rule.
    pub relmse: f64,
    /// For the z-test: the greatest share of tiles with |z| > 5.
    pub bad_tiles: f64,
}

impl Default for Limits {
    /// 99.9 % of pixels within 1e-4 and FLIP up to 0.001.
    fn default() -> Self {
        Self {
            rule: Rule::Pixels,
            tolerance: 1e-4,
            pixels_off: 0.001,
            flip: 0.001,
            relmse: f64::INFINITY,
            bad_tiles: 0.01,
        }
    }
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
struct SomeLimits {
    rule: Option<Rule>,
    tolerance: Option<f64>,
    pixels_off: Option<f64>,
    flip: Option<f64>,
    relmse: Option<f64>,
    bad_tiles: Option<f64>,
}

impl SomeLimits {
    fn override_limits(self, base: Limits) -> Limits {
        let rule = self.rule.unwrap_or(base.rule);
        // Other samples look different: FLIP only limits the z-test where it is asked to.
        let flip = if rule == Rule::Ztest && base.rule != rule { f64::INFINITY } else { base.flip };
        Limits {
            rule,
            tolerance: self.tolerance.unwrap_or(base.tolerance),
            pixels_off: self.pixels_off.unwrap_or(base.pixels_off),
            flip: self.flip.unwrap_or(flip),
            relmse: self.relmse.unwrap_or(base.relmse),
            bad_tiles: self.bad_tiles.unwrap_or(base.bad_tiles),
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ManifestFile {
    #[serde(default)]
    render: Vec<String>,
    #[serde(default)]
    limits: SomeLimits,
    #[serde(default)]
    scene: Vec<SceneEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneEntry {
    name: String,
    file: PathBuf,
    golden: Option<PathBuf>,
    #[serde(default)]
    render: Vec<String>,
    #[serde(default)]
    limits: SomeLimits,
}

/// Reads the manifest of a folder; scenes in the file's order.
///
/// # Errors
/// [`FilmError::Read`]; [`FilmError::Invalid`] for bad TOML (with the line), unknown keys, a name
/// that occurs twice, or no scene at all.
pub fn load(folder: &Path) -> Result<Vec<GoldenScene>, FilmError> {
    let path = folder.join(MANIFEST);
    let bytes = files::read(&path, MAX_BYTES).map_err(|source| FilmError::read(&path, source))?;
    let text =
        String::from_utf8(bytes).map_err(|_| FilmError::invalid(&path, "is not text in UTF-8"))?;
    let manifest: ManifestFile = toml::from_str(&text)
        .map_err(|error| FilmError::invalid(&path, error.to_string().trim_end()))?;
    let limits = manifest.limits.override_limits(Limits::default());
    let mut names = HashSet::new();
    for scene in &manifest.scene {
        if scene.name.is_empty() || !names.insert(scene.name.clone()) {
            let message = format!("scene name `{}` is empty or occurs twice", scene.name);
            return Err(FilmError::invalid(&path, message));
        }
    }
    if manifest.scene.is_empty() {
        return Err(FilmError::invalid(&path, "lists no [[scene]]"));
    }
    // Arguments that name files can be written from the manifest's folder, wherever one stands.
    let here = folder.to_string_lossy();
    let argument = |text: String| text.replace("{folder}", &here);
    let scenes = manifest.scene.into_iter().map(|scene| GoldenScene {
        file: folder.join(&scene.file),
        golden: folder.join(scene.golden.unwrap_or_else(|| format!("{}.exr", scene.name).into())),
        render: manifest.render.iter().cloned().chain(scene.render).map(argument).collect(),
        limits: scene.limits.override_limits(limits),
        name: scene.name,
    });
    Ok(scenes.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn load_text(text: &str) -> Result<Vec<GoldenScene>, FilmError> {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join(MANIFEST), text).expect("written");
        let mut scenes = load(folder.path())?;
        for scene in &mut scenes {
            for path in [&mut scene.file, &mut scene.golden] {
                *path = path.strip_prefix(folder.path()).expect("in the folder").to_owned();
            }
        }
        Ok(scenes)
    }

    #[test]
    fn scenes_inherit_arguments_and_limits() {
        let scenes = load_text(
            r#"
            render = ["--spp", "4"]
            limits = { flip = 0.5, tolerance = 0.1 }
            [[scene]]
            name = "a"
            file = "x/a.gltf"
            [[scene]]
            name = "b"
            file = "b.obj"
            golden = "other.exr"
            render = ["--seed", "7"]
            [scene.limits]
            rule = "ztest"
            bad-tiles = 0.25
            "#,
        )
        .expect("sound");
        let common = Limits { flip: 0.5, tolerance: 0.1, ..Limits::default() };
        assert_eq!(
            scenes[0],
            GoldenScene {
                name: "a".into(),
                file: "x/a.gltf".into(),
                golden: "a.exr".into(),
                render: vec!["--spp".into(), "4".into()],
                limits: common,
            }
        );
        assert_eq!(scenes[1].render, ["--spp", "4", "--seed", "7"]);
        assert_eq!(scenes[1].golden, Path::new("other.exr"));
        let ztest = Limits { rule: Rule::Ztest, bad_tiles: 0.25, flip: f64::INFINITY, ..common };
        assert_eq!(scenes[1].limits, ztest);
    }

    #[test]
    fn arguments_may_name_files_from_the_folder() {
        let folder = tempfile::tempdir().expect("a folder");
        let text =
            "[[scene]]\nname = \"a\"\nfile = \"a\"\nrender = [\"--env\", \"{folder}/e.hdr\"]";
        fs::write(folder.path().join(MANIFEST), text).expect("written");
        let scenes = load(folder.path()).expect("sound");
        assert_eq!(scenes[0].render[1], folder.path().join("e.hdr").to_string_lossy());
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let message = |text: &str| load_text(text).expect_err("unsound").to_string();
        let unknown = message("[[scene]]\nname = \"a\"\nfile = \"a\"\nspp = 4\n");
        assert!(unknown.contains("golden.toml: ") && unknown.contains("line 4"), "{unknown}");
        assert!(unknown.contains("unknown field `spp`"), "{unknown}");
        let twice = "[[scene]]\nname = \"a\"\nfile = \"a\"\n".repeat(2);
        assert!(message(&twice).contains("scene name `a` is empty or occurs twice"));
        assert!(message("").contains("lists no [[scene]]"));
        let error = load(Path::new("no/such")).expect_err("not there");
        assert_eq!((error.exit_code(), error.to_string().contains("golden.toml")), (3, true));
    }
}
