//! Scenes made by rule from a seed, of exactly as many triangles as asked for.
//!
//! A generator is one module that makes a `Model`: shapes at their places, materials, cameras and
//! lights, nothing of which depends on how finely it will be tessellated but for the parts there
//! are (`Generator::model`). What follows is the same for all: each part is given its share of
//! the triangles (`budget`), and the file is written (`glb`).
//!
//! Arithmetic is +, -, ×, ÷, √ and `libm`, in one order: the same file on every machine.

mod assembly;
mod budget;
mod document;
mod glb;
mod model;
mod random;
mod shape;
mod tessellation;

use std::io::{self, Write};
use std::ops::RangeInclusive;

pub use document::{Document, perspective, rounded};
pub use glb::Written;
use model::Model;

/// How many triangles a scene may have.
pub const TRIANGLES: RangeInclusive<u64> = 1..=20_000_000;

/// A kind of scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Generator {
    /// A machine, dense and finely tessellated.
    Assembly,
}

impl Generator {
    /// The parts of the scene for a number of triangles.
    fn model(self, triangles: u64, seed: u64) -> Model {
        match self {
            Self::Assembly => assembly::model(triangles, seed),
        }
    }

    /// Writes a scene of exactly `triangles` as .glb. The same arguments give the same bytes.
    ///
    /// # Errors
    /// Those of `out`.
    ///
    /// # Panics
    /// If `triangles` is not within [`TRIANGLES`].
    pub fn write(self, triangles: u64, seed: u64, out: &mut dyn Write) -> io::Result<Written> {
        assert!(TRIANGLES.contains(&triangles), "{triangles} triangles");
        let mut model = self.model(triangles, seed);
        let plan = budget::share(&mut model, triangles);
        let written = glb::write(out, &model, &plan)?;
        assert_eq!(written.triangles, triangles, "the plan is exact");
        Ok(written)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use proptest::prelude::*;

    use super::*;
    use crate::geom::TriangleSource;
    use crate::math::TriangleId;
    use crate::scene::{LoadOptions, Scene, Triangles, gltf};

    fn assembly(triangles: u64, seed: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        let written = Generator::Assembly.write(triangles, seed, &mut bytes).expect("written");
        assert_eq!(written.bytes, bytes.len() as u64);
        bytes
    }

    fn loaded(bytes: &[u8]) -> Scene {
        gltf::parse(Path::new("assembly.glb"), bytes, &LoadOptions::default()).expect("loads")
    }

    /// Loads with a camera, light and not a word, exactly this many triangles, all of them sound.
    fn check(triangles: u64, seed: u64) {
        let scene = loaded(&assembly(triangles, seed));
        assert_eq!(scene.notices, []);
        assert_eq!((scene.cameras.len(), scene.lights.len()), (1, 1));
        let flat = Triangles::new(&scene).expect("few enough");
        assert_eq!(flat.len() as u64, triangles, "seed {seed}");
        for id in 0..flat.len() as u32 {
            let twice = flat.triangle(TriangleId(id)).double_area().length();
            assert!(twice > 0.0 && twice.is_finite(), "{triangles}, {seed}: {id} is {twice}");
        }
        for mesh in scene.meshes.iter().map(Arc::as_ref) {
            assert_eq!(mesh.normals.len(), mesh.positions.len(), "{}", mesh.name);
            assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5), "{}", mesh.name);
        }
    }

    #[test]
    fn numbers_of_triangles_are_met_exactly() {
        for triangles in (1..=40).chain([63, 64, 65, 100, 999, 1000, 4000, 50_000]) {
            check(triangles, 3);
        }
    }

    #[test]
    fn the_papers_numbers_are_met_exactly() {
        for triangles in [69_451, 334_080] {
            check(triangles, 1);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn any_number_is_met_exactly(triangles in 1_u64..60_000, seed in any::<u64>()) {
            check(triangles, seed);
        }
    }

    #[test]
    fn files_are_functions_of_their_arguments_alone() {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("a pool").install(|| assembly(20_000, 5))
        };
        let bytes = on(1);
        assert!(bytes == on(3));
        assert!(bytes != assembly(20_000, 6));
    }

    #[test]
    fn no_triangle_has_a_twin_in_another_place() {
        let scene = loaded(&assembly(69_451, 2));
        assert_eq!(scene.instances.len(), scene.meshes.len());
    }

    #[test]
    fn scenes_of_some_size_have_all_kinds_of_finish() {
        let scene = loaded(&assembly(69_451, 2));
        let used: std::collections::BTreeSet<usize> =
            scene.instances.iter().map(|instance| instance.material.index()).collect();
        assert!(used.len() >= 10, "{used:?}");
        assert!(scene.instances.len() > 500, "{} parts", scene.instances.len());
    }
}
