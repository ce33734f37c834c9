//! Settings: what is read.

use super::frames::frames;
use super::parse::{
    MissingTextureArg, MtlTransparencyArg, choice, choices, finite, from_str, positive, switch,
};
use super::setting::{Form, Group, Reader, Role, Setting, assign};
use super::to_toml::ToToml;

const SCENE: Setting = Setting::new(Group::Input, Role::Scene);

/// The entries, in the order of the help.
pub static INPUT: &[Setting] = &[
    Setting {
        name: "from",
        role: Role::Run,
        value: "FILE.exr",
        example: "old.exr",
        help: "Repeats the run that made a picture, except for what is given here",
        read: Reader::Path(|args| &mut args.from),
        ..SCENE
    },
    Setting {
        name: "scene",
        value: "NAME|N",
        otherwise: "the file's default",
        example: "0",
        help: "Which of a glTF file's scenes, by name or number from 0",
        advanced: true,
        read: Reader::Text(|word| assign(from_str::<String>(word), |args| &mut args.scene)),
        write: |args| args.scene.to_toml(),
        ..SCENE
    },
    Setting {
        name: "variant",
        value: "NAME|N",
        example: "midnight",
        help: "A variant of a glTF file's materials, by name or number from 0",
        advanced: true,
        read: Reader::Text(|word| assign(from_str::<String>(word), |args| &mut args.variant)),
        write: |args| args.variant.to_toml(),
        ..SCENE
    },
    Setting {
        name: "animation",
        value: "NAME|N",
        otherwise: "the first",
        example: "walk",
        help: "Which of a glTF file's animations --time poses, by name or number from 0",
        advanced: true,
        requires: &["time"],
        read: Reader::Text(|word| assign(from_str::<String>(word), |args| &mut args.animation)),
        write: |args| args.animation.to_toml(),
        ..SCENE
    },
    Setting {
        name: "time",
        form: Form::Number,
        value: "SECONDS",
        otherwise: "at rest",
        example: "1.25",
        help: "The time at which animations are posed, in seconds",
        advanced: true,
        read: Reader::Text(|word| assign(finite(word), |args| &mut args.time)),
        write: |args| args.time.to_toml(),
        ..SCENE
    },
    Setting {
        name: "frames",
        role: Role::Run,
        value: "A..B",
        example: "1..240",
        help: "Renders the frames from A to B, both included, to out.####.exr",
        details: "Frame N is posed at N / --fps seconds, as by --time. The last row of # in the \
                  names after -o, --png, --partial and --checkpoint becomes its number. With \
                  --resume auto, frames that are there already are left out.",
        conflicts: &["debug-sample", "print-config", "dry-run"],
        read: Reader::Text(|word| assign(frames(word), |args| &mut args.frames)),
        ..SCENE
    },
    Setting {
        name: "fps",
        role: Role::Run,
        form: Form::Number,
        value: "F",
        otherwise: "24",
        example: "25",
        help: "Frames a second, for --frames",
        advanced: true,
        read: Reader::Text(|word| assign(positive(word), |args| &mut args.fps)),
        ..SCENE
    },
    Setting {
        name: "strict",
        role: Role::Process,
        form: Form::Switch,
        example: "true",
        help: "Refuses a scene that asks for anything that is not honoured",
        read: Reader::Text(|word| assign(switch(word), |args| &mut args.strict)),
        write: |args| args.strict.to_toml(),
        ..SCENE
    },
    Setting {
        name: "missing-texture",
        value: "COLOUR",
        choices: Some(choices::<MissingTextureArg>),
        otherwise: "an error",
        example: "magenta",
        help: "Goes on without textures that cannot be read",
        read: Reader::Text(|word| {
            assign(choice::<MissingTextureArg>(word), |args| &mut args.missing_texture)
        }),
        write: |args| args.missing_texture.to_toml(),
        ..SCENE
    },
    Setting {
        name: "mtl-transparency",
        value: "HOW",
        choices: Some(choices::<MtlTransparencyArg>),
        otherwise: "as file, but not so that nothing is seen",
        example: "d",
        help: "What transparency means in an OBJ file's materials, on which writers do not agree",
        details: "d is an opacity, and Tr a transparency, 1 - d; where both are given d counts. \
                  Old exporters wrote Tr 1 for what is opaque: a file of which all would be \
                  invisible is taken as opaque.",
        advanced: true,
        read: Reader::Text(|word| {
            assign(choice::<MtlTransparencyArg>(word), |args| &mut args.mtl_transparency)
        }),
        write: |args| args.mtl_transparency.to_toml(),
        ..SCENE
    },
];
