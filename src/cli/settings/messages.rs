//! Settings: what a run prints.

use super::parse::{ProgressStyle, choice, choices, sample_id, switch, whole};
use super::setting::{Form, Group, Reader, Role, Setting, assign};

const SETTING: Setting = Setting::new(Group::Messages, Role::Run);
const SWITCH: Setting = Setting { form: Form::Switch, example: "true", ..SETTING };

/// The entries, in the order of the help.
pub static MESSAGES: &[Setting] = &[
    Setting {
        name: "dry-run",
        help: "Loads and builds, estimates memory and time, and stops",
        conflicts: &["debug-sample"],
        read: Reader::Text(|word| assign(switch(word), |args| &mut args.dry_run)),
        ..SWITCH
    },
    Setting {
        name: "print-config",
        help: "Prints all settings as the table [render] of a .toml scene, and stops",
        advanced: true,
        conflicts: &["debug-sample", "dry-run"],
        read: Reader::Text(|word| assign(switch(word), |args| &mut args.print_config)),
        ..SWITCH
    },
    Setting {
        name: "debug-sample",
        value: "x,y,s",
        example: "12,34,0",
        help: "Follows one sample alone and prints its path on standard output",
        advanced: true,
        read: Reader::Text(|word| assign(sample_id(word), |args| &mut args.debug_sample)),
        ..SETTING
    },
    Setting {
        name: "progress",
        value: "HOW",
        choices: Some(choices::<ProgressStyle>),
        default: Some("auto"),
        example: "plain",
        help: "How to report progress",
        advanced: true,
        read: Reader::Text(|word| assign(choice::<ProgressStyle>(word), |args| &mut args.progress)),
        ..SETTING
    },
    Setting {
        name: "log",
        value: "FILE",
        example: "render.log",
        help: "Adds what is printed to the end of a file, with times, and progress every 10 s",
        advanced: true,
        read: Reader::Path(|args| &mut args.log),
        ..SETTING
    },
    Setting {
        name: "metrics",
        value: "FILE",
        example: "dapple.prom",
        help: "Writes figures for Prometheus to a file, every 10 s",
        details: "The file is for the textfile collector of node_exporter, and is renamed into its \
                  place.",
        advanced: true,
        read: Reader::Path(|args| &mut args.metrics),
        ..SETTING
    },
    Setting {
        name: "quiet",
        short: Some('q'),
        help: "Prints nothing but errors",
        conflicts: &["verbose"],
        read: Reader::Text(|word| assign(switch(word), |args| &mut args.quiet)),
        ..SWITCH
    },
    Setting {
        name: "verbose",
        short: Some('v'),
        form: Form::Count,
        example: "1",
        help: "Prints what the scene holds, and how long reading and building take",
        read: Reader::Text(|word| assign(whole(word, 0..=u8::MAX), |args| &mut args.verbose)),
        ..SETTING
    },
    Setting {
        name: "json",
        help: "Prints a summary as one JSON object on standard output",
        read: Reader::Text(|word| assign(switch(word), |args| &mut args.json)),
        ..SWITCH
    },
];
