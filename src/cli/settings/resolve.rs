//! From what was typed, and from what a file says beneath it, to the values of all settings.
//!
//! The command line takes precedence over the header of the picture that `--from` names, which
//! holds all settings of the run that it repeats, and so over the table `[render]` of a .toml
//! scene.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::args::RenderArgs;
use super::command::Typed;
use super::origin::{self, Origin};
use super::parse_long::Share;
use super::pose;
use super::setting::{Assignment, Form, Role, Setting};
use super::table::Table;
use crate::cli::error::CliError;
use crate::cli::text::format_count;
use crate::formats::LoadError;
use crate::formats::toml::{self, Setting as Line, SettingValue};
use crate::sampling::BLOCK;

/// What is asked for.
#[derive(Debug)]
pub struct Request {
    /// The values of all settings.
    pub args: RenderArgs,
    /// The picture that is made again.
    pub from: Option<Origin>,
}

/// Works out all settings from what was typed.
///
/// # Errors
/// [`CliError::Usage`] for flags that make no sense together; [`CliError::Load`] or
/// [`CliError::Input`] for a file whose settings make none.
pub fn resolve(typed: &Typed) -> Result<Request, CliError> {
    resolve_by(&Table::default(), typed)
}

/// The same from a scene and further words of a command line, of which a later one overrides an
/// earlier one.
///
/// # Errors
/// Those of [`resolve`], and [`CliError::Usage`] for words that `dapple render` does not take.
pub fn resolve_words(scene: &Path, words: &[String]) -> Result<Request, CliError> {
    let all = std::iter::once(scene.into()).chain(words.iter().map(OsString::from));
    resolve(&Table::default().read_words(all).map_err(CliError::Usage)?)
}

/// The same by a table of one's own.
pub(super) fn resolve_by(table: &Table, typed: &Typed) -> Result<Request, CliError> {
    let mut args = table.defaults();
    typed.apply(&mut args);
    let replaced =
        |setting: &Setting| typed.given.iter().any(|(typed, _)| table.replaces(typed, setting));
    let (source, from) = match &args.from {
        Some(picture) => {
            let header = origin::read_header(table, picture)?;
            let mut origin = header.origin;
            // Another scene is what was asked for.
            if typed.given.iter().any(|(setting, _)| setting.role == Role::Scene) {
                origin.digest = None;
            }
            let source = Source::read(table, picture, header.settings, &replaced)?;
            if typed.scene_file.is_none() {
                args.scene_file = header.scene_file;
            }
            (source, Some(origin))
        }
        None if toml::is_toml(&args.scene_file) => {
            let file = &args.scene_file;
            let lines = toml::settings(file, &|key, word| table.names_file(key, word))?;
            (Source::read(table, file, lines, &replaced)?, None)
        }
        None => (Source::default(), None),
    };
    for value in &source.values {
        value.assignment.apply(&mut args);
    }
    pose::pose_first(&mut args, typed)?;
    if let Some(setting) = table.find_useless(&args, &typed.given) {
        return Err(source.blame(setting, explain_useless(setting)));
    }
    require_samples(&args)?;
    Ok(Request { args, from })
}

/// Makes sure that each part has samples: a picture of none would take the place of a better one.
fn require_samples(args: &RenderArgs) -> Result<(), CliError> {
    let (Some(share), spp) = (args.part, args.spp) else { return Ok(()) };
    let most = Share::most(spp);
    if share.count <= most {
        return Ok(());
    }
    let parts = format_count(most, "part", "parts");
    Err(CliError::Usage(format!(
        "--part {share}: {spp} samples a pixel make {parts} at most, for they are cut at multiples \
         of {BLOCK}; ask for fewer parts, or for --spp {}",
        share.count.saturating_mul(BLOCK)
    )))
}

/// The error about a setting that is of no use.
fn explain_useless(setting: &Setting) -> String {
    let needed: Vec<String> = setting.requires.iter().map(|name| format!("--{name}")).collect();
    format!("{} is of no use without {}", setting.flag(), needed.join(" or "))
}

/// Settings from a file.
#[derive(Default)]
struct Source {
    file: PathBuf,
    values: Vec<Value>,
}

/// A setting in a file.
struct Value {
    setting: &'static Setting,
    line: usize,
    assignment: Assignment,
}

impl Source {
    /// Reads the settings of a file, except for those that are `replaced`.
    ///
    /// # Errors
    /// With the line of the first that cannot be: an unknown one, one that belongs on the command
    /// line, one with a bad value, or one that excludes another.
    fn read(
        table: &Table,
        file: &Path,
        lines: Vec<Line>,
        replaced: &dyn Fn(&Setting) -> bool,
    ) -> Result<Self, CliError> {
        let fault = |line, message: String| CliError::from(LoadError::line(file, line, message));
        let mut values: Vec<Value> = Vec::new();
        for Line { key, line, value } in lines {
            let setting = find(table, &key).map_err(|message| fault(line, message))?;
            if replaced(setting) {
                continue;
            }
            let assignment = read(setting, &value).map_err(|message| fault(line, message))?;
            if let Some(other) = values.iter().find(|it| it.setting.excludes(setting)) {
                let (first, second) = (other.setting.usage(), setting.usage());
                let message = format!("the argument '{first}' cannot be used with '{second}'");
                return Err(fault(other.line, message));
            }
            values.push(Value { setting, line, assignment });
        }
        Ok(Self { file: file.to_owned(), values })
    }

    /// An error about a setting: with its line if it is from this file.
    fn blame(&self, setting: &Setting, message: String) -> CliError {
        match self.values.iter().find(|value| value.setting.name == setting.name) {
            Some(value) => LoadError::line(&self.file, value.line, message).into(),
            None => CliError::Usage(message),
        }
    }
}

/// The setting of a key.
fn find(table: &Table, key: &str) -> Result<&'static Setting, String> {
    match table.find(key) {
        Some(setting) if setting.role.is_recorded() => Ok(setting),
        Some(_) => Err(format!("--{key} is no setting: it belongs on the command line")),
        None => {
            let recorded = table.settings().filter(|setting| setting.role.is_recorded());
            let known: Vec<&str> = recorded.map(|setting| setting.name).collect();
            Err(toml::unknown_key("[render]", key, &known))
        }
    }
}

/// Reads the value of a setting.
fn read(setting: &Setting, value: &SettingValue) -> Result<Assignment, String> {
    let word = match value {
        SettingValue::Word(word) => word.clone(),
        SettingValue::Switch(on) => on.to_string(),
    };
    let is_switch = matches!(value, SettingValue::Switch(_));
    let parsed = match setting.form == Form::Switch {
        form if form != is_switch && is_switch => Err("is no switch".to_owned()),
        form if form != is_switch => Err("is either true or false".to_owned()),
        _ => setting.parse(word.as_ref()),
    };
    parsed.map_err(|error| format!("invalid value '{word}' for '{}': {error}", setting.usage()))
}
