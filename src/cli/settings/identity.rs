//! Which settings make two pictures different ones, so that their samples do not add up.

use std::collections::BTreeMap;
use std::path::Path;

use super::args::RenderArgs;
use super::setting::{Group, Role, Setting};
use super::table::Table;
use crate::cli::error::CliError;
use crate::formats::toml::{self, SettingValue};

/// What stands for a file: its contents are in the digest of the scene.
const A_FILE: &str = "a file";

impl Table {
    /// The settings that samples depend on, with their values as TOML.
    ///
    /// Neither the number of samples nor the part of the frame: parts differ in both.
    pub fn identity(&self, args: &RenderArgs) -> BTreeMap<String, String> {
        let counts = |name: &str| !["spp", "crop"].contains(&name);
        let value = |setting: &Setting| {
            let value = (setting.write)(args)?;
            let names_file = value.as_str().is_some_and(|word| (setting.names_file)(word));
            Some(if names_file { A_FILE.to_owned() } else { value.to_string() })
        };
        self.settings()
            .filter(|setting| setting.role.identifies_picture() && counts(setting.name))
            .filter(|setting| self.is_useful(setting, args))
            .filter_map(|setting| Some((setting.name.to_owned(), value(setting)?)))
            .collect()
    }

    /// The flags that give settings which are written as TOML, without those that are as by default
    /// or about the machine, the number of samples or the part of the frame.
    ///
    /// # Errors
    /// If the text is not what [`Table::to_toml`] wrote.
    pub fn to_words(&self, place: &Path, text: &str) -> Result<Vec<String>, CliError> {
        let defaults = self.to_toml(&self.defaults());
        let defaults = toml::settings_of_text(place, &defaults)?;
        let mut words = Vec::new();
        for line in toml::settings_of_text(place, text)? {
            let is_default =
                defaults.iter().any(|other| other.key == line.key && other.value == line.value);
            let setting = self.find(&line.key);
            let is_of_picture = setting.is_some_and(|setting| setting.group != Group::Speed);
            if is_default || !is_of_picture || ["spp", "crop"].contains(&&*line.key) {
                continue;
            }
            words.push(format!("--{}", line.key));
            if let SettingValue::Word(word) = line.value {
                words.push(word);
            }
        }
        Ok(words)
    }

    /// Whether a picture that is to be reproducible tells a setting: not what the machine was asked
    /// for.
    pub fn is_reproducible(&self, name: &str) -> bool {
        let about_machine = |setting: &Setting| {
            setting.role == Role::Process && matches!(setting.group, Group::Speed | Group::Long)
        };
        !self.find(name).is_some_and(about_machine) || name == "reproducible"
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::settings::resolve_words;

    fn args(words: &str) -> RenderArgs {
        let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        resolve_words(Path::new("a.gltf"), &words).expect("good words").args
    }

    /// Each setting of the table, changed alone: its role says whether samples still add up.
    #[test]
    fn each_setting_that_samples_depend_on_makes_another_picture() {
        let table = Table::default();
        for setting in table.settings() {
            let mut base = table.defaults();
            if let Some(needed) = setting.requires.first().and_then(|name| table.find(name)) {
                needed.parse(needed.example.as_ref()).expect("an example").apply(&mut base);
            }
            let mut changed = base.clone();
            setting.parse(setting.example.as_ref()).expect("an example").apply(&mut changed);
            let (a, b) = (table.identity(&base), table.identity(&changed));
            let expected =
                setting.role.identifies_picture() && !["spp", "crop"].contains(&setting.name);
            let names_file = (setting.names_file)(setting.example);
            assert_eq!(a != b, expected, "--{}", setting.name);
            if expected {
                let shown = if names_file { Some(&A_FILE.to_owned()) } else { b.get(setting.name) };
                assert!(b.contains_key(setting.name) && b.get(setting.name) == shown);
            }
        }
    }

    #[test]
    fn samples_add_up_however_many_there_are() {
        let table = Table::default();
        let identity = |words: &str| table.identity(&args(words));
        assert_eq!(identity("--spp 4"), identity("--spp 8 --crop 0,0,1,1"));
        let open = "--time 0 --shutter 1";
        assert_eq!(identity(&format!("{open} --spp 4")), identity(&format!("{open} --spp 8")));
        assert_ne!(identity(open), identity("--time 0 --shutter 2"));
        assert_eq!(identity("--env a.hdr"), identity("--env b/c.hdr"), "the digest tells them");
        assert_ne!(identity("--env a.hdr"), identity("--env 1,1,1"));
    }

    #[test]
    fn flags_can_be_made_from_what_a_picture_tells() {
        let table = Table::default();
        let given = "--spp 4 --seed 3 --env 1,2,3 --transparent --resolution 64x32 --threads 2";
        let words = table.to_words(Path::new("a"), &table.to_toml(&args(given))).expect("good");
        let expected = "--env 1,2,3 --env-rotate 0.0 --env-scale 1.0 --resolution 64,32 --seed 3 \
                        --transparent";
        assert_eq!(words.join(" "), expected);
        assert_eq!(table.identity(&args(&words.join(" "))), table.identity(&args(given)));
    }
}
