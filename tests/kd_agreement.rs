//! Every kd-tree gives brute force's answers to the bit.

mod kd_scenes;

use dapple::Isa;
use dapple::accel::{
    Accel, AccelSpec, AnyHit, Batch, ClosestHit, Event, VARIANTS, build, kd::LAYOUT,
    kd::build::OPTIONS,
};
use dapple::geom::TriangleSource;
use dapple::math::Ray;
use std::sync::Arc;

use kd_scenes::{hostile_rays, scenes};

fn accel(spec: &str, source: &Arc<dyn TriangleSource>) -> Box<dyn Accel> {
    let spec: AccelSpec = spec.parse().expect("the test's specs are well-formed");
    build(&spec, Arc::clone(source), Isa::Auto).expect("small scenes build")
}

fn closest(accel: &dyn Accel, rays: &[Ray]) -> Vec<ClosestHit> {
    let mut hits = vec![ClosestHit::MISS; rays.len()];
    accel.tracer().closest_hits(&Batch::new(rays), &mut hits);
    hits
}

fn any(accel: &dyn Accel, rays: &[Ray]) -> Vec<AnyHit> {
    let mut hits = vec![AnyHit(false); rays.len()];
    accel.tracer().any_hits(&Batch::new(rays), &mut hits);
    hits
}

fn agree(spec: &str, name: &str, source: &Arc<dyn TriangleSource>, rays: &[Ray]) {
    let (oracle, tree) = (accel("brute", source), accel(spec, source));
    let expected = closest(&*oracle, rays);
    let found = closest(&*tree, rays);
    let mismatches: Vec<_> =
        (0..rays.len()).filter(|&i| !expected[i].same_bits(&found[i])).collect();
    if let Some(&i) = mismatches.first() {
        panic!(
            "{spec}, {name}: {} of {} differ; ray {i} {:?}: {:?}, not {:?}",
            mismatches.len(),
            rays.len(),
            rays[i],
            found[i],
            expected[i]
        );
    }
    assert_eq!(any(&*oracle, rays), any(&*tree, rays), "{spec}, {name}");

    // No node is visited twice but on the way down again to another leaf.
    let report = tree.report();
    let bound = (report.nodes + report.leaves * (report.max_depth + 2)) as u64;
    let mut counting = tree.counting_tracer();
    let mut before = 0;
    for ray in rays.iter().take(500) {
        counting.closest_hits(&Batch::new(&[*ray]), &mut [ClosestHit::MISS]);
        let counts = counting.counts();
        let steps = counts[Event::InnerNode] + counts[Event::Leaf];
        assert!(steps - before <= bound, "{spec}, {name}: {ray:?}");
        before = steps;
    }
}

fn kd_ids() -> impl Iterator<Item = &'static str> {
    VARIANTS.iter().map(|variant| variant.id).filter(|id| id.starts_with("kd-"))
}

#[test]
fn all_ids_agree_with_brute_force_on_hostile_scenes_and_rays() {
    for (name, source) in scenes() {
        let rays = hostile_rays(&*source, 4000);
        for id in kd_ids() {
            agree(id, name, &source, &rays);
        }
    }
}

#[test]
fn all_builds_agree_with_brute_force() {
    for (name, source) in scenes() {
        let rays = hostile_rays(&*source, 1500);
        for value in OPTIONS[0].values.to_string().split('|') {
            for options in ["", ",leaf=8", ",depth=3", ",empty=0.8"] {
                for id in ["kd-stack-direction", "kd-wide"] {
                    agree(&format!("{id}:build={value}{options}"), name, &source, &rays);
                }
            }
        }
    }
}

#[test]
fn builds_by_layouts_agree_with_brute_force() {
    let ids = ["kd-stack-origin", "kd-stack-direction", "kd-stack-robust", "kd-branchless"];
    let scenes = scenes();
    for (name, source) in &scenes[..5] {
        let rays = hostile_rays(&**source, 400);
        for id in ids {
            for build in OPTIONS[0].values.to_string().split('|') {
                for layout in LAYOUT.values.to_string().split('|') {
                    agree(&format!("{id}:build={build},layout={layout}"), name, source, &rays);
                }
            }
        }
    }
}

#[test]
fn slices_of_any_length_and_all_instruction_sets_agree() {
    let scenes = scenes();
    let (_, source) = &scenes[0];
    let rays = hostile_rays(&**source, 33);
    let expected = closest(&*accel("brute", source), &rays);
    for id in kd_ids() {
        for isa in Isa::available() {
            let spec: AccelSpec = id.parse().expect("ids are well-formed specs");
            let tree = build(&spec, Arc::clone(source), isa).expect("it is available");
            for length in 1..=33 {
                let found = closest(&*tree, &rays[..length]);
                let same = found.iter().zip(&expected).all(|(a, b)| a.same_bits(b));
                assert!(same, "{id}, {isa}, {length} rays");
            }
        }
    }
}
