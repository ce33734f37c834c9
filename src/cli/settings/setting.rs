//! One entry of the table of settings.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::sync::Arc;

use clap::builder::PossibleValue;
use toml::Value;

use super::args::RenderArgs;

/// A setting of `dapple render`: its flag, its key in TOML, its documentation and its rules.
///
/// Everything else is derived from this: the flag that clap reads, its help, completions and manual
/// page; the key in the table `[render]` of a .toml scene; the lines of `--print-config` and of a
/// picture's header; what `--from` repeats; and the errors about settings that need or exclude
/// another.
#[derive(Debug)]
pub struct Setting {
    /// The long flag without its dashes, which is also the key in TOML.
    pub name: &'static str,
    /// The short flag.
    pub short: Option<char>,
    /// The heading in the help.
    pub group: Group,
    /// What it decides.
    pub role: Role,
    /// What a value looks like.
    pub form: Form,
    /// What stands for a value in the help.
    pub value: &'static str,
    /// The values that there are, where the help lists them.
    pub choices: Option<fn() -> Vec<PossibleValue>>,
    /// The value that it has unless another is given.
    pub default: Option<&'static str>,
    /// What happens without a value, in words; for settings that have no `default`.
    pub otherwise: &'static str,
    /// A value for the documentation; the tests also try it.
    pub example: &'static str,
    /// One line of help.
    pub help: &'static str,
    /// Paragraphs that only `--help` prints.
    pub details: &'static str,
    /// Whether `-h` leaves it out.
    pub advanced: bool,
    /// The settings of which it needs one: without any, it is of no use.
    pub requires: &'static [&'static str],
    /// The settings that cannot be given with it. It is enough that one of two names the other.
    pub conflicts: &'static [&'static str],
    /// Whether a value names a file, which is then looked for beside the scene or picture that says
    /// so; for settings that are read from files.
    pub names_file: fn(&str) -> bool,
    /// Reads a value.
    pub read: Reader,
    /// Writes its value as TOML; `None` where it has none.
    pub write: fn(&RenderArgs) -> Option<Value>,
}

/// The headings of the help, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Files to write, and how a PNG looks.
    Output,
    /// Pixels and samples.
    Image,
    /// How light is followed, and where it comes from.
    Light,
    /// From where the scene is seen, and for how long.
    Camera,
    /// Renders in parts, that are stopped and go on, and that end when they are good enough.
    Long,
    /// What is read.
    Input,
    /// What a render uses of the machine.
    Speed,
    /// What a run prints.
    Messages,
}

impl Group {
    /// All, in the order of the help.
    pub const ALL: [Self; 8] = [
        Self::Output,
        Self::Image,
        Self::Light,
        Self::Camera,
        Self::Long,
        Self::Input,
        Self::Speed,
        Self::Messages,
    ];

    /// The heading.
    pub const fn heading(self) -> &'static str {
        match self {
            Self::Output => "Output",
            Self::Image => "Image",
            Self::Light => "Light",
            Self::Camera => "Camera",
            Self::Long => "Long renders",
            Self::Input => "Input",
            Self::Speed => "Speed",
            Self::Messages => "Messages",
        }
    }
}

/// What a setting decides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// What is in the scene, its surroundings included: the scene's digest depends on it.
    Scene,
    /// How the scene is seen: the samples of the picture depend on it.
    Picture,
    /// How the picture is computed, stored or shown: no sample depends on it.
    Process,
    /// What this one run reads, writes and prints. It is given on the command line alone and is
    /// recorded nowhere.
    Run,
}

impl Role {
    /// Whether settings of this role, with the scene's files, identify a picture.
    pub fn identifies_picture(self) -> bool {
        matches!(self, Self::Scene | Self::Picture)
    }

    /// Whether files may hold settings of this role.
    pub fn is_recorded(self) -> bool {
        self != Self::Run
    }
}

/// What a value looks like on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// None: the flag is given or is not.
    Switch,
    /// None: it counts how often the flag is given.
    Count,
    /// A number, which may be negative.
    Number,
    /// Numbers between commas, the first of which may be negative.
    Numbers,
    /// Names between commas.
    List,
    /// Any other word.
    Word,
    /// A word that may be left out; what stands for it then.
    Optional(&'static str),
}

/// How a setting reads its value.
#[derive(Debug)]
pub enum Reader {
    /// From text.
    Text(fn(&str) -> Result<Assignment, String>),
    /// A path as it is, for the field that takes it.
    Path(fn(&mut RenderArgs) -> &mut Option<PathBuf>),
}

/// A value that has been read and waits to be put where it belongs.
#[derive(Clone)]
pub struct Assignment(Arc<dyn Fn(&mut RenderArgs) + Send + Sync>);

impl Assignment {
    /// Puts the value where it belongs.
    pub fn apply(&self, args: &mut RenderArgs) {
        (self.0)(args);
    }
}

/// Assigns a value to a field, if it could be read.
///
/// # Errors
/// Those of `parsed`.
pub fn assign<T, F>(
    parsed: Result<T, String>,
    field: fn(&mut RenderArgs) -> &mut F,
) -> Result<Assignment, String>
where
    T: Clone + Send + Sync + 'static,
    F: From<T> + 'static,
{
    let value = parsed?;
    Ok(Assignment(Arc::new(move |args| *field(args) = value.clone().into())))
}

impl Setting {
    /// An entry to start from; `name`, `help`, `read` and `write` are still to be said.
    pub const fn new(group: Group, role: Role) -> Self {
        Self {
            name: "",
            short: None,
            group,
            role,
            form: Form::Word,
            value: "",
            choices: None,
            default: None,
            otherwise: "",
            example: "",
            help: "",
            details: "",
            advanced: false,
            requires: &[],
            conflicts: &[],
            names_file: |_| false,
            read: Reader::Text(|_| Err("cannot be read".to_owned())),
            write: |_| None,
        }
    }

    /// The flag, as in `--spp`.
    pub fn flag(&self) -> String {
        format!("--{}", self.name)
    }

    /// The flag with what stands for its value, as in `--spp <N>`.
    pub fn usage(&self) -> String {
        if self.value.is_empty() {
            self.flag()
        } else {
            format!("--{} <{}>", self.name, self.value)
        }
    }

    /// Whether the two cannot be given together.
    pub fn excludes(&self, other: &Setting) -> bool {
        self.conflicts.contains(&other.name) || other.conflicts.contains(&self.name)
    }

    /// Whether the flag is followed by a value.
    pub fn takes_value(&self) -> bool {
        !matches!(self.form, Form::Switch | Form::Count)
    }

    /// Reads a value; that of a switch is `true` or `false`, that of a count a number.
    ///
    /// # Errors
    /// What is wrong with the word.
    pub fn parse(&self, word: &OsStr) -> Result<Assignment, String> {
        match self.read {
            Reader::Path(field) => assign(Ok(PathBuf::from(word)), field),
            Reader::Text(read) => {
                let text = word.to_str().ok_or_else(|| "is not UTF-8".to_owned())?;
                if let Some(choices) = self.choices
                    && !choices().iter().any(|choice| choice.matches(text, false))
                {
                    let names: Vec<String> =
                        choices().iter().map(|choice| choice.get_name().to_owned()).collect();
                    return Err(format!("expected one of {}", names.join(", ")));
                }
                read(text)
            }
        }
    }

    /// The help's line, with what happens where nothing is given.
    pub fn summary(&self) -> String {
        match self.otherwise {
            "" => self.help.to_owned(),
            otherwise => format!("{} [default: {otherwise}]", self.help),
        }
    }
}
