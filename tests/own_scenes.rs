//! The scenes in `scenes/` are those that `examples/make_scenes` makes, and load without a word.

#[path = "../examples/make_scenes/files/mod.rs"]
mod files;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use dapple::Isa;
use dapple::accel::build;
use dapple::formats::{EnvironmentImage, LoadOptions, NotFinite, load, obj};
use dapple::geom::TriangleSource;
use dapple::math::Vec3;
use dapple::scene::defaults::bounds;
use dapple::scene::{AlphaMode, Survey, Triangles};

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
    assert!(total < 2_100_000, "{total} bytes");
}

/// A scene (a glTF file, where the name has no ending), its triangles (of all meshes, placed,
/// emitting), how many meshes, placed meshes, materials, textures and punctual lights it has, and
/// its bounds in metres.
type Contents = (&'static str, [u64; 3], [usize; 5], [f32; 3], [f32; 3]);

#[rustfmt::skip]
const CONTENTS: &[Contents] = &[
    ("alpha", [2228, 2394, 2], [6, 89, 7, 1, 0], [-6.0, -0.08, -2.5], [6.0, 7.0, 5.0]),
    ("cornell", [32, 32, 2], [8, 8, 4, 0, 0], [-2.748, 0.0, -5.592], [2.78, 5.488, 0.0]),
    ("films", [4068, 31844, 4], [4, 11, 11, 1, 0], [-16.0, 0.0, -6.0], [16.0, 9.0, 7.0]),
    ("finishes", [12004, 31844, 4], [6, 11, 11, 2, 0], [-16.0, 0.0, -6.0], [16.0, 9.0, 7.0]),
    ("furnace", [2208, 17664, 0], [1, 8, 8, 0, 0], [-4.3, -2.1, -1.0], [4.3, 2.1, 1.0]),
    ("gems", [6412, 37612, 4], [6, 11, 11, 0, 0], [-16.0, -0.05, -6.0], [16.0, 9.0, 7.0]),
    ("glass", [12410, 31130, 2], [10, 13, 10, 1, 0], [-4.5, 0.0, -3.5], [4.5, 5.0, 8.5]),
    ("instanced", [5284, 448804, 2], [3, 87, 6, 0, 1], [-60.0, 0.0, -80.0], [60.0, 20.0, 40.0]),
    ("leaves", [1214, 3478, 734], [6, 11, 11, 1, 0], [-16.0, 0.0, -6.0], [16.0, 9.0, 7.0]),
    ("many_lights", [28, 906, 604], [4, 248, 8, 0, 3], [-20.0, 0.0, -20.0], [20.0, 4.02, 20.0]),
    ("media", [1336, 12352, 1228], [5, 14, 14, 0, 0], [-16.0, 0.0, -6.0], [16.0, 9.0, 7.0]),
    ("metals", [6340, 74980, 4], [4, 15, 15, 0, 0], [-16.0, 0.0, -6.0], [16.0, 9.0, 7.0]),
    ("motion", [10368, 10368, 4], [10, 10, 10, 0, 0], [-16.0, 0.0, -6.0], [16.0, 9.0, 7.0]),
    ("orthographic", [16, 1456, 2], [3, 123, 7, 0, 1], [-30.0, 0.0, -30.0], [30.0, 28.5, 30.0]),
    ("painted", [1104, 8664, 2], [8, 71, 8, 3, 0], [-9.0, -0.0467, -3.0], [9.0, 8.0, 8.0]),
    ("sky", [13922, 32642, 0], [3, 6, 6, 0, 0], [-40.0, -0.0222, -40.0], [40.0, 2.5622, 40.0]),
    ("textured", [7966, 7966, 2], [12, 12, 11, 12, 0], [-9.0, 0.0, -3.0], [9.0, 9.0, 8.0]),
    ("tower.obj", [948, 948, 20], [8, 8, 7, 2, 0], [-5.0, 0.0, -5.0], [5.0, 8.4478, 5.0]),
];

#[test]
fn scenes_load_without_a_word() {
    let file = |name: &str| if name.contains('.') { name.into() } else { format!("{name}.gltf") };
    for &(name, triangles, counts, min, max) in CONTENTS {
        let name = file(name);
        let time = (name == "motion.gltf").then_some(0.5);
        let strict = LoadOptions { strict: true, time, ..LoadOptions::default() };
        let scene = load(folder().join(&name), &strict);
        let scene = scene.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(scene.cameras.len(), usize::from(name != "tower.obj"), "{name}: cameras");
        let survey = Survey::of(&scene);
        let found = [survey.unique_triangles, survey.placed_triangles, survey.emitting_triangles];
        assert_eq!(found, triangles, "{name}: triangles");
        assert_eq!([survey.flat_triangles, survey.flattened], [0; 2], "{name}: without area");
        let (meshes, places) = (scene.meshes.len(), scene.instances.len());
        let (materials, textures) = (scene.materials.len(), scene.textures.len());
        let found = [meshes, places, materials, textures, scene.lights.len()];
        assert_eq!(found, counts, "{name}: meshes, places, materials, textures, lights");
        let bounds = bounds(&scene);
        let off = (bounds.min - Vec3::from(min)).abs().max((bounds.max - Vec3::from(max)).abs());
        assert!(off.max_element() < 1e-3, "{name}: {bounds:?}");
    }
    let made = files::all();
    let is_scene = |name: &&str| [".gltf", ".obj"].iter().any(|ending| name.ends_with(ending));
    let mut made: Vec<&str> = made.iter().map(|(name, _)| &**name).filter(is_scene).collect();
    made.sort_unstable();
    assert_eq!(made, CONTENTS.iter().map(|scene| file(scene.0)).collect::<Vec<_>>());
}

/// On the field of bunnies it is the coarse tree that costs least, elsewhere the exact one.
#[test]
fn the_default_build_of_kd_trees_costs_least_on_every_scene() {
    for (name, _) in files::all() {
        if !Path::new(&name).extension().is_some_and(|ending| ending == "gltf" || ending == "obj") {
            continue;
        }
        let scene = load(folder().join(&name), &LoadOptions::default()).expect("loads");
        let triangles = Triangles::new(Arc::new(scene)).expect("they are few");
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
    let (sky, notices) = EnvironmentImage::read(&folder().join("sky.hdr"), NotFinite::Refuse)
        .expect("is well-formed");
    assert!(notices.is_empty(), "{notices:?}");
    let brightest = sky.pixels.iter().flatten().copied().fold(0.0, f32::max);
    assert!(brightest > 400.0, "{brightest}");
}
