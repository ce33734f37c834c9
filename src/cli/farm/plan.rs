//! What a farm is to do.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::Path;

use crate::cli::error::CliError;
use crate::cli::flags::whole;
use crate::cli::settings::frames::{Frames, find_number};
use crate::cli::settings::parse_long::Share;
use crate::cli::settings::pose::require_numbers;
use crate::cli::settings::{self, RenderArgs, Table, Typed};
use crate::cli::text::format_count;
use crate::files::why_unread;
use crate::sampling::BLOCK;

/// How a picture is cut into tasks.
#[derive(clap::Args, Debug)]
#[command(next_help_heading = "Farm")]
pub struct Cut {
    /// Cuts each picture into so many parts, a task each
    #[arg(long, value_name = "N", default_value = "1",
          value_parser = whole(1..=1_000_000_u64))]
    parts: u64,
    /// The folder of parts, checkpoints and logs, which all machines see [default: named after the
    /// output]
    #[arg(long, value_name = "DIR")]
    work: Option<OsString>,
    /// How the machines call dapple
    #[arg(long, value_name = "PATH", default_value = "dapple")]
    dapple: OsString,
}

/// What is to be done: tasks by an index from 0 and, if there are parts, a merge for each picture.
#[derive(Debug)]
pub struct Plan {
    /// What it may be called: the output's name without what follows a point.
    pub name: String,
    /// The folder of parts, checkpoints and logs.
    pub work: String,
    /// The frames; none: one picture.
    pub frames: Option<Frames>,
    /// The parts of each picture, at least 1.
    pub parts: u64,
    /// How machines call dapple.
    pub dapple: String,
    /// The scene, and the settings as they were typed, without outputs and frames.
    pub words: Vec<String>,
    /// Flags of outputs and what they name.
    pub outputs: Vec<(&'static str, String)>,
    /// Settings that were typed, by name.
    pub typed: Vec<&'static str>,
}

/// What the farm decides itself, and what prints instead of rendering.
const REFUSED: [(&str, &str); 11] = [
    ("part", "--parts cuts the picture"),
    ("samples", "--parts cuts the picture"),
    ("partial", "parts are in the folder that --work names"),
    ("checkpoint", "checkpoints are in the folder that --work names"),
    ("resume", "each task goes on from its checkpoint, if there is one"),
    ("stop-after", "the farm says when a task ends"),
    ("preview", "all tasks would write the same file"),
    ("metrics", "all tasks would write the same file"),
    ("debug-sample", "nothing is rendered here"),
    ("dry-run", "nothing is rendered here"),
    ("print-config", "nothing is rendered here"),
];

/// What leaves a part with samples of its own choice.
const REFUSED_IN_PARTS: [(&str, &str); 2] = [
    ("noise", "parts share a number of samples that is known before"),
    ("time-limit", "the parts would not add up"),
];

impl Plan {
    /// Works out what is to be done, and makes sure that tasks will be able to begin.
    ///
    /// # Errors
    /// [`CliError::Usage`] for flags that make no sense for a farm; [`CliError::Input`] if there
    /// is no scene; what is wrong with the settings.
    pub fn new(typed: &Typed, cut: &Cut) -> Result<Self, CliError> {
        let names: Vec<&'static str> = typed.given.iter().map(|(it, _)| it.name).collect();
        let in_parts = REFUSED_IN_PARTS.iter().filter(|_| cut.parts > 1);
        if let Some((name, why)) = REFUSED.iter().chain(in_parts).find(|(it, _)| names.contains(it))
        {
            return Err(CliError::Usage(format!("--{name} has no place here: {why}")));
        }
        let args = settings::resolve(&with_checkpoint(typed))?.args;
        require_numbers(&args)?;
        check(&args, cut.parts)?;
        let output = args.output.as_deref().or(args.png.as_deref()).unwrap_or(Path::new(""));
        let name = name(output)?;
        let beside = || output.with_file_name(format!("{name}.parts")).into_os_string();
        let scene = typed.scene_file.iter().map(|file| path(file.as_os_str()));
        let rest =
            typed.words.iter().filter(|(it, _)| !["output", "png", "frames"].contains(&it.name));
        let rest = rest.flat_map(|(_, words)| words).map(|word| text(word));
        let outputs = [("-o", &args.output), ("--png", &args.png)];
        let outputs = outputs.into_iter().filter_map(|(flag, file)| Some((flag, file.as_ref()?)));
        let outputs = outputs.map(|(flag, file)| Ok((flag, path(file.as_os_str())?)));
        Ok(Self {
            work: path(&cut.work.clone().unwrap_or_else(beside))?,
            name,
            frames: args.frames,
            parts: cut.parts,
            dapple: text(&cut.dapple)?,
            words: scene.chain(rest).collect::<Result<_, CliError>>()?,
            outputs: outputs.collect::<Result<_, CliError>>()?,
            typed: names,
        })
    }

    /// How many pictures there are.
    pub fn pictures(&self) -> u64 {
        self.frames.map_or(1, Frames::count)
    }

    /// How many tasks there are.
    pub fn tasks(&self) -> u64 {
        self.pictures() * self.parts
    }

    /// How many merges there are: as many as pictures, or none.
    pub fn merges(&self) -> u64 {
        if self.parts > 1 { self.pictures() } else { 0 }
    }

    /// What there is to do, in words.
    pub fn describe(&self) -> String {
        let outputs: Vec<&str> = self.outputs.iter().map(|(_, file)| file.as_str()).collect();
        let frames = |count| format!(", {}", format_count(count, "frame", "frames"));
        let pictures = self.frames.map(|it| frames(it.count()));
        let parts = (self.parts > 1).then(|| format!(", in {} parts", self.parts));
        let tasks = format_count(self.tasks(), "task", "tasks");
        let (pictures, parts) = (pictures.unwrap_or_default(), parts.unwrap_or_default());
        format!("{}{pictures}{parts}: {tasks}", outputs.join(" and "))
    }
}

/// The same with a checkpoint, which each task has.
fn with_checkpoint(typed: &Typed) -> Typed {
    let mut typed = typed.clone();
    let setting = Table::default().find("checkpoint");
    typed.given.extend(setting.and_then(|it| Some((it, it.parse("".as_ref()).ok()?))));
    typed
}

/// Makes sure that there is a scene, something to write, and enough samples for all parts.
fn check(args: &RenderArgs, parts: u64) -> Result<(), CliError> {
    if args.output.is_none() && args.png.is_none() {
        return Err(CliError::Usage("nowhere to put the picture: give -o FILE.exr".to_owned()));
    }
    let most = Share::most(args.spp);
    if parts > most {
        let spp = args.spp;
        let message =
            format!("--parts {parts}: {spp} samples make {most} parts of {BLOCK} at most");
        return Err(CliError::Usage(message));
    }
    fs::metadata(&args.scene_file).map(drop).map_err(|error| {
        CliError::Input(format!("{}: {}", args.scene_file.display(), why_unread(&error)))
    })
}

/// The name of a file without what follows a point, nor the place of a number.
fn name(output: &Path) -> Result<String, CliError> {
    let name = text(output.file_stem().unwrap_or_default())?;
    let name = find_number(&name).map_or(&*name, |numbered| numbered.before);
    let name = name.trim_end_matches(['.', '_', '-']);
    Ok(if name.is_empty() { "dapple".to_owned() } else { name.to_owned() })
}

/// A word that can stand in a script.
fn text(word: &OsStr) -> Result<String, CliError> {
    match word.to_str() {
        Some(text) if !text.contains(char::is_control) => Ok(text.to_owned()),
        _ => {
            let message = "cannot stand in a script: it is not UTF-8 or has control characters";
            Err(CliError::Usage(format!("`{}` {message}", word.to_string_lossy().escape_debug())))
        }
    }
}

/// A path that no one takes for a flag.
fn path(word: &OsStr) -> Result<String, CliError> {
    let path = text(word)?;
    Ok(if path.starts_with('-') { format!("./{path}") } else { path })
}

#[cfg(test)]
mod tests {
    use clap::{Args, FromArgMatches};

    use super::*;

    /// What is to be done by such words after the scene.
    fn plan(words: &str) -> Result<Plan, CliError> {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/furnace.gltf");
        let scene = scene.to_str().expect("UTF-8");
        let command = Cut::augment_args(Typed::augment_args(clap::Command::new("farm")));
        let words = ["farm", scene].into_iter().chain(words.split_whitespace());
        let matches = command.try_get_matches_from(words).expect("known flags");
        let typed = Typed::from_arg_matches(&matches).expect("read");
        Plan::new(&typed, &Cut::from_arg_matches(&matches).expect("read"))
    }

    #[test]
    fn what_was_typed_is_what_tasks_are_told() {
        let plan =
            plan("-o a/out.v2.##.exr --png b#.png --seed 7 --frames 3..5 --fps 25 --parts 2");
        let plan = plan.expect("good words");
        assert_eq!(plan.words[1..], ["--seed", "7", "--fps", "25"]);
        assert_eq!((plan.name.as_str(), plan.work.as_str()), ("out.v2", "a/out.v2.parts"));
        assert_eq!((plan.tasks(), plan.merges(), plan.pictures()), (6, 3, 3));
    }

    #[test]
    fn the_farm_has_the_say_on_parts_and_checkpoints() {
        let refused = |words: &str| match plan(words) {
            Err(error) => (error.exit_code() == 2).then(|| error.to_string()),
            Ok(_) => None,
        };
        for (flag, _) in REFUSED {
            let value = match flag {
                "part" => " 0/2",
                "samples" => " 0..16",
                "stop-after" => " 5m",
                "debug-sample" => " 0,0,0",
                "partial" => " a.part",
                "preview" => " a.png",
                "metrics" => " a.prom",
                _ => "",
            };
            let told = refused(&format!("-o a.exr --{flag}{value}")).expect(flag);
            assert!(told.starts_with(&format!("--{flag} has no place here")), "{told}");
        }
        for (flag, _) in REFUSED_IN_PARTS {
            assert!(refused(&format!("-o a.exr --{flag} 1 --parts 2")).is_some(), "{flag}");
            assert!(refused(&format!("-o a.exr --{flag} 1")).is_none(), "{flag}");
        }
        assert!(refused("").is_some_and(|told| told.contains("-o")));
        assert!(refused("-o a.exr --spp 32 --parts 3").is_some_and(|told| told.contains("make 2")));
        assert!(refused("-o a.exr --every 30s").is_none(), "each task has a checkpoint");
        assert!(refused("-o a\u{7}.exr").is_some_and(|told| told.contains("a script")));
        assert!(refused("-o a.exr --frames 1..2").is_some_and(|told| told.contains("####")));
    }

    #[test]
    fn names_end_before_points_and_numbers() {
        let named = |path: &str| name(Path::new(path)).expect("UTF-8");
        for (path, expected) in [
            ("a/out.exr", "out"),
            ("out.####.exr", "out"),
            ("shot_####.exr", "shot"),
            ("####.exr", "dapple"),
        ] {
            assert_eq!(named(path), expected);
        }
    }
}
