//! The scenes in `scenes/` are those that `examples/make_scenes` makes, and load without a word.

#[path = "../examples/make_scenes/files/mod.rs"]
mod files;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use dapple::Isa;
use dapple::accel::build;
use dapple::formats::{EnvironmentImage, LoadOptions, load, obj};
use dapple::geom::TriangleSource;
use dapple::scene::{AlphaMode, Triangles};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")
}

#[test]
fn scenes_are_what_the_example_makes() {
    let made = files::all();
    for (name, bytes) in &made {
        let stored = fs::read(folder().join(name)).expect("the scene is part of the project");
        assert!(stored == *bytes, "{name} differs: cargo run --example make_scenes");
    }
    let total: usize = made.iter().map(|(_, bytes)| bytes.len()).sum();
    assert!(total < 2_000_000, "{total} bytes");
}

#[test]
fn scenes_load_without_a_word() {
    for (name, _) in files::all() {
        let time = (name == "motion.gltf").then_some(0.5);
        let strict = LoadOptions { strict: true, time, ..LoadOptions::default() };
        if Path::new(&name).extension().is_some_and(|ending| ending == "gltf") {
            let scene = load(&folder().join(&name), &strict);
            let scene = scene.unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(scene.cameras.len(), 1, "{name}");
        }
    }
}

/// On the field of bunnies it is the coarse tree that costs least, elsewhere the exact one.
#[test]
fn the_default_build_of_kd_trees_costs_least_on_every_scene() {
    for (name, _) in files::all() {
        if !Path::new(&name).extension().is_some_and(|ending| ending == "gltf" || ending == "obj") {
            continue;
        }
        let scene = load(&folder().join(&name), &LoadOptions::default()).expect("loads");
        let triangles = Triangles::new(&scene).expect("they are few");
        let source: Arc<dyn TriangleSource> = Arc::new(triangles);
        let [sah, binned, minmax] = ["sah", "binned", "minmax"].map(|how| {
            let spec = format!("kd-stack-direction:build={how}").parse().expect("is known");
            let accel = build(&spec, Arc::clone(&source), Isa::Auto).expect("it builds");
            accel.report().sah_cost
        });
        // Costs are summed in another order than where trees are compared.
        let least = binned.min(minmax) * (1.0 + 1e-12);
        assert!(sah <= least, "{name}: {sah}, {binned} by binned, {minmax} by minmax");
    }
}

#[test]
fn the_tower_has_all_that_its_format_can_say() {
    let scene = obj::load(&folder().join("tower.obj"), &LoadOptions::default()).expect("loads");
    assert!(scene.notices.is_empty(), "{:?}", scene.notices);
    let material =
        |name| scene.materials.iter().find(|m| m.name == name).expect("the library has it");
    assert_eq!(material("glass").transmission, 1.0);
    assert_eq!(material("glass").alpha_mode, AlphaMode::Opaque);
    assert!(material("lamp").is_emissive());
    assert_eq!(material("gold").metallic, 1.0);
    assert!(material("brick wall").bump_texture.is_some());

    // The walkway, a 32-gon of radius 1.38 with a hole of radius 0.7, is cut into a plane whose
    // area is known: in a fan it would cover its hole.
    let mesh = scene.meshes.iter().find(|m| m.name == "tower/battlements").expect("it is there");
    let area: f32 = mesh
        .indices
        .iter()
        .map(|t| t.map(|i| mesh.positions[i as usize]))
        .filter(|t| t.iter().all(|p| p.y == 5.35 && p.length() < 5.55))
        .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).y)
        .sum();
    let of_32_gon = |radius: f32| 16.0 * radius * radius * libm::sinf(std::f32::consts::TAU / 32.0);
    let expected = of_32_gon(1.38) - of_32_gon(0.7);
    assert!((area - expected).abs() < 1e-3, "{area} is not {expected}");
}

#[test]
fn the_sky_is_bright_where_the_sun_is() {
    let (sky, notices) = EnvironmentImage::read(&folder().join("sky.hdr")).expect("is well-formed");
    assert!(notices.is_empty(), "{notices:?}");
    let brightest = sky.pixels.iter().flatten().copied().fold(0.0, f32::max);
    assert!(brightest > 400.0, "{brightest}");
}
