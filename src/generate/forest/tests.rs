//! A forest has exactly its triangles and copies, stands on its ground, and is a function of its
//! arguments.

use std::path::Path;

use super::*;
use crate::formats::{LoadOptions, gltf};
use crate::scene::{Scene, SceneMemory};

fn made(triangles: u64, copies: u64, seed: u64) -> (Vec<u8>, WrittenForest) {
    let mut bytes = Vec::new();
    let written = Forest::new(triangles, copies, seed).write(&mut bytes).expect("written");
    assert_eq!(written.bytes, bytes.len() as u64);
    (bytes, written)
}

fn loaded(bytes: &[u8], time: Option<f32>) -> Scene {
    let options = LoadOptions { time, ..LoadOptions::default() };
    gltf::parse(Path::new("made.glb"), bytes, &options).expect("loads")
}

#[test]
fn numbers_of_triangles_and_copies_are_met_exactly() {
    for (triangles, copies, seed) in
        [(4000, 1, 0), (4001, 17, 1), (40_000, 5000, 2), (123_457, 1234, 3)]
    {
        let (bytes, written) = made(triangles, copies, seed);
        assert_eq!((written.triangles, written.copies), (triangles, copies));
        let scene = loaded(&bytes, Some(0.0));
        assert_eq!(scene.notices, []);
        let memory = SceneMemory::of(&scene);
        assert_eq!(memory.placed_triangles, written.placed);
        // A kind without copies is not loaded.
        assert!(memory.unique_triangles <= triangles);
        if copies > 1000 {
            assert_eq!(memory.unique_triangles, triangles);
        }
        for mesh in &scene.meshes {
            assert!(mesh.positions.iter().all(|position| position.is_finite()), "{}", mesh.name);
            assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5), "{}", mesh.name);
        }
    }
}

#[test]
fn kinds_have_their_triangles_however_many_these_are() {
    for triangles in [4000, 5_000_000, *FOREST_TRIANGLES.end()] {
        let (kinds, _) = kinds::kinds(triangles);
        let small = |kind: &&Kind| kind.triangles < 1_000_000;
        for kind in kinds.iter().filter(small) {
            let pieces = kind.build(9);
            let count: usize = pieces.iter().map(|piece| piece.indices.len()).sum();
            let (count, most) = (count as u64, kind.triangles.max(20));
            assert!(count == kind.triangles || !kind.is_exact() && count <= most, "{kind:?}");
        }
    }
}

#[test]
fn files_are_functions_of_their_arguments_alone() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| made(20_000, 500, 5).0)
    };
    let bytes = on(1);
    assert!(bytes == on(3));
    assert!(bytes != made(20_000, 500, 6).0);
}

#[test]
fn copies_stand_on_the_ground_and_off_the_trail() {
    let forest = Forest::new(20_000, 4000, 1);
    let all = || forest.stands.iter().flatten();
    assert_eq!(all().count(), 4000);
    for stand in all() {
        let [x, y, z] = stand.at.map(f64::from);
        assert!((forest.land.height(x, z) - y).abs() < 0.1, "{:?}", stand.at);
        assert!((x - trail(z)).abs() > 0.3, "{:?}", stand.at);
        let turn = stand.turn.map(|number| f64::from(number) / 32767.0);
        let length = turn.iter().map(|number| number * number).sum::<f64>();
        assert!((length - 1.0).abs() < 1e-3, "{turn:?}");
    }
}

#[test]
fn the_camera_walks_along_the_trail() {
    let (bytes, _) = made(10_000, 200, 0);
    let eye = |time: f32| loaded(&bytes, Some(time)).cameras[0].camera.to_world.translation;
    let (start, middle, end) = (eye(0.0), eye(12.0), eye(24.0));
    assert!(start.z > middle.z && middle.z > end.z, "{start} {middle} {end}");
    let flight = Forest::new(10_000, 200, 0).flight();
    assert!(start.distance(flight[0].eye.into()) < 1e-4);
}
