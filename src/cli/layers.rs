//! Settings of `dapple render` from elsewhere than its command line: the table `[render]` of a TOML
//! scene, or the header of the picture that `--from` names. What is typed goes before.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{ArgMatches, CommandFactory, FromArgMatches, Parser};

use super::CliError;
use super::args::RenderArgs;
use super::prepare::Job;
use crate::film::exr;
use crate::formats::toml::{self, Setting, SettingValue};
use crate::formats::{EnvironmentSource, LoadError};
use crate::scene::Notice;

/// Flags that belong on a command line: they say what becomes of the picture, or what is told.
const NO_SETTINGS: [&str; 11] = [
    "output",
    "png",
    "from",
    "dry-run",
    "print-config",
    "debug-sample",
    "progress",
    "quiet",
    "verbose",
    "json",
    "help",
];

/// Of each of some flags those that make no sense beside it: typed, it puts them out of force.
const INSTEAD: [(&str, &[&str]); 9] = [
    ("camera", &["look-from", "look-at", "up"]),
    ("look-from", &["camera"]),
    (
        "env",
        &["sky", "sun-elevation", "sun-azimuth", "sun-direction", "sun-diameter", "ground-albedo"],
    ),
    ("sky", &["env", "env-rotate"]),
    ("sun-direction", &["sun-elevation", "sun-azimuth"]),
    ("sun-elevation", &["sun-direction"]),
    ("camera-model", &["fov", "aperture", "focus"]),
    ("fov", &["camera-model"]),
    ("aperture", &["camera-model"]),
];

/// A command line alone, of which a later flag overrides an earlier one.
#[derive(Parser)]
#[command(name = "render", args_override_self = true)]
struct Words {
    #[command(flatten)]
    args: RenderArgs,
}

/// What is asked for, all told.
pub struct Settled {
    /// All flags, typed or not.
    pub args: RenderArgs,
    /// The picture that is made again.
    from: Option<Origin>,
}

/// What a picture's header says of its making.
struct Origin {
    picture: PathBuf,
    digest: Option<String>,
    version: Option<String>,
}

/// Settings from a file.
struct Layer {
    /// Where they stand, for messages.
    file: PathBuf,
    settings: Vec<Setting>,
}

/// The flags that the words after `dapple render` ask for, over the settings of the scene or of the
/// picture that they name.
///
/// # Errors
/// [`CliError::Usage`] for words that make no sense, [`CliError::Load`] or [`CliError::Input`] for
/// settings that make none.
pub fn settled(words: Vec<OsString>) -> Result<Settled, CliError> {
    let typed = matches(&words).map_err(CliError::Usage)?;
    let args = args_of(&typed).map_err(CliError::Usage)?;
    let mut all = words;
    let (layer, from) = match (&args.from, &args.scene_file) {
        (Some(picture), scene) => {
            let (layer, mut from, its_scene) = of_picture(picture)?;
            // Another pose is another scene, which is what was asked for.
            let given = |flag| typed.value_source(flag) == Some(ValueSource::CommandLine);
            if ["time", "shutter", "moments", "animation", "scene", "variant"]
                .map(given)
                .contains(&true)
            {
                from.digest = None;
            }
            if scene.is_none() {
                all.insert(0, its_scene.into());
            }
            (layer, Some(from))
        }
        (None, Some(scene)) if toml::is_toml(scene) => {
            (Layer { file: scene.clone(), settings: toml::settings(scene)? }, None)
        }
        _ => return Ok(Settled { args, from: None }),
    };
    let layered = layer.words(&typed)?;
    let parsed = matches(layered.iter().chain(&all)).and_then(|all| args_of(&all));
    let args = parsed.map_err(|message| layer.blame(message))?;
    if let Some((flag, needed)) = args.lacking() {
        // Of what is typed, the command tells.
        let error = layer.blame(format!("{flag} is of no use without {needed}"));
        if matches!(error, CliError::Load(_)) {
            return Err(error);
        }
    }
    Ok(Settled { args, from })
}

impl Settled {
    /// What is not as it was when the picture of `--from` was made.
    pub fn made_of(&self, job: &Job) -> Vec<Notice> {
        let Some(from) = &self.from else { return Vec::new() };
        let place = || from.picture.display().to_string();
        let mut notices = Vec::new();
        let digest = format!("{:016x}", job.world.scene.digest());
        if from.digest.as_ref().is_some_and(|then| *then != digest) {
            let message = "the scene is not what it was when this was made".to_owned();
            notices.push(Notice { place: place(), message });
        }
        let now = env!("CARGO_PKG_VERSION");
        if let Some(then) = from.version.as_ref().filter(|then| *then != now) {
            let message = format!("was made by dapple {then}; this is {now}");
            notices.push(Notice { place: place(), message });
        }
        notices
    }
}

/// The first paragraph of what clap says: what follows is about a command that nobody has typed.
fn in_short(error: &clap::Error) -> String {
    let text = error.to_string();
    let text = text.split("\n\n").next().unwrap_or_default();
    text.strip_prefix("error: ").unwrap_or(text).to_owned()
}

fn matches(
    words: impl IntoIterator<Item = impl AsRef<std::ffi::OsStr>>,
) -> Result<ArgMatches, String> {
    let words = words.into_iter().map(|word| word.as_ref().to_owned());
    let all = std::iter::once(OsString::from("render")).chain(words);
    Words::command().try_get_matches_from(all).map_err(|error| in_short(&error))
}

fn args_of(matches: &ArgMatches) -> Result<RenderArgs, String> {
    Words::from_arg_matches(matches).map(|words| words.args).map_err(|error| in_short(&error))
}

/// The settings in a picture's header, and its scene.
fn of_picture(picture: &Path) -> Result<(Layer, Origin, String), CliError> {
    let mut strings = exr::read(picture)?.strings;
    let mut take = |name: &str| strings.remove(&format!("dapple/{name}"));
    let (Some(settings), Some(scene)) = (take("settings"), take("scene")) else {
        let message = "its header does not tell how it was made: it is not dapple's";
        return Err(CliError::Input(format!("{}: {message}", picture.display())));
    };
    let mut settings = toml::settings_of_text(picture, &settings)?;
    for Setting { value, .. } in settings.iter_mut().filter(|setting| setting.key == "env") {
        if let SettingValue::Word(word) = value
            && let Ok(EnvironmentSource::File(file)) = word.parse()
        {
            *word = found(&file, picture).display().to_string();
        }
    }
    let scene = found(Path::new(&scene), picture).display().to_string();
    let layer = Layer { file: picture.to_owned(), settings };
    let (digest, version) = (take("scene-digest"), take("version"));
    Ok((layer, Origin { picture: picture.to_owned(), digest, version }, scene))
}

/// Where a file is that was named when a picture was made: seen from here, or else from the folder
/// of the picture, or from those around it.
fn found(file: &Path, picture: &Path) -> PathBuf {
    let picture = std::path::absolute(picture).unwrap_or_else(|_| picture.to_owned());
    let folders = picture.ancestors().skip(1);
    let from_there = folders.map(|folder| folder.join(file)).find(|path| path.exists());
    match from_there {
        Some(path) if file.is_relative() && !file.exists() => path,
        _ => file.to_owned(),
    }
}

impl Layer {
    /// The settings as words, but for those that something typed goes before.
    fn words(&self, typed: &ArgMatches) -> Result<Vec<OsString>, CliError> {
        let command = Words::command();
        let known: Vec<&str> = command
            .get_arguments()
            .filter_map(clap::Arg::get_long)
            .filter(|long| !NO_SETTINGS.contains(long))
            .collect();
        let given = |key: &str| {
            typed.value_source(&key.replace('-', "_")) == Some(ValueSource::CommandLine)
        };
        let mut words = Vec::new();
        for Setting { key, line, value } in &self.settings {
            if NO_SETTINGS.contains(&&**key) {
                let message = format!("--{key} is no setting: it belongs on the command line");
                return Err(LoadError::line(&self.file, *line, message).into());
            }
            if !known.contains(&&**key) {
                let message = toml::unknown_key("[render]", key, &known);
                return Err(LoadError::line(&self.file, *line, message).into());
            }
            let replaced = |(by, what): &(&str, &[&str])| given(by) && what.contains(&&**key);
            if given(key) || INSTEAD.iter().any(replaced) {
                continue;
            }
            match value {
                SettingValue::Switch(true) => words.push(format!("--{key}").into()),
                SettingValue::Switch(false) => {}
                SettingValue::Word(word) => words.push(format!("--{key}={word}").into()),
            }
        }
        Ok(words)
    }

    /// An error about one of the settings comes with its line.
    fn blame(&self, message: String) -> CliError {
        let named = |setting: &&Setting| {
            let flag = format!("--{}", setting.key);
            let rest = message.split_once(&flag).map(|(_, rest)| rest);
            rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '-'))
        };
        match self.settings.iter().find(named) {
            Some(setting) => LoadError::line(&self.file, setting.line, message).into(),
            None => CliError::Usage(message),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(scene: &str, words: &[&str]) -> Result<RenderArgs, CliError> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("s.toml");
        std::fs::write(&path, scene).expect("written");
        let words = std::iter::once(path.into_os_string()).chain(words.iter().map(OsString::from));
        settled(words.collect()).map(|settled| settled.args)
    }

    #[test]
    fn what_is_typed_goes_before_what_the_scene_says() {
        let scene = "[render]\nspp = 4\nseed = 9\ntransparent = true\nlook-from = [1, 2, 3]\n\
                     sky = 3\nsun-elevation = 10\n";
        let plain = args(scene, &[]).expect("good");
        assert_eq!((plain.spp, plain.seed, plain.transparent), (4, 9, true));
        assert_eq!(plain.look_from, Some(crate::math::Vec3::new(1.0, 2.0, 3.0)));
        let typed = args(scene, &["--spp", "64", "--camera", "0", "--env", "1,1,1"]).expect("good");
        assert_eq!((typed.spp, typed.seed), (64, 9));
        assert_eq!((typed.look_from, typed.sky, typed.sun_elevation), (None, None, None));
        // Of what the scene leaves open, the rest may be typed.
        let closer = args(scene, &["--look-at", "0,0,0", "--env-scale", "2"]).expect("good");
        assert!(closer.look_at.is_some() && closer.lacking().is_none());
        assert_eq!(
            args("", &["--up", "0,1,0"]).expect("parses").lacking().expect("no eye").0,
            "--up"
        );
    }

    #[test]
    fn settings_that_make_no_sense_are_told_with_their_line() {
        for (scene, message) in [
            (
                "[render]\nspp = 4\nsped = 1\n",
                "s.toml:3: [render]: unknown key \"sped\"; did you mean seed",
            ),
            ("[render]\noutput = 'x.exr'\n", "s.toml:2: --output is no setting"),
            ("[render]\nspp = 'many'\n", "s.toml:2: invalid value 'many' for '--spp <N>'"),
            ("[render]\nup = [0, 1, 0]\n", "s.toml:2: --up is of no use without --look-from"),
            ("[render]\nfov = nan\n", "s.toml:2: invalid value 'nan' for '--fov <DEGREES>'"),
            ("[render]\ncamera = '0'\nlook-from = [0, 0, 0]\n", "s.toml:2: the argument '--camera"),
        ] {
            let error = args(scene, &[]).expect_err(scene);
            let text = error.to_string();
            assert!(text.contains(message), "{text}\n{message}");
            assert_eq!(error.exit_code(), 3);
        }
    }
}
