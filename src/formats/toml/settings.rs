//! The table `[render]` of a TOML scene, and the settings in a picture's header: values for flags.

use std::path::Path;

use toml::de::{DeArray, DeValue};

use super::root::with_root;
use crate::formats::{LoadError, read_file, uri};

/// A setting by the name of its flag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The flag's name, without dashes.
    pub key: String,
    /// The line that it stands in, counted from 1.
    pub line: usize,
    /// What it is set to.
    pub value: SettingValue,
}

/// What a setting is set to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SettingValue {
    /// A flag without a value is given, or is not.
    Switch(bool),
    /// As on a command line.
    Word(String),
}

/// Whether the word that a key is set to names a file.
pub type NamesFile<'a> = dyn Fn(&str, &str) -> bool + 'a;

/// The settings in the table `[render]` of a TOML scene; files are named from its folder.
///
/// # Errors
/// [`LoadError`] with the line.
pub fn settings(path: &Path, names_file: &NamesFile<'_>) -> Result<Vec<Setting>, LoadError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    read(path, folder, &read_file(path)?, names_file)
}

/// The same of a file's contents; `path` is for messages.
pub(super) fn read(
    path: &Path,
    folder: &Path,
    bytes: &[u8],
    names_file: &NamesFile<'_>,
) -> Result<Vec<Setting>, LoadError> {
    with_root(path, bytes, |root| {
        let Some(table) = root.table("render")? else { return Ok(Vec::new()) };
        let mut settings = Vec::new();
        for (key, line, value) in table.entries() {
            let mut value = setting(value).ok_or_else(|| {
                table.fault_at(key, "must be text, a number, numbers or a switch")
            })?;
            if let SettingValue::Word(word) = &mut value
                && names_file(key, word)
            {
                *word = within(folder, word)
                    .map_err(|reason| LoadError::line(path, line, format!("{key}: {reason}")))?;
            }
            settings.push(Setting { key: key.to_owned(), line, value });
        }
        settings.sort_by_key(|setting| setting.line);
        Ok(settings)
    })
}

/// The settings of a text without a table, such as a picture's header; files are named as they are.
///
/// # Errors
/// [`LoadError`] with the line of the text.
pub fn settings_of_text(path: &Path, text: &str) -> Result<Vec<Setting>, LoadError> {
    with_root(path, text.as_bytes(), |root| {
        let read = |(key, line, value): (&str, usize, &DeValue)| match setting(value) {
            Some(value) => Ok(Setting { key: key.to_owned(), line, value }),
            None => Err(LoadError::line(path, line, format!("{key} is no setting"))),
        };
        root.entries().map(read).collect()
    })
}

/// A file in the scene's folder or below it.
fn within(folder: &Path, word: &str) -> Result<String, String> {
    let path = uri::file(folder, word).map_err(|reason| format!("{word:?}: {reason}"))?;
    path.into_os_string().into_string().map_err(|_| "its path is not in UTF-8".to_owned())
}

/// As on a command line: numbers in a row between commas.
fn setting(value: &DeValue) -> Option<SettingValue> {
    Some(match value {
        DeValue::Boolean(switch) => SettingValue::Switch(*switch),
        DeValue::Array(array) => SettingValue::Word(join_words(array)?),
        value => SettingValue::Word(word(value)?),
    })
}

fn join_words(array: &DeArray) -> Option<String> {
    let words: Option<Vec<String>> = array.iter().map(|value| word(value.get_ref())).collect();
    Some(words?.join(","))
}

fn word(value: &DeValue) -> Option<String> {
    match value {
        DeValue::String(text) => Some(text.to_string()),
        DeValue::Integer(whole) if whole.radix() == 10 => Some(whole.as_str().to_owned()),
        DeValue::Float(float) => Some(float.as_str().to_owned()),
        _ => None,
    }
}
