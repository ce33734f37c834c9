//! A sample replayed alone, shaded by plain numbers, is the sample of the picture, which is shaded
//! many at once by vectors: of each scene of the project, at every instruction set.

use std::path::{Path, PathBuf};

use dapple::render::replay;
use dapple::{
    AccelSpec, BsdfForm, Control, Isa, LoadOptions, SamplePattern, Settings, World, build, load,
    render,
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
    let (width, height) = (24, 16);
    let mut scene = load(path, &LoadOptions::default()).expect("it loads");
    scene.add_defaults(width as f32 / height as f32);
    let camera = scene.cameras[0].camera;
    let world = World::new(scene, form).expect("not too many triangles");
    let settings = Settings { spp: 1, seed: 3, pattern, ..Settings::new(width, height) };
    for isa in Isa::ALL.into_iter().skip(1).filter(|isa| isa.level().is_some()) {
        let accel = build(&AccelSpec::default(), world.triangles.clone(), isa).expect("it builds");
        let picture = render(&world, camera, &*accel, &settings, &Control::default()).picture;
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let text = replay(&world, camera, &*accel, &settings, (x, y, 0));
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
