//! Settings: files to write, and how a PNG looks.

use super::parse::{finite, from_str, list, switch};
use super::setting::{Form, Group, Reader, Role, Setting, assign};
use super::to_toml::ToToml;
use crate::film::tonemap::Tonemap;
use crate::render::Aov;

const FILE: Setting = Setting::new(Group::Output, Role::Run);
const LOOK: Setting = Setting::new(Group::Output, Role::Process);

/// The entries, in the order of the help.
pub static OUTPUT: &[Setting] = &[
    Setting {
        name: "output",
        short: Some('o'),
        value: "FILE",
        example: "out.exr",
        help: "Where to write the picture: an EXR with all its layers",
        read: Reader::Path(|args| &mut args.output),
        ..FILE
    },
    Setting {
        name: "png",
        value: "FILE",
        example: "out.png",
        help: "Where to write a PNG to look at",
        read: Reader::Path(|args| &mut args.png),
        ..FILE
    },
    Setting {
        name: "tonemap",
        value: "CURVE",
        default: Some("agx"),
        example: "srgb",
        help: "How the PNG shows light: agx or srgb",
        read: Reader::Text(|word| assign(from_str::<Tonemap>(word), |args| &mut args.tonemap)),
        write: |args| args.tonemap.to_toml(),
        ..LOOK
    },
    Setting {
        name: "exposure",
        form: Form::Number,
        value: "STOPS",
        default: Some("0"),
        example: "-1.5",
        help: "Brightens the PNG by so many stops; the EXR is left alone",
        read: Reader::Text(|word| assign(finite(word), |args| &mut args.exposure)),
        write: |args| args.exposure.to_toml(),
        ..LOOK
    },
    Setting {
        name: "aov",
        form: Form::List,
        value: "LAYER,…",
        default: Some("albedo,normal,position,depth,variance,samples,cost"),
        example: "albedo,depth",
        help: "Layers of the EXR besides its colours",
        advanced: true,
        read: Reader::Text(|word| assign(list::<Aov>(word), |args| &mut args.aov)),
        write: |args| args.aov.to_toml(),
        ..LOOK
    },
    Setting {
        name: "denoise",
        form: Form::Switch,
        example: "true",
        help: "Adds a layer `denoised`, which the PNG then shows, by Open Image Denoise",
        details: "Its library is looked for when the render starts: what DAPPLE_OIDN names, the \
                  library or a folder that holds it; or else where the system has its libraries; \
                  or else in the Python package that `pip install pyoidn` installs. All other \
                  layers have the same bytes as without. Those of this one depend on the \
                  library's version and on the processor.",
        read: Reader::Text(|word| assign(switch(word), |args| &mut args.denoise)),
        write: |args| args.denoise.to_toml(),
        ..LOOK
    },
];
