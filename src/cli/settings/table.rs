//! The table of settings, and what follows from it.

use toml::Table as TomlTable;

use super::args::RenderArgs;
use super::camera::CAMERA;
use super::image::IMAGE;
use super::input::INPUT;
use super::light::LIGHT;
use super::long::LONG;
use super::messages::MESSAGES;
use super::output::OUTPUT;
use super::setting::{Assignment, Setting};
use super::speed::SPEED;
use super::watch::WATCHED;

/// All settings, in the order of the help.
#[derive(Clone, Debug)]
pub struct Table {
    settings: Vec<&'static Setting>,
    /// The values that all settings have unless others are given.
    defaults: RenderArgs,
}

impl Default for Table {
    /// The settings of `dapple render`.
    fn default() -> Self {
        let groups: [&[Setting]; 9] =
            [OUTPUT, WATCHED, IMAGE, LIGHT, CAMERA, LONG, INPUT, SPEED, MESSAGES];
        Self::new(groups.into_iter().flatten().collect())
    }
}

impl Table {
    fn new(settings: Vec<&'static Setting>) -> Self {
        let mut defaults = RenderArgs::default();
        for (setting, word) in settings.iter().filter_map(|it| Some((it, it.default?))) {
            let value = setting.parse(word.as_ref()).expect("a test reads all defaults");
            value.apply(&mut defaults);
        }
        Self { settings, defaults }
    }

    /// All settings.
    pub fn settings(&self) -> impl Iterator<Item = &'static Setting> + '_ {
        self.settings.iter().copied()
    }

    /// The setting of a name.
    pub fn find(&self, name: &str) -> Option<&'static Setting> {
        self.settings().find(|setting| setting.name == name)
    }

    /// Whether the word that a setting is set to names a file.
    pub fn names_file(&self, name: &str, word: &str) -> bool {
        self.find(name).is_some_and(|setting| (setting.names_file)(word))
    }

    /// The values that all settings have unless others are given.
    pub fn defaults(&self) -> RenderArgs {
        self.defaults.clone()
    }

    /// Whether the command line's `typed` takes the place of a file's `other`: the two are the same
    /// setting, or they conflict, or `other` is of no use without what `typed` replaces.
    pub fn replaces(&self, typed: &Setting, other: &Setting) -> bool {
        let clashes = |it: &Setting| typed.excludes(it);
        let needed: Vec<_> = other.requires.iter().filter_map(|name| self.find(name)).collect();
        typed.name == other.name
            || clashes(other)
            || (!needed.is_empty() && needed.into_iter().all(clashes))
    }

    /// Whether a setting has another value than by default.
    fn is_set(&self, setting: &Setting, args: &RenderArgs) -> bool {
        (setting.write)(args) != (setting.write)(&self.defaults)
    }

    /// Whether one of the settings that a setting needs is set, if it needs any.
    pub(super) fn is_useful(&self, setting: &Setting, args: &RenderArgs) -> bool {
        Self::has_needed(setting, &|name| self.find(name).is_some_and(|it| self.is_set(it, args)))
    }

    /// Whether one of the settings that a setting needs is set, as `is_set` says of a name.
    fn has_needed(setting: &Setting, is_set: &dyn Fn(&str) -> bool) -> bool {
        setting.requires.is_empty() || setting.requires.iter().any(|name| is_set(name))
    }

    /// The first setting that is of no use, for it needs another one, which is not set. What is
    /// recorded nowhere is set if it was `typed`.
    pub fn find_useless(
        &self,
        args: &RenderArgs,
        typed: &[(&'static Setting, Assignment)],
    ) -> Option<&'static Setting> {
        let is_typed = |name: &str| typed.iter().any(|(it, _)| it.name == name);
        let is_set = |it: &Setting| self.is_set(it, args) || is_typed(it.name);
        let is_name_set = |name: &str| self.find(name).is_some_and(is_set);
        self.settings().find(|it| is_set(it) && !Self::has_needed(it, &is_name_set))
    }

    /// All recorded settings by their names, as TOML. What has no value, or is of no use, is left
    /// out.
    pub fn to_toml(&self, args: &RenderArgs) -> String {
        let recorded = self.settings().filter(|setting| setting.role.is_recorded());
        let useful = recorded.filter(|setting| self.is_useful(setting, args));
        let entries = useful.filter_map(|it| Some((it.name.to_owned(), (it.write)(args)?)));
        entries.collect::<TomlTable>().to_string()
    }

    /// Adds a setting at the end.
    #[cfg(test)]
    pub fn with(mut self, setting: &'static Setting) -> Self {
        self.settings.push(setting);
        Self::new(self.settings)
    }
}

#[cfg(test)]
mod tests {
    use super::super::setting::Group;
    use super::*;

    #[test]
    fn entries_are_complete_and_in_the_order_of_their_groups() {
        let table = Table::default();
        let order = |setting: &Setting| Group::ALL.iter().position(|it| *it == setting.group);
        assert!(table.settings.is_sorted_by_key(|setting| order(setting)));
        for setting in table.settings() {
            let name = setting.name;
            let same = table.settings().filter(|it| it.name == name || it.help == setting.help);
            assert_eq!(same.count(), 1, "--{name}");
            assert!(setting.help.len() > 5 && !setting.help.ends_with('.'), "--{name}");
            assert!(setting.default.is_none() || setting.otherwise.is_empty(), "--{name}");
            assert_eq!(setting.takes_value(), !setting.value.is_empty(), "--{name}");
            for other in setting.requires.iter().chain(setting.conflicts) {
                assert!(table.find(other).is_some() && *other != name, "--{name}: {other}");
            }
        }
    }

    #[test]
    fn each_entry_reads_its_default_and_what_it_writes() {
        let table = Table::default();
        let defaults = table.defaults();
        for setting in table.settings() {
            let name = setting.name;
            let mut args = table.defaults();
            let read = |word: &str| setting.parse(word.as_ref()).expect(name);
            read(setting.example).apply(&mut args);
            let written = (setting.write)(&args);
            assert_eq!(written.is_some(), setting.role.is_recorded(), "--{name}");
            assert!(
                !setting.role.is_recorded() || written != (setting.write)(&defaults),
                "the example of --{name} is its default"
            );
            if let Some(default) = setting.default {
                read(default).apply(&mut args);
                assert_eq!((setting.write)(&args), (setting.write)(&defaults), "--{name}");
            }
        }
    }

    #[test]
    fn what_is_typed_replaces_what_conflicts_and_what_that_needs() {
        let table = Table::default();
        let replaced = |typed: &str| {
            let typed = table.find(typed).expect(typed);
            let others = table.settings().filter(|it| it.name != typed.name);
            let replaced = others.filter(|it| table.replaces(typed, it)).map(|it| it.name);
            replaced.collect::<Vec<_>>()
        };
        assert_eq!(replaced("camera"), ["look-from", "look-at"]);
        assert_eq!(replaced("look-from"), ["camera"]);
        let sky = [
            "sky",
            "sun-elevation",
            "sun-azimuth",
            "sun-direction",
            "sun-diameter",
            "ground-albedo",
        ];
        assert_eq!(replaced("env"), sky);
        assert_eq!(replaced("sky"), ["env", "env-rotate", "env-repair"]);
        assert_eq!(replaced("sun-direction"), ["sun-elevation", "sun-azimuth"]);
        assert_eq!(replaced("sun-elevation"), ["sun-direction"]);
        assert_eq!(replaced("camera-model"), ["fov", "aperture", "focus"]);
        assert_eq!(replaced("fov"), ["camera-model"]);
        assert_eq!(replaced("spp"), [] as [&str; 0]);
    }
}
