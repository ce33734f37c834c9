//! Settings: where a render is seen while it grows.

use super::parse::{choice, choices};
use super::parse_watch::{Show, TevAddress};
use super::setting::{Form, Group, Reader, Role, Setting, assign};

const WATCH: Setting = Setting::new(Group::Output, Role::Run);

/// The entries, in the order of the help.
pub static WATCHED: &[Setting] = &[
    Setting {
        name: "preview",
        value: "FILE",
        example: "preview.png",
        help: "Where to write a PNG of what there is so far, now and then; see --every",
        read: Reader::Path(|args| &mut args.preview),
        ..WATCH
    },
    Setting {
        name: "show",
        form: Form::Optional("auto"),
        value: "HOW",
        choices: Some(choices::<Show>),
        example: "blocks",
        help: "Shows the picture in the terminal, on standard error",
        details: "While it renders, too, now and then; see --every. Within tmux, and wherever it \
                  is not known that the terminal shows pictures, it is made of half blocks. If \
                  standard error is no terminal, only what is asked for by name is shown.",
        read: Reader::Text(|word| assign(choice::<Show>(word), |args| &mut args.show)),
        ..WATCH
    },
    Setting {
        name: "tev",
        form: Form::Optional(TevAddress::DEFAULT),
        value: "HOST:PORT",
        example: "127.0.0.1:14158",
        help: "Shows the picture in the viewer tev, every second; alone: on this machine",
        details: "tev may be started later, end and come back: the render never waits for it.",
        advanced: true,
        read: Reader::Text(|word| assign(word.parse::<TevAddress>(), |args| &mut args.tev)),
        ..WATCH
    },
];
