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

/// The radiance that a replay ends with.
fn radiance(text: &str) -> [f32; 3] {
    let line = text.lines().last().expect("a last line");
    let numbers = line.trim_start_matches("radiance Vec3(").trim_end_matches(')');
    let numbers: Vec<f32> = numbers.split(", ").map(|n| n.parse().expect("a number")).collect();
    numbers.try_into().expect("three channels")
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
        let picture = render(&world, &camera, &*accel, &settings, &Control::default()).picture;
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let text = replay(&world, &camera, &*accel, &settings, (x, y, 0));
            let expected = radiance(&text);
            for (channel, expected) in ["R", "G", "B"].into_iter().zip(expected) {
                let found = picture.channel(channel).expect("colours")[(y * width + x) as usize];
                let name = path.display();
                assert_eq!(found.to_bits(), expected.to_bits(), "{name} {isa} {x},{y} {text}");
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
