//! Settings: renders in parts, that are stopped and go on, and that end when they are good enough.

use super::parse::{choice, choices, positive, switch, whole};
use super::parse_long::{Resume, duration, every, samples, share};
use super::setting::{Form, Group, Reader, Role, Setting, assign};
use super::to_toml::ToToml;

const RUN: Setting = Setting { advanced: true, ..Setting::new(Group::Long, Role::Run) };
const ENOUGH: Setting = Setting { form: Form::Number, ..Setting::new(Group::Long, Role::Picture) };

/// The entries, in the order of the help.
pub static LONG: &[Setting] = &[
    Setting {
        name: "samples",
        value: "A..B",
        example: "64..128",
        help: "Takes only samples A, a multiple of 16, to B of each pixel, without B itself",
        details: "With --partial, the samples go to a file, and `dapple merge` adds up such files: \
                  the picture has the bytes of one render. B may be beyond --spp: so a finished \
                  picture gets more samples.",
        conflicts: &["part"],
        read: Reader::Text(|word| assign(samples(word), |args| &mut args.samples)),
        ..RUN
    },
    Setting {
        name: "part",
        value: "I/N",
        example: "3/64",
        help: "Takes only the samples of part I, from 0, of N nearly equal ones",
        details: "They are cut at multiples of 16 samples: --spp 64 makes 4 parts at most.",
        read: Reader::Text(|word| assign(share(word), |args| &mut args.part)),
        ..RUN
    },
    Setting {
        name: "partial",
        value: "FILE",
        example: "a.part",
        help: "Where to write the sums of samples, for `dapple merge`",
        read: Reader::Path(|args| &mut args.partial),
        ..RUN
    },
    Setting {
        name: "checkpoint",
        form: Form::Optional(""),
        value: "FILE",
        example: "a.checkpoint",
        help: "Saves the samples now and then, so that a render that is stopped can go on; without \
               FILE, beside the output",
        details: "The file goes away once the picture is written.",
        read: Reader::Path(|args| &mut args.checkpoint),
        advanced: false,
        ..RUN
    },
    Setting {
        name: "resume",
        form: Form::Optional("must"),
        value: "HOW",
        choices: Some(choices::<Resume>),
        example: "auto",
        help: "Goes on from the checkpoint; auto: if it is there",
        details: "With auto, a picture or part that is there already, whole and of the same scene \
                  and settings, is left as it is.",
        read: Reader::Text(|word| assign(choice::<Resume>(word), |args| &mut args.resume)),
        advanced: false,
        ..RUN
    },
    Setting {
        name: "every",
        value: "TIME|Nspp",
        otherwise: "5m for a checkpoint, 5s for a preview",
        example: "100spp",
        help: "How often the checkpoint, and a preview, is written: seconds, 5m, 100spp",
        requires: &["checkpoint", "resume", "preview", "show"],
        read: Reader::Text(|word| assign(every(word), |args| &mut args.every)),
        ..RUN
    },
    Setting {
        name: "stop-after",
        value: "TIME",
        example: "55m",
        help: "Stops after such a time, saves, and ends with exit code 75: again",
        read: Reader::Text(|word| assign(duration(word), |args| &mut args.stop_after)),
        ..RUN
    },
    Setting {
        name: "time-limit",
        value: "TIME",
        example: "600s",
        help: "Ends after such a time, with the samples that there are by then",
        role: Role::Process,
        advanced: false,
        read: Reader::Text(|word| assign(duration(word), |args| &mut args.time_limit)),
        write: |args| args.time_limit.to_toml(),
        ..RUN
    },
    Setting {
        name: "noise",
        value: "ERROR",
        example: "0.02",
        help: "Samples until the relative error of every part of the picture is below ERROR, in \
               place of --spp",
        details: "At doublings of their samples, tiles of 16x16 pixels stop once their error, and \
                  that of their neighbours, is below it. It is told by how far pixels have moved \
                  since they had half as many. The layer `samples` shows where they went.",
        conflicts: &["samples", "part", "shutter"],
        read: Reader::Text(|word| assign(positive(word), |args| &mut args.noise)),
        write: |args| args.noise.to_toml(),
        ..ENOUGH
    },
    Setting {
        name: "min-spp",
        value: "N",
        otherwise: "64",
        example: "128",
        help: "Samples that every pixel takes under --noise",
        advanced: true,
        requires: &["noise"],
        read: Reader::Text(|word| {
            assign(whole::<u64>(word, 1..=1 << 32), |args| &mut args.min_spp)
        }),
        write: |args| args.min_spp.to_toml(),
        ..ENOUGH
    },
    Setting {
        name: "max-spp",
        value: "N",
        otherwise: "16384",
        example: "4096",
        help: "Samples that no pixel exceeds under --noise",
        advanced: true,
        requires: &["noise"],
        read: Reader::Text(|word| {
            assign(whole::<u64>(word, 1..=1 << 32), |args| &mut args.max_spp)
        }),
        write: |args| args.max_spp.to_toml(),
        ..ENOUGH
    },
    Setting {
        name: "fail-incomplete",
        form: Form::Switch,
        example: "true",
        help: "Ends with exit code 5 where --noise, or the samples under --time-limit, were not \
               reached",
        requires: &["noise", "time-limit"],
        read: Reader::Text(|word| assign(switch(word), |args| &mut args.fail_incomplete)),
        ..RUN
    },
    Setting {
        name: "reproducible",
        form: Form::Switch,
        example: "true",
        help: "Leaves out of the EXR what differs between runs: time, command, layer `cost`",
        role: Role::Process,
        read: Reader::Text(|word| assign(switch(word), |args| &mut args.reproducible)),
        write: |args| args.reproducible.to_toml(),
        ..RUN
    },
];
