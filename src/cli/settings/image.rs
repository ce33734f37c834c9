//! Settings: pixels and samples.

use super::parse::{TextureLod, choice, choices, from_str, resolution, switch, whole, window};
use super::setting::{Form, Group, Reader, Role, Setting, assign};
use super::to_toml::ToToml;
use crate::film::PixelFilter;
use crate::sampling::SamplePattern;

const SETTING: Setting = Setting::new(Group::Image, Role::Picture);

/// The entries, in the order of the help.
pub static IMAGE: &[Setting] = &[
    Setting {
        name: "resolution",
        value: "WxH",
        otherwise: "1280 wide, with the camera's aspect",
        example: "640x480",
        help: "Width and height in pixels",
        read: Reader::Text(|word| assign(resolution(word), |args| &mut args.resolution)),
        write: |args| args.resolution.to_toml(),
        ..SETTING
    },
    Setting {
        name: "spp",
        form: Form::Number,
        value: "N",
        default: Some("64"),
        example: "1024",
        help: "Samples per pixel",
        read: Reader::Text(|word| assign(whole::<u64>(word, 1..=1 << 32), |args| &mut args.spp)),
        write: |args| args.spp.to_toml(),
        ..SETTING
    },
    Setting {
        name: "seed",
        form: Form::Number,
        value: "N",
        default: Some("0"),
        example: "18446744073709551615",
        help: "Another number, another noise",
        read: Reader::Text(|word| assign(whole(word, 0..=u64::MAX), |args| &mut args.seed)),
        write: |args| args.seed.to_toml(),
        ..SETTING
    },
    Setting {
        name: "sampler",
        value: "PATTERN",
        default: Some("lattice"),
        example: "independent",
        help: "How samples are placed: lattice (least noise), sobol, or independent (for \
               statistics of the noise)",
        advanced: true,
        read: Reader::Text(|word| {
            assign(from_str::<SamplePattern>(word), |args| &mut args.sampler)
        }),
        write: |args| args.sampler.to_toml(),
        ..SETTING
    },
    Setting {
        name: "crop",
        value: "x0,y0,x1,y1",
        otherwise: "all of it",
        example: "2,1,6,5",
        help: "The part of the frame to render, in pixels, y downwards; the second corner is \
               excluded",
        advanced: true,
        read: Reader::Text(|word| assign(window(word), |args| &mut args.crop)),
        write: |args| args.crop.to_toml(),
        ..SETTING
    },
    Setting {
        name: "filter",
        value: "SHAPE",
        default: Some("blackman-harris"),
        example: "box",
        help: "The pixel filter: box, gaussian or blackman-harris",
        advanced: true,
        read: Reader::Text(|word| assign(from_str::<PixelFilter>(word), |args| &mut args.filter)),
        write: |args| args.filter.to_toml(),
        ..SETTING
    },
    Setting {
        name: "transparent",
        form: Form::Switch,
        example: "true",
        help: "Makes the background transparent (alpha is 1 everywhere otherwise)",
        read: Reader::Text(|word| assign(switch(word), |args| &mut args.transparent)),
        write: |args| args.transparent.to_toml(),
        ..SETTING
    },
    Setting {
        name: "texture-lod",
        value: "WHETHER",
        choices: Some(choices::<TextureLod>),
        default: Some("off"),
        example: "on",
        help: "Looks textures up in smaller versions where they are far away or seen in rough \
               mirrors",
        details: "Off, each sample sees a point of the texture, and samples average: exact, but \
                  it takes many samples, and with little --texture-memory many tiles. On, each \
                  sees about what its pixel covers, which is a little blurred. Alpha that cuts \
                  holes and the emission of light sources are looked up as they are.",
        advanced: true,
        read: Reader::Text(|word| assign(choice::<TextureLod>(word), |args| &mut args.texture_lod)),
        write: |args| args.texture_lod.to_toml(),
        ..SETTING
    },
];
