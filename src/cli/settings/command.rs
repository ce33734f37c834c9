//! The settings as flags of a command, and what was typed.

use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

use clap::builder::{OsStringValueParser, PossibleValuesParser, TypedValueParser, ValueParser};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command, FromArgMatches};

use super::args::RenderArgs;
use super::setting::{Assignment, Form, Setting};
use super::table::Table;

/// The name of the positional argument.
const SCENE: &str = "scene_file";

const LONG_ABOUT: &str = "\
Render a scene.

Each sample is a function of the scene and of the settings under Image, Light, Camera and Input \
alone: any structure, any number of threads and any instruction set give the same bytes. Only the \
layers `cost` and `denoised` may differ.";

const EXAMPLES: &str = "\
Examples:
  dapple render scenes/cornell.gltf -o cornell.exr --png cornell.png
  dapple render bunny.obj -o bunny.exr --env studio.hdr --look-from 0.1,0.2,0.4 --look-at 0,0.1,0
  dapple render kitchen.glb -o kitchen.exr --spp 512 --resolution 1920x1080 --accel bvh2

  dapple render scene.toml -o scene.exr
  dapple render --from scene.exr -o again.exr --spp 1024

A .toml scene places other files, with a camera and light. Its table [render] holds these settings
by their names. What is given on the command line takes precedence.";

/// What the words of a command line give.
#[derive(Clone)]
pub struct Typed {
    /// The scene's file.
    pub scene_file: Option<PathBuf>,
    /// The settings, each once.
    pub given: Vec<(&'static Setting, Assignment)>,
    /// The words that give them again.
    pub words: Vec<(&'static Setting, Vec<OsString>)>,
}

impl std::fmt::Debug for Typed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names: Vec<&str> = self.given.iter().map(|(setting, _)| setting.name).collect();
        write!(f, "{:?} {names:?}", self.scene_file)
    }
}

impl Table {
    /// Adds the flags, the scene and the help to a command.
    pub fn add_to(&self, command: Command) -> Command {
        let scene = Arg::new(SCENE)
            .value_name("SCENE")
            .help("The scene: .gltf, .glb, .obj, .ply or .toml; with --from it may be left out")
            .value_parser(clap::value_parser!(PathBuf))
            .required_unless_present("from");
        command
            .about("Render a scene")
            .long_about(LONG_ABOUT)
            .after_help(EXAMPLES)
            .arg(scene)
            .args(self.settings().map(make_flag))
    }

    /// What a command line gives, as clap has read it.
    pub fn read_matches(&self, matches: &ArgMatches) -> Typed {
        let given = self
            .settings()
            .filter(|setting| matches.value_source(setting.name) == Some(ValueSource::CommandLine));
        let given: Vec<&'static Setting> = given.collect();
        let words = given.iter().map(|setting| (*setting, words(setting, matches))).collect();
        let read = |setting| Some((setting, read_assignment(setting, matches)?));
        let scene_file = matches.get_one::<PathBuf>(SCENE).cloned();
        Typed { scene_file, given: given.into_iter().filter_map(read).collect(), words }
    }

    /// Reads words, of which a later flag overrides an earlier one.
    ///
    /// # Errors
    /// What clap says of words that it does not take, in its first paragraph: what follows is about
    /// a command that nobody has typed.
    pub fn read_words(
        &self,
        words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
    ) -> Result<Typed, String> {
        let command = self.add_to(Command::new("render"));
        let command = command.no_binary_name(true).args_override_self(true);
        let matches = command.try_get_matches_from(words).map_err(|error| {
            let text = error.to_string();
            let text = text.split("\n\n").next().unwrap_or_default();
            text.strip_prefix("error: ").unwrap_or(text).to_owned()
        })?;
        Ok(self.read_matches(&matches))
    }
}

impl Typed {
    /// Puts all that was typed into `args`.
    pub fn apply(&self, args: &mut RenderArgs) {
        for (_, value) in &self.given {
            value.apply(args);
        }
        if let Some(file) = &self.scene_file {
            args.scene_file.clone_from(file);
        }
    }
}

impl clap::Args for Typed {
    fn augment_args(command: Command) -> Command {
        Table::default().add_to(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Typed {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        Ok(Table::default().read_matches(matches))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// The flag of a setting.
fn make_flag(setting: &'static Setting) -> Arg {
    let mut arg = Arg::new(setting.name)
        .long(setting.name)
        .help(setting.summary())
        .help_heading(setting.group.heading())
        .hide_short_help(setting.advanced)
        .conflicts_with_all(setting.conflicts);
    if let Some(short) = setting.short {
        arg = arg.short(short);
    }
    if !setting.details.is_empty() {
        arg = arg.long_help(format!("{}\n\n{}", setting.summary(), setting.details));
    }
    if let Some(default) = setting.default {
        arg = arg.default_value(default);
    }
    match setting.form {
        Form::Switch => return arg.action(ArgAction::SetTrue),
        Form::Count => return arg.action(ArgAction::Count),
        Form::Number => arg = arg.allow_negative_numbers(true),
        Form::Numbers => arg = arg.allow_hyphen_values(true),
        Form::List => arg = arg.action(ArgAction::Append),
        Form::Optional(missing) => arg = arg.num_args(0..=1).default_missing_value(missing),
        Form::Word => {}
    }
    arg.value_name(setting.value).value_parser(make_parser(setting))
}

fn make_parser(setting: &'static Setting) -> ValueParser {
    let Some(choices) = setting.choices else {
        let parser = OsStringValueParser::new();
        return parser.try_map(|word| setting.parse(&word)).into();
    };
    let parser = PossibleValuesParser::new(choices());
    parser.try_map(|word| setting.parse(OsStr::new(&word))).into()
}

/// The value that was typed for a setting.
fn read_assignment(setting: &'static Setting, matches: &ArgMatches) -> Option<Assignment> {
    let read = |word: &str| setting.parse(OsStr::new(word)).ok();
    match setting.form {
        Form::Switch => read("true"),
        Form::Count => read(&matches.get_count(setting.name).to_string()),
        // A list may be typed in parts, each of which is a good one.
        Form::List => {
            let parts = matches.get_raw(setting.name)?.map(OsStr::to_string_lossy);
            read(&parts.collect::<Vec<_>>().join(","))
        }
        Form::Number | Form::Numbers | Form::Word | Form::Optional(_) => {
            matches.get_one(setting.name).cloned()
        }
    }
}

/// The words that give a setting again as it was typed.
fn words(setting: &Setting, matches: &ArgMatches) -> Vec<OsString> {
    let flag = || OsString::from(setting.flag());
    let of_value = |value: &OsStr| match setting.form {
        Form::Optional(missing) if value == missing => vec![flag()],
        _ if value.as_encoded_bytes().starts_with(b"-") => {
            let mut word = flag();
            word.push("=");
            word.push(value);
            vec![word]
        }
        _ => vec![flag(), value.to_owned()],
    };
    match setting.form {
        Form::Switch => vec![flag()],
        Form::Count => (0..matches.get_count(setting.name)).map(|_| flag()).collect(),
        _ => matches.get_raw(setting.name).into_iter().flatten().flat_map(of_value).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_back_as_they_were_typed() {
        let typed = "a.gltf -vv --look-from=-1,2,3 -o out.exr --aov albedo --aov depth,normal \
                     --resume --checkpoint c --transparent --seed 7";
        let table = Table::default();
        let read = |words: Vec<OsString>| table.read_words(words).expect("good words");
        let first = read(typed.split_whitespace().map(OsString::from).collect());
        let words = |typed: &Typed| -> Vec<OsString> {
            typed.words.iter().flat_map(|(_, words)| words.clone()).collect()
        };
        let again = words(&first);
        let text = again.join(OsStr::new(" ")).into_string().expect("UTF-8");
        let expected = "--output out.exr --aov albedo --aov depth,normal --seed 7 --transparent \
                        --look-from=-1,2,3 --checkpoint c --resume --verbose --verbose";
        assert_eq!(text, expected);
        let scene = OsString::from("a.gltf");
        assert_eq!(words(&read(std::iter::once(scene).chain(again.clone()).collect())), again);
    }
}
