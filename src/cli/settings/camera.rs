//! Settings: from where the scene is seen, and for how long.

use super::parse::{
    CameraModel, choice, choices, direction, field_of_view, from_str, positive, vector,
};
use super::setting::{Form, Group, Reader, Role, Setting, assign};
use super::to_toml::ToToml;

const VIEW: Setting = Setting::new(Group::Camera, Role::Picture);
const MOTION: Setting =
    Setting { form: Form::Number, advanced: true, ..Setting::new(Group::Camera, Role::Scene) };

/// The entries, in the order of the help.
pub static CAMERA: &[Setting] = &[
    Setting {
        name: "camera",
        value: "NAME|N",
        otherwise: "the first",
        example: "0",
        help: "A camera of the scene, by name or number from 0",
        conflicts: &["look-from"],
        read: Reader::Text(|word| assign(from_str::<String>(word), |args| &mut args.camera)),
        write: |args| args.camera.to_toml(),
        ..VIEW
    },
    Setting {
        name: "look-from",
        form: Form::Numbers,
        value: "X,Y,Z",
        example: "0.1,1,3",
        help: "A camera of one's own: where it stands",
        read: Reader::Text(|word| assign(vector(word), |args| &mut args.look_from)),
        write: |args| args.look_from.to_toml(),
        ..VIEW
    },
    Setting {
        name: "look-at",
        form: Form::Numbers,
        value: "X,Y,Z",
        otherwise: "the middle of the scene",
        example: "-1,0,0",
        help: "What that camera looks at",
        requires: &["look-from"],
        read: Reader::Text(|word| assign(vector(word), |args| &mut args.look_at)),
        write: |args| args.look_at.to_toml(),
        ..VIEW
    },
    Setting {
        name: "up",
        form: Form::Numbers,
        value: "X,Y,Z|AXIS",
        otherwise: "0,1,0",
        example: "0,0,1",
        help: "Which direction is up for that camera, or for one that frames all: also by x, y, z, \
               -x, …",
        details: "Scans and CAD models often have z upwards: with --up z the automatic camera and \
                  the neutral sky turn with it.",
        advanced: true,
        read: Reader::Text(|word| assign(direction(word), |args| &mut args.up)),
        write: |args| args.up.to_toml(),
        ..VIEW
    },
    Setting {
        name: "fov",
        form: Form::Number,
        value: "DEGREES",
        otherwise: "the camera's own",
        example: "33.3",
        help: "The vertical field of view, in degrees",
        read: Reader::Text(|word| assign(field_of_view(word), |args| &mut args.fov)),
        write: |args| args.fov.to_toml(),
        ..VIEW
    },
    Setting {
        name: "camera-model",
        value: "KIND",
        choices: Some(choices::<CameraModel>),
        example: "panorama",
        help: "Another kind of camera in the same place: panorama",
        advanced: true,
        conflicts: &["fov", "aperture"],
        read: Reader::Text(|word| {
            assign(choice::<CameraModel>(word), |args| &mut args.camera_model)
        }),
        write: |args| args.camera_model.to_toml(),
        ..VIEW
    },
    Setting {
        name: "aperture",
        form: Form::Number,
        value: "METRES",
        otherwise: "a pinhole",
        example: "0.1",
        help: "Radius of the lens in metres",
        advanced: true,
        read: Reader::Text(|word| assign(positive(word), |args| &mut args.aperture)),
        write: |args| args.aperture.to_toml(),
        ..VIEW
    },
    Setting {
        name: "focus",
        form: Form::Number,
        value: "METRES",
        otherwise: "that of --look-at, or of the middle of the scene",
        example: "4",
        help: "Distance of what is sharp",
        advanced: true,
        requires: &["aperture"],
        read: Reader::Text(|word| assign(positive(word), |args| &mut args.focus)),
        write: |args| args.focus.to_toml(),
        ..VIEW
    },
    Setting {
        name: "shutter",
        value: "SECONDS",
        otherwise: "an instant",
        example: "0.5",
        help: "How long the shutter is open, in seconds from --time on: what is animated blurs",
        details: "Each sample of a pixel has a time of its own. Nodes, skins, morphs and the \
                  scene's cameras and lights move: nodes as their channels say, vertices straight \
                  between keys that lie close enough.",
        requires: &["time"],
        read: Reader::Text(|word| assign(positive(word), |args| &mut args.shutter)),
        write: |args| args.shutter.to_toml(),
        ..MOTION
    },
];
