//! Every scene has exactly its triangles, and is a function of its arguments.

use std::path::Path;
use std::sync::Arc;

use proptest::prelude::*;

use super::*;
use crate::accel::{Batch, ClosestHit, build};
use crate::formats::{LoadOptions, gltf};
use crate::geom::TriangleSource;
use crate::math::{PrimId, Ray, Vec3};
use crate::scene::{Scene, Triangles};
use crate::simd::Isa;

const ALL: [Generator; 4] =
    [Generator::Assembly, Generator::City, Generator::Kitchen, Generator::Landscape];

fn made(generator: Generator, triangles: u64, seed: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    let written = generator.write(triangles, seed, &mut bytes).expect("written");
    assert_eq!(written.bytes, bytes.len() as u64);
    bytes
}

fn loaded(bytes: &[u8]) -> Scene {
    gltf::parse(Path::new("made.glb"), bytes, &LoadOptions::default()).expect("loads")
}

/// Loads with a camera, light and not a word, exactly this many triangles, all of them sound.
fn check(generator: Generator, triangles: u64, seed: u64) {
    let scene = Arc::new(loaded(&made(generator, triangles, seed)));
    assert_eq!(scene.notices, []);
    assert!(scene.cameras.len() == 1 && !scene.lights.is_empty(), "{generator:?}");
    let flat = Triangles::new(Arc::clone(&scene)).expect("few enough");
    assert_eq!(flat.len() as u64, triangles, "seed {seed}");
    for id in 0..flat.len() as u32 {
        let twice = flat.triangle(PrimId(id)).double_area().length();
        assert!(
            twice > 0.0 && twice.is_finite(),
            "{generator:?}, {triangles}, {seed}: {id} is {twice}"
        );
    }
    for mesh in scene.meshes.iter().map(Arc::as_ref) {
        assert_eq!(mesh.normals.len(), mesh.positions.len(), "{}", mesh.name);
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5), "{}", mesh.name);
    }
}

#[test]
fn numbers_of_triangles_are_met_exactly() {
    for triangles in (1..=40).chain([63, 64, 65, 100, 999, 1000, 4000, 50_000]) {
        for generator in ALL {
            check(generator, triangles, 3);
        }
    }
}

#[test]
fn the_papers_numbers_are_met_exactly() {
    let papers = [
        (Generator::Assembly, 69_451),
        (Generator::Assembly, 334_080),
        (Generator::City, 9_200),
        (Generator::Kitchen, 103_000),
        (Generator::Landscape, 644_000),
    ];
    for (generator, triangles) in papers {
        check(generator, triangles, 1);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn any_number_is_met_exactly(
        triangles in 1_u64..60_000, seed in any::<u64>(), which in 0_usize..4,
    ) {
        check(ALL[which], triangles, seed);
    }
}

#[test]
fn files_are_functions_of_their_arguments_alone() {
    for generator in ALL {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("a pool").install(|| made(generator, 20_000, 5))
        };
        let bytes = on(1);
        assert!(bytes == on(3), "{generator:?}");
        assert!(bytes != made(generator, 20_000, 6), "{generator:?}");
        assert_eq!(generator.flight(20_000, 5), generator.flight(20_000, 5));
    }
}

#[test]
fn no_triangle_has_a_twin_in_another_place() {
    let scene = loaded(&made(Generator::Assembly, 69_451, 2));
    assert_eq!(scene.instances.len(), scene.meshes.len());
}

#[test]
fn scenes_of_some_size_have_all_kinds_of_finish() {
    let scene = loaded(&made(Generator::Assembly, 69_451, 2));
    let used: std::collections::BTreeSet<usize> =
        scene.instances.iter().map(|instance| instance.material.index()).collect();
    assert!(used.len() >= 10, "{used:?}");
    assert!(scene.instances.len() > 500, "{} parts", scene.instances.len());
}

/// What a structure says of rays from the eyes of a scene's flight: of each eye the share that
/// hits, and the least distance.
fn seen(generator: Generator, triangles: u64, rays: usize) -> Vec<(f64, f32)> {
    let scene = loaded(&made(generator, triangles, 0));
    let source: Arc<dyn TriangleSource> =
        Arc::new(Triangles::new(Arc::new(scene)).expect("few enough"));
    let accel = build(&"bvh2".parse().expect("known"), source, Isa::Auto).expect("builds");
    let mut random = random::Random::new(1);
    let mut side = || random.between(-1.0, 1.0) as f32;
    let flight = generator.flight(triangles, 0);
    assert_eq!(flight.len(), FLIGHT);
    let of_eye = |pose: &Pose| {
        let ray = |_| {
            let direction = Vec3::new(side(), side(), side()).normalize_or(Vec3::X);
            Ray::new(pose.eye, direction, 0.0, f32::INFINITY)
        };
        let rays: Vec<Ray> = (0..rays).map(ray).collect();
        let mut hits = vec![ClosestHit::MISS; rays.len()];
        accel.tracer().closest_hits(&Batch::new(&rays), &mut hits);
        let share = hits.iter().filter(|hit| hit.is_hit()).count() as f64 / rays.len() as f64;
        (share, hits.iter().map(|hit| hit.t).fold(f32::INFINITY, f32::min))
    };
    flight.iter().step_by(3).map(of_eye).collect()
}

#[test]
fn no_ray_leaves_the_kitchen() {
    for (share, nearest) in seen(Generator::Kitchen, 103_000, 20_000) {
        assert_eq!(share, 1.0);
        assert!(nearest > 0.02, "the camera is {nearest} from something");
    }
}

#[test]
fn town_and_land_are_open_and_their_cameras_stand_free() {
    for (generator, triangles) in [(Generator::City, 9_200), (Generator::Landscape, 100_000)] {
        for (share, nearest) in seen(generator, triangles, 2000) {
            assert!(share > 0.1 && share < 0.95, "{generator:?}: {share}");
            assert!(nearest > 0.1, "{generator:?}: {nearest}");
        }
    }
}
