//! Settings: how light is followed, and where it comes from.

use super::parse::{
    LightArg, choice, choices, diameter, elevation, finite, from_str, not_negative, share, switch,
    turbidity, vector, whole,
};
use super::setting::{Form, Group, Reader, Role, Setting, assign};
use super::to_toml::ToToml;
use crate::formats::EnvironmentSource;
use crate::material::BsdfForm;
use crate::world::{LightSamplerKind, ShadingNormals};

const TRANSPORT: Setting = Setting::new(Group::Light, Role::Picture);
const AROUND: Setting = Setting::new(Group::Light, Role::Scene);
const SKY: Setting = Setting { form: Form::Number, advanced: true, requires: &["sky"], ..AROUND };

/// The entries, in the order of the help.
pub static LIGHT: &[Setting] = &[
    Setting {
        name: "max-depth",
        form: Form::Number,
        value: "N",
        default: Some("20"),
        example: "7",
        help: "The most segments of a path: 1 sees emitters only, 2 adds direct light",
        details: "Light that needs more is lost: glass within glass turns black. A note says so \
                  where two paths in a thousand are cut at the default or more; --json counts them \
                  as `cut_paths`.",
        read: Reader::Text(|word| {
            assign(whole::<u32>(word, 1..=1 << 16), |args| &mut args.max_depth)
        }),
        write: |args| args.max_depth.to_toml(),
        ..TRANSPORT
    },
    Setting {
        name: "rr-depth",
        value: "N|off",
        default: Some("5"),
        example: "off",
        help: "The segment from which Russian roulette may end a path, or off",
        advanced: true,
        read: Reader::Text(|word| assign(from_str(word), |args| &mut args.rr_depth)),
        write: |args| args.rr_depth.to_toml(),
        ..TRANSPORT
    },
    Setting {
        name: "bsdf",
        value: "FORM",
        default: Some("conserving"),
        example: "appendix-b",
        help: "How glTF's materials scatter: to the letter (appendix-b) or conserving energy \
               (conserving)",
        advanced: true,
        read: Reader::Text(|word| assign(from_str::<BsdfForm>(word), |args| &mut args.bsdf)),
        write: |args| args.bsdf.to_toml(),
        ..TRANSPORT
    },
    Setting {
        name: "shading-normals",
        value: "KIND",
        default: Some("robust"),
        example: "plain",
        help: "What becomes of light where smooth or bent normals and triangles disagree: it \
               scatters on (robust), is lost (plain), or scatters on facets (microfacet)",
        details: "With plain normals, smooth meshes of few triangles are dark at their edges, and \
                  bumps darken what they bend. Robust normals face the viewer wherever the \
                  triangle does, and light that they scatter below the triangle leaves from the \
                  curved surface that the normals tell, or meets the triangle and scatters again. \
                  So the border between light and shadow is smooth on a coarse mesh, too. With \
                  microfacet, a triangle stands for a saw of two facets, one of which faces the \
                  normal: no light is lost either, and it counts alike both ways; but bumps show \
                  less, coarse meshes show their triangles, and a vertex takes longer.",
        advanced: true,
        read: Reader::Text(|word| {
            assign(from_str::<ShadingNormals>(word), |args| &mut args.shading_normals)
        }),
        write: |args| args.shading_normals.to_toml(),
        ..TRANSPORT
    },
    Setting {
        name: "lights",
        value: "HOW",
        default: Some("power"),
        example: "tree",
        help: "How a light is chosen among many: power (wherever it is) or tree (by what it may \
               contribute)",
        details: "A tree makes less noise where there are many lights and each reaches only what \
                  is near: a third to a half less with a thousand small lamps. It takes more time \
                  per sample, a tenth with a few lights and nearly twice as much with hundreds. It \
                  is of no use below some 20 lights, or where all of them are far away. Each \
                  triangle that emits counts as a light.",
        advanced: true,
        read: Reader::Text(|word| {
            assign(from_str::<LightSamplerKind>(word), |args| &mut args.lights)
        }),
        write: |args| args.lights.to_toml(),
        ..TRANSPORT
    },
    Setting {
        name: "light",
        value: "WHOSE",
        choices: Some(choices::<LightArg>),
        default: Some("auto"),
        example: "file",
        help: "What lights the scene",
        details: "With auto, a look ahead of some ten thousand paths through the whole frame tells \
                  how much of what the camera sees is lit. Where that is less than a quarter, and \
                  there is neither --env nor --sky, a neutral sky is put around the scene; where \
                  that does not light a quarter either, there is a lamp at the camera instead. \
                  What was decided is said, and stands in the picture's header. In motion, the \
                  scene at 0 seconds decides for all frames. --strict takes what is asked for.",
        read: Reader::Text(|word| assign(choice::<LightArg>(word), |args| &mut args.light)),
        write: |args| args.light.to_toml(),
        ..AROUND
    },
    Setting {
        name: "env",
        form: Form::Numbers,
        value: "FILE|R,G,B",
        example: "0.1,0.2,0.3",
        help: "The environment light: a latitude-longitude image (.hdr, .exr, …) or a colour",
        conflicts: &["sky"],
        names_file: |word| matches!(word.parse(), Ok(EnvironmentSource::File(_))),
        read: Reader::Text(|word| {
            assign(from_str::<EnvironmentSource>(word), |args| &mut args.env)
        }),
        write: |args| args.env.to_toml(),
        ..AROUND
    },
    Setting {
        name: "sky",
        form: Form::Number,
        value: "2..10",
        example: "3",
        help: "Sun and sky of a clear day instead, by the air's turbidity: 2 mountains, 3 fine, \
               10 haze",
        read: Reader::Text(|word| assign(turbidity(word), |args| &mut args.sky)),
        write: |args| args.sky.to_toml(),
        ..AROUND
    },
    Setting {
        name: "sun-elevation",
        value: "DEGREES",
        otherwise: "45",
        example: "30",
        help: "The sun's height above the horizon, in degrees",
        read: Reader::Text(|word| assign(elevation(word), |args| &mut args.sun_elevation)),
        write: |args| args.sun_elevation.to_toml(),
        ..SKY
    },
    Setting {
        name: "sun-azimuth",
        value: "DEGREES",
        otherwise: "135",
        example: "-20",
        help: "The sun's direction on a compass whose north is -Z, in degrees",
        read: Reader::Text(|word| assign(finite(word), |args| &mut args.sun_azimuth)),
        write: |args| args.sun_azimuth.to_toml(),
        ..SKY
    },
    Setting {
        name: "sun-direction",
        form: Form::Numbers,
        value: "X,Y,Z",
        example: "-1,2,0.5",
        help: "The direction towards the sun, in place of both angles",
        conflicts: &["sun-elevation", "sun-azimuth"],
        read: Reader::Text(|word| assign(vector(word), |args| &mut args.sun_direction)),
        write: |args| args.sun_direction.to_toml(),
        ..SKY
    },
    Setting {
        name: "sun-diameter",
        value: "DEGREES",
        otherwise: "0.533",
        example: "2",
        help: "The sun's angular diameter, in degrees; with 0 there is sky alone",
        read: Reader::Text(|word| assign(diameter(word), |args| &mut args.sun_diameter)),
        write: |args| args.sun_diameter.to_toml(),
        ..SKY
    },
    Setting {
        name: "ground-albedo",
        value: "SHARE",
        otherwise: "0.2",
        example: "0.5",
        help: "The share of light that the ground below the sky reflects",
        read: Reader::Text(|word| assign(share(word), |args| &mut args.ground_albedo)),
        write: |args| args.ground_albedo.to_toml(),
        ..SKY
    },
    Setting {
        name: "env-scale",
        form: Form::Number,
        value: "X",
        default: Some("1"),
        example: "2.5",
        help: "Multiplies the environment light",
        advanced: true,
        requires: &["env", "sky"],
        read: Reader::Text(|word| assign(not_negative(word), |args| &mut args.env_scale)),
        write: |args| args.env_scale.to_toml(),
        ..AROUND
    },
    Setting {
        name: "env-rotate",
        form: Form::Number,
        value: "DEGREES",
        default: Some("0"),
        example: "-30",
        help: "Turns the environment image about +Y, in degrees",
        advanced: true,
        requires: &["env"],
        read: Reader::Text(|word| assign(finite(word), |args| &mut args.env_rotate)),
        write: |args| args.env_rotate.to_toml(),
        ..AROUND
    },
    Setting {
        name: "env-repair",
        form: Form::Switch,
        example: "true",
        help: "Where a pixel of the environment image is infinite or no number, the mean of its \
               neighbours takes its place",
        advanced: true,
        requires: &["env"],
        read: Reader::Text(|word| assign(switch(word), |args| &mut args.env_repair)),
        // Pictures made before it was there tell nothing of it.
        write: |args| if args.env_repair { true.to_toml() } else { None },
        ..AROUND
    },
];
