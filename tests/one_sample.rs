//! A sample replayed alone, shaded by plain numbers, is the sample of the picture, which is shaded
//! many at once by vectors: of each scene of the project, at every instruction set.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use dapple::math::{DQuat, DVec3};
use dapple::motion::{Link, Motion, MovingParts, Track};
use dapple::render::replay;
use dapple::{
    AccelSpec, BsdfForm, Control, Isa, LoadOptions, MovingCamera, SamplePattern, Scene, Settings,
    World, build, load, render,
};

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let ends = |path: &PathBuf| {
        path.extension()
            .is_some_and(|end| ["gltf", "glb", "toml"].iter().any(|known| end == *known))
    };
    let entries = std::fs::read_dir(folder).expect("the project's scenes");
    let mut scenes: Vec<PathBuf> =
        entries.map(|entry| entry.expect("an entry").path()).filter(ends).collect();
    scenes.sort();
    scenes
}

/// Channels with the values that a replay ends with.
fn channels(text: &str) -> Vec<(&'static str, f32)> {
    const COLOURS: [&str; 3] = ["R", "G", "B"];
    const ALBEDO: [&str; 3] = ["albedo.R", "albedo.G", "albedo.B"];
    const NORMAL: [&str; 3] = ["normal.X", "normal.Y", "normal.Z"];
    let lines: Vec<&str> = text.lines().collect();
    let (last, before) = lines.split_last().expect("a last line");
    let vector = |text: &str, name: &str| {
        let text = text.strip_prefix(name).expect(name).trim_end_matches(')');
        let numbers: Vec<f32> = text.split(", ").map(|n| n.parse().expect("a number")).collect();
        <[f32; 3]>::try_from(numbers).expect("three numbers")
    };
    let mut found: Vec<_> = COLOURS.into_iter().zip(vector(last, "radiance Vec3(")).collect();
    let seen = before.last().and_then(|line| line.split_once("), "));
    match seen.filter(|(albedo, _)| albedo.starts_with("albedo")) {
        Some((albedo, normal)) => {
            found.extend(ALBEDO.into_iter().zip(vector(albedo, "albedo Vec3(")));
            found.extend(NORMAL.into_iter().zip(vector(normal, "normal Vec3(")));
        }
        None => found.extend(ALBEDO.into_iter().chain(NORMAL).map(|name| (name, 0.0))),
    }
    found
}

fn check(path: &Path, form: BsdfForm, pattern: SamplePattern) {
    let scene = load(path, &LoadOptions::default()).expect("it loads");
    check_scene(path, scene, None, (form, pattern));
}

/// The same of a scene whose camera may move.
fn check_scene(
    path: &Path,
    mut scene: Scene,
    motion: Option<Arc<Motion>>,
    (form, pattern): (BsdfForm, SamplePattern),
) {
    let (width, height) = (24, 16);
    scene.add_defaults(width as f32 / height as f32);
    let camera = MovingCamera { camera: scene.cameras[0].camera, motion };
    let world = World::new(scene, form).expect("not too many triangles");
    let settings = Settings { spp: 1, seed: 3, pattern, ..Settings::new(width, height) };
    for isa in Isa::ALL.into_iter().skip(1).filter(|isa| isa.level().is_some()) {
        let accel = build(&AccelSpec::default(), world.triangles.clone(), isa).expect("it builds");
        let picture = render(&world, &camera, &*accel, &settings, &Control::default()).picture;
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let text = replay(&world, &camera, &*accel, &settings, (x, y, 0));
            for (channel, expected) in channels(&text) {
                let found = picture.channel(channel).expect("a layer")[(y * width + x) as usize];
                let name = path.display();
                // A sum has no zero with a sign.
                let same = found.to_bits() == (expected + 0.0).to_bits();
                assert!(same, "{name} {isa} {x},{y} {channel} {found} {text}");
            }
        }
    }
}

#[test]
fn samples_are_those_of_the_picture() {
    let scenes = scenes();
    assert!(scenes.len() >= 10, "{scenes:?}");
    for path in &scenes {
        check(path, BsdfForm::Conserving, SamplePattern::default());
    }
}

#[test]
fn also_by_other_forms_and_patterns() {
    for path in scenes().iter().step_by(4) {
        check(path, BsdfForm::AppendixB, SamplePattern::Sobol);
        check(path, BsdfForm::AppendixB, SamplePattern::Independent);
    }
}

/// By a camera that turns and moves, and one whose node has a scale; what it sees moves too.
#[test]
fn also_where_all_moves() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/motion.gltf");
    let options = LoadOptions { time: Some(0.5), shutter: Some(0.2), ..LoadOptions::default() };
    for scale in [1.0, 1.5] {
        let scene = load(&path, &options).expect("it loads");
        let stands = scene.cameras[0].camera.to_world.as_daffine3();
        let turn = |angle| DQuat::from_axis_angle(DVec3::Y, angle);
        let parts = MovingParts {
            translation: Track::new(&[(0.0, DVec3::ZERO), (1.0, DVec3::X)]).expect("has keys"),
            rotation: Track::new(&[(0.0, turn(0.0)), (0.7, turn(0.2))]).expect("has keys"),
            scale: Track::still(DVec3::splat(scale)),
        };
        let motion = Motion::new([Link::Still(stands), Link::Moving(Arc::new(parts))]);
        let motion = Arc::new(motion.expect("it moves"));
        let choices = (BsdfForm::Conserving, SamplePattern::default());
        check_scene(&path, scene, Some(motion), choices);
    }
}
