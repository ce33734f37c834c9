//! All kd-trees test the same leaves along a ray, and what a policy changes shows in the counters.

mod kd_scenes;

use std::sync::Arc;

use dapple::Isa;
use dapple::accel::kd::OVER;
use dapple::accel::kd::build::OPTIONS;
use dapple::accel::kd::tree::KdTree;
use dapple::accel::{AccelSpec, Batch, ClosestHit, Counts, Event, Options, Steps};
use dapple::geom::{TriangleList, TriangleSource};
use dapple::math::{Ray, Vec3};

use kd_scenes::{Random, hostile_rays, scenes, soup};

/// Those that compare distances only; `kd-stack-robust` compares points.
const SAME: [&str; 13] = [
    "kd-stack-direction",
    "kd-stack-origin",
    "kd-branchless",
    "kd-sequential",
    "kd-ropes",
    "kd-rope-trees",
    "kd-restart",
    "kd-backtrack",
    "kd-sparse-boxes",
    "kd-push-down",
    "kd-short-stack:entries=2",
    "kd-spill:entries=2",
    "kd-prefetch",
];

fn tree(source: &Arc<dyn TriangleSource>, options: &str) -> KdTree {
    let options = Options::parse("kd", &OPTIONS, options).expect("the test's options are known");
    KdTree::build(source, &options, &Steps::untold()).expect("small scenes build")
}

/// What each ray counts by itself.
fn counts(tree: &KdTree, spec: &str, rays: &[Ray]) -> Vec<Counts> {
    let spec: AccelSpec = spec.parse().expect("the test's specs are well-formed");
    let (_, over) = OVER.iter().find(|(id, _)| *id == spec.variant.id).expect("it is a kd-tree");
    let level = Isa::Portable.level().expect("always available");
    let accel = over(tree, &spec.options, level).expect("it is not deep");
    rays.iter()
        .map(|ray| {
            let mut tracer = accel.counting_tracer();
            tracer.closest_hits(&Batch::new(&[*ray]), &mut [ClosestHit::MISS]);
            tracer.counts()
        })
        .collect()
}

fn random_rays(count: usize) -> Vec<Ray> {
    let mut random = Random(77);
    (0..count)
        .map(|_| {
            let (from, to) = (random.vector() * 1.5, random.vector());
            Ray::new(from, to - from, 0.0, f32::INFINITY)
        })
        .collect()
}

fn leaves_are_the_same(name: &str, source: &Arc<dyn TriangleSource>, build: &str, rays: &[Ray]) {
    let tree = tree(source, build);
    let expected = counts(&tree, SAME[0], rays);
    for spec in SAME {
        for (i, (found, expected)) in counts(&tree, spec, rays).iter().zip(&expected).enumerate() {
            for event in [Event::Leaf, Event::TriangleTest, Event::ExactTest] {
                assert_eq!(
                    found[event],
                    expected[event],
                    "{name}, {build}, {spec}: {} of ray {i} {:?}",
                    event.name(),
                    rays[i]
                );
            }
        }
    }
}

#[test]
fn all_walks_test_the_same_leaves() {
    let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(soup(2000, 0.1, 12)));
    leaves_are_the_same("soup", &source, "build=sah", &random_rays(100_000));
}

#[test]
fn all_walks_test_the_same_leaves_in_hostile_scenes() {
    for (name, source) in scenes() {
        let rays = hostile_rays(&*source, 1000);
        for build in ["build=sah", "build=minmax"] {
            leaves_are_the_same(name, &source, build, &rays);
        }
    }
}

#[test]
fn trees_of_all_builds_are_valid() {
    for (name, source) in scenes() {
        for build in ["sah", "minmax", "binned"] {
            for options in ["", ",leaf=8", ",depth=2", ",empty=0"] {
                let options = format!("build={build}{options}");
                let tree = tree(&source, &options);
                assert_eq!(tree.validate(), Ok(()), "{name}, {options}");
                assert!(tree.report.sah_cost.is_finite(), "{name}, {options}");
            }
        }
    }
}

/// All builds are greedy, so in a toy scene luck may beat the best choice; not in large ones.
#[test]
fn the_sweep_is_cheapest() {
    for (count, size) in [(5000, 0.05), (20_000, 0.02), (3000, 0.3)] {
        let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(soup(count, size, 16)));
        // Leaves as small as the heuristic likes them, so that it alone is compared, and dear
        // triangles: the more levels, the less luck.
        let cost = |build: &str| tree(&source, &format!("{build},leaf=1,cost=0.4")).report.sah_cost;
        let sah = cost("build=sah");
        for build in ["build=minmax", "build=binned"] {
            let other = cost(build);
            assert!(sah <= other, "{count} of size {size}: {sah}, but {build} {other}");
            assert!(other <= sah * 1.2, "{count} of size {size}: {sah}, but {build} {other}");
        }
    }
}

#[test]
fn the_number_of_threads_does_not_change_a_tree() {
    let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(soup(20_000, 0.05, 13)));
    for build in ["sah", "minmax", "binned"] {
        let trees: Vec<KdTree> = [1, 3]
            .into_iter()
            .map(|threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                pool.expect("threads start").install(|| tree(&source, &format!("build={build}")))
            })
            .collect();
        assert_eq!(trees[0].nodes, trees[1].nodes, "{build}");
    }
}

#[test]
fn policies_trade_nodes_for_memory_as_they_claim() {
    let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(soup(5000, 0.05, 14)));
    let tree = tree(&source, "build=minmax");
    let rays = random_rays(3000);
    let nodes = |spec: &str| -> u64 {
        counts(&tree, spec, &rays).iter().map(|c| c[Event::InnerNode]).sum()
    };
    let stack = nodes("kd-stack-direction");
    assert_eq!(nodes("kd-spill:entries=2"), stack);
    assert_eq!(nodes("kd-short-stack:entries=64"), stack);
    assert!(nodes("kd-ropes") < stack);
    assert!(nodes("kd-rope-trees") <= nodes("kd-ropes"));
    let (short, push_down, restart) =
        (nodes("kd-short-stack:entries=2"), nodes("kd-push-down"), nodes("kd-restart"));
    assert!(stack < short && short < push_down && push_down <= restart);
    assert_eq!(restart, nodes("kd-sequential"));
    assert!(nodes("kd-backtrack") < nodes("kd-sparse-boxes"));
    assert!(nodes("kd-sparse-boxes") < restart);
}

#[test]
fn a_hundred_thousand_copies_of_one_triangle_take_bounded_memory() {
    let one = soup(1, 0.5, 15)[0];
    let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(vec![one; 100_000]));
    for build in ["sah", "minmax", "binned"] {
        let tree = tree(&source, &format!("build={build}"));
        let listed = tree.report.mean_leaf * tree.report.leaves as f64;
        assert!(listed <= 800_000.0 && tree.report.max_depth < 40, "{build}: {listed}");
        let ray = Ray::new(Vec3::splat(-3.0), (one.a + one.b + one.c) / 3.0 + 3.0, 0.0, 9.0);
        assert_eq!(counts(&tree, "kd-stack-direction", &[ray])[0][Event::Restart], 0);
    }
}
