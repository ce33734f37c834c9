//! Settings: what a render uses of the machine.

use super::parse::{from_str, threads};
use super::parse_size::size;
use super::setting::{Form, Group, Reader, Role, Setting, assign};
use super::to_toml::ToToml;
use crate::accel::AccelSpec;
use crate::simd::Isa;

const SETTING: Setting = Setting::new(Group::Speed, Role::Process);

/// The entries, in the order of the help.
pub static SPEED: &[Setting] = &[
    Setting {
        name: "threads",
        form: Form::Number,
        value: "N",
        default: Some("0"),
        example: "2",
        help: "Threads; 0: one per core",
        read: Reader::Text(|word| assign(threads(word), |args| &mut args.threads)),
        write: |args| args.threads.to_toml(),
        ..SETTING
    },
    Setting {
        name: "accel",
        value: "ID[:option=value,…]",
        default: Some("auto"),
        example: "bvh2:build=sweep",
        help: "The ray-shooting structure; `dapple accels` lists them",
        read: Reader::Text(|word| assign(from_str::<AccelSpec>(word), |args| &mut args.accel)),
        write: |args| args.accel.to_toml(),
        ..SETTING
    },
    Setting {
        name: "isa",
        value: "SET",
        default: Some("auto"),
        example: "portable",
        help: "The instruction set",
        advanced: true,
        read: Reader::Text(|word| assign(from_str::<Isa>(word), |args| &mut args.isa)),
        write: |args| args.isa.to_toml(),
        ..SETTING
    },
    Setting {
        name: "memory",
        value: "SIZE",
        otherwise: "all that there is",
        example: "2GB",
        help: "Refuses a scene that by estimate takes more, before its structure is built",
        details: "The estimate is what `dapple info` tells: meshes, placements, textures, and the \
                  structure over meshes and placements; and the picture. The exit code is 5.",
        read: Reader::Text(|word| assign(size(word), |args| &mut args.memory)),
        write: |args| args.memory.to_toml(),
        ..SETTING
    },
    Setting {
        name: "texture-memory",
        value: "SIZE",
        otherwise: "half of the memory",
        example: "512MiB",
        help: "The memory that textures may take; the rest of them waits in a temporary file",
        details: "Beyond it, textures are cut into tiles, which are kept compressed in a file in \
                  the system's temporary folder (TMPDIR) and are read back when a ray asks for \
                  them. The picture is the same, whatever the size. Units are KiB, MiB, GiB (or \
                  K, M, G) and kB, MB, GB.",
        read: Reader::Text(|word| assign(size(word), |args| &mut args.texture_memory)),
        write: |args| args.texture_memory.to_toml(),
        ..SETTING
    },
];
