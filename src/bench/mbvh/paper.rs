//! What M. Ernst and G. Greiner measured: "Multi bounding volume hierarchies", 2008, section 4, on
//! one core of a Core 2 Duo of 2 GHz.

/// The machine, for titles.
pub const MACHINE: &str = "the paper's figures are those of a Core 2 Duo, 2 GHz, in 2008";

/// A row of table 1.
#[derive(Clone, Copy, Debug)]
pub struct Built {
    /// Seconds to build the binary tree.
    pub tree_seconds: f64,
    /// Seconds to collapse it.
    pub collapse_seconds: Option<f64>,
    /// Thousands of leaves.
    pub leaves: f64,
    /// Thousands of empty ones.
    pub empty: Option<f64>,
    /// Triangles of a leaf.
    pub mean_leaf: f64,
    /// Depth of a leaf.
    pub mean_depth: f64,
    /// Its memory.
    pub megabytes: f64,
}

/// A row of table 2. Those of the binary tree count triangles and boxes one by one.
#[derive(Clone, Copy, Debug)]
pub struct Shot {
    /// Tests of triangles per ray.
    pub triangle_tests: f64,
    /// Tests of boxes per ray.
    pub box_tests: f64,
    /// Per cent of look-ups in a cache of 100 MB that hit.
    pub hit_rate: Option<f64>,
    /// Thousands of rays a second.
    pub krays: f64,
}

/// A scene of the paper. Of pairs, the first is the binary tree's, the second the wide one's.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// As the tables name it.
    pub name: &'static str,
    /// By which scenes of ours are matched to it.
    pub triangles: usize,
    /// Table 1.
    pub built: [Built; 2],
    /// Table 2, nearest hits.
    pub closest: [Shot; 2],
    /// Table 2, shadow rays.
    pub shadow: [Shot; 2],
    /// Table 4: rates at 4, 8 and 16 lanes, simulated without vectors, over the binary tree's.
    pub simulated: Option<[f64; 3]>,
    /// Table 4: what vectors might make of them.
    pub potential: Option<[f64; 3]>,
    /// Figure 1: speed-up of a whole render.
    pub render_speed_up: f64,
}

/// Table 3: size of the cache in megabytes, hit rate in per cent, thousands of rays a second; the
/// largest scene, nearest hits.
pub const CACHES: [(u64, f64, f64); 5] = [
    (200, 98.3, 338.0),
    (100, 97.3, 333.0),
    (50, 90.2, 283.0),
    (25, 80.2, 246.0),
    (10, 64.6, 216.0),
];

const fn bvh(tree_seconds: f64, leaves: f64, mean_leaf: f64, depth: f64, mb: f64) -> Built {
    let (collapse_seconds, empty) = (None, None);
    Built {
        tree_seconds,
        collapse_seconds,
        leaves,
        empty,
        mean_leaf,
        mean_depth: depth,
        megabytes: mb,
    }
}

const fn mbvh([tree, collapse]: [f64; 2], [leaves, empty]: [f64; 2], depth: f64, mb: f64) -> Built {
    Built {
        collapse_seconds: Some(collapse),
        empty: Some(empty),
        ..bvh(tree, leaves, 4.0, depth, mb)
    }
}

const fn shot(triangle_tests: f64, box_tests: f64, krays: f64) -> Shot {
    Shot { triangle_tests, box_tests, hit_rate: None, krays }
}

const fn find_cached(triangle_tests: f64, box_tests: f64, hit_rate: f64, krays: f64) -> Shot {
    Shot { hit_rate: Some(hit_rate), ..shot(triangle_tests, box_tests, krays) }
}

/// The scenes, by size.
pub const SCENES: [Scene; 4] = [
    Scene {
        name: "Bunny",
        triangles: 69_451,
        built: [bvh(0.4, 21.0, 3.3, 14.6, 1.6), mbvh([0.4, 0.01], [17.0, 8.0], 6.5, 1.3)],
        shadow: [shot(3.6, 35.9, 364.0), find_cached(1.5, 9.7, 99.9, 1034.0)],
        closest: [shot(5.0, 42.9, 295.0), find_cached(1.7, 11.0, 99.9, 769.0)],
        simulated: Some([0.75, 0.57, 0.43]),
        potential: Some([3.00, 4.56, 6.88]),
        render_speed_up: 1.19,
    },
    Scene {
        name: "Mirror",
        triangles: 334_080,
        built: [bvh(2.7, 116.0, 3.0, 18.4, 8.4), mbvh([2.4, 0.04], [87.0, 43.0], 8.3, 6.6)],
        shadow: [shot(5.4, 44.8, 286.0), find_cached(2.2, 12.6, 99.7, 721.0)],
        closest: [shot(8.4, 58.4, 205.0), find_cached(3.6, 16.0, 99.8, 423.0)],
        simulated: Some([0.75, 0.57, 0.43]),
        potential: Some([3.00, 4.56, 6.88]),
        render_speed_up: 1.32,
    },
    Scene {
        name: "Headlight",
        triangles: 770_534,
        built: [bvh(6.3, 250.0, 3.1, 18.9, 18.2), mbvh([5.8, 0.09], [193.0, 96.0], 8.5, 14.7)],
        shadow: [shot(5.4, 48.5, 251.0), find_cached(2.4, 14.5, 99.4, 564.0)],
        closest: [shot(8.1, 64.4, 183.0), find_cached(3.8, 19.2, 99.6, 306.0)],
        simulated: Some([0.73, 0.56, 0.40]),
        potential: Some([2.92, 4.48, 6.40]),
        render_speed_up: 1.64,
    },
    Scene {
        name: "Car",
        triangles: 4_304_391,
        built: [
            bvh(43.4, 1401.0, 3.1, 22.4, 102.0),
            mbvh([39.2, 0.48], [1076.0, 539.0], 10.3, 82.1),
        ],
        shadow: [shot(5.2, 48.8, 239.0), find_cached(2.0, 13.3, 96.8, 571.0)],
        closest: [shot(7.9, 64.5, 170.0), find_cached(3.3, 18.2, 97.3, 333.0)],
        simulated: None,
        potential: None,
        render_speed_up: 2.28,
    },
];

impl Scene {
    /// The paper's scene of as many triangles.
    pub fn of(triangles: usize) -> Option<&'static Self> {
        SCENES.iter().find(|scene| scene.triangles == triangles)
    }

    /// Memory of the wide tree over that of the binary one.
    pub fn memory_ratio(&self) -> f64 {
        self.built[1].megabytes / self.built[0].megabytes
    }
}

/// The rate of the wide tree over that of the binary one.
pub fn speed_up(pair: &[Shot; 2]) -> f64 {
    pair[1].krays / pair[0].krays
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ratios that the paper prints itself, against slips of the pen.
    #[test]
    fn ratios_are_those_that_the_paper_prints() {
        let hundredths = |x: f64| (x * 100.0).round() / 100.0;
        let of = |f: fn(&Scene) -> f64| SCENES.each_ref().map(|scene| hundredths(f(scene)));
        assert_eq!(of(|scene| speed_up(&scene.closest)), [2.61, 2.06, 1.67, 1.96]);
        assert_eq!(of(|scene| speed_up(&scene.shadow)), [2.84, 2.52, 2.25, 2.39]);
        assert_eq!(of(Scene::memory_ratio), [0.81, 0.79, 0.81, 0.80]);
        for scene in SCENES {
            let both = scene.simulated.zip(scene.potential);
            for (i, lanes) in [4.0, 8.0, 16.0].into_iter().enumerate() {
                assert!(both.is_none_or(|(one, all)| hundredths(one[i] * lanes) == all[i]));
            }
        }
    }
}
