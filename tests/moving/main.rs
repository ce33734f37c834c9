//! Whatever moves while the shutter is open, each ray sees it as it is at its own time: every
//! structure as brute force over the triangles of that time, to the bit.

mod scenes;

use std::sync::Arc;

use dapple::accel::HitFilter;
use dapple::geom::{Triangle, TriangleList, TriangleSource};
use dapple::math::{DVec3, PrimId, Ray, Vec3};
use dapple::motion::Motion;
use dapple::scene::Triangles;
use dapple::testing::Random;
use dapple::{AccelSpec, AnyHit, Batch, ClosestHit, Isa, Scene, VARIANTS, build};
use scenes::{bodies, crowd, many_copies, scene, small, turning};

/// The times of the rays, in turn; some beside those at which things jump.
const TIMES: [f32; 12] = [
    0.0,
    0.125,
    0.33,
    0.399_999_98,
    0.400_000_03,
    0.5_f32.next_down(),
    0.5,
    0.666,
    0.75,
    0.999,
    1.0_f32.next_down(),
    1.0,
];

/// Rays at what is there at their times, each with its time.
fn rays(triangles: &Triangles, count: u32) -> (Vec<Ray>, Vec<f32>) {
    let times: Vec<f32> = (0..count).map(|i| TIMES[i as usize % TIMES.len()]).collect();
    let ray = |i: u32| {
        let random = &mut Random::new(9, u64::from(i));
        let prim = PrimId(random.below(triangles.len()) as u32);
        let seen = triangles.of_at(triangles.locate(prim), times[i as usize]);
        let target = match i % 3 {
            0 => seen.a,
            1 => (seen.a + seen.b) * 0.5,
            _ => (seen.a + seen.b + seen.c) / 3.0,
        };
        let from = target + random.sphere() * if i.is_multiple_of(5) { 300.0 } else { 4.0 };
        // Some end behind what they are aimed at, and some just before.
        let t_max = [1.5, 0.999, f32::INFINITY, f32::INFINITY][i as usize % 4];
        if i % 50 == 7 { Ray::MISS } else { Ray::new(from, target - from, 0.0, t_max) }
    };
    ((0..count).map(ray).collect(), times)
}

/// What brute force finds of all triangles as they are at the rays' times.
fn oracle(triangles: &Triangles, rays: &[Ray], times: &[f32]) -> Vec<ClosestHit> {
    let mut found = vec![ClosestHit::MISS; rays.len()];
    for time in TIMES {
        let prims = (0..triangles.len() as u32).map(PrimId);
        let of_time: Vec<Triangle> =
            prims.map(|prim| triangles.of_at(triangles.locate(prim), time)).collect();
        let spec: AccelSpec = "brute".parse().expect("a row of the table");
        let brute = build(&spec, Arc::new(TriangleList(of_time)), Isa::Auto).expect("builds");
        let numbers: Vec<usize> = (0..rays.len()).filter(|&i| times[i] == time).collect();
        let of_time: Vec<Ray> = numbers.iter().map(|&i| rays[i]).collect();
        let mut hits = vec![ClosestHit::MISS; of_time.len()];
        brute.tracer().closest_hits(&Batch::new(&of_time), &mut hits);
        for (number, mut hit) in numbers.into_iter().zip(hits) {
            if hit.is_hit() {
                hit.triangle = triangles.locate(PrimId(hit.triangle.index));
            }
            found[number] = hit;
        }
    }
    found
}

fn compare(spec: &str, triangles: &Arc<Triangles>, (rays, times): (&[Ray], &[f32])) {
    let expected = oracle(triangles, rays, times);
    let spec: AccelSpec = spec.parse().expect("a row of the table");
    let accel = build(&spec, triangles.clone(), Isa::Auto).expect("builds");
    let batch = Batch::new(rays).with_times(Some(times));
    let mut hits = vec![ClosestHit::MISS; rays.len()];
    let mut any = vec![AnyHit(false); rays.len()];
    accel.tracer().closest_hits(&batch, &mut hits);
    accel.tracer().any_hits(&batch, &mut any);
    for (i, expected) in expected.iter().enumerate() {
        let (hit, time) = (hits[i], times[i]);
        assert!(hit.same_bits(expected), "{spec}, ray {i} at {time}: {hit:?}, not {expected:?}");
        assert_eq!(any[i].0, expected.is_hit(), "{spec}, ray {i} at {time}");
    }
}

#[test]
fn every_row_sees_what_moves_as_brute_force_does_at_each_rays_time() {
    let triangles = Arc::new(Triangles::new(Arc::new(scene())).expect("few"));
    let (rays, times) = rays(&triangles, 500);
    let expected = oracle(&triangles, &rays, &times);
    let moving = expected.iter().filter(|hit| hit.is_hit() && hit.triangle.instance.0 > 3).count();
    assert!(moving > 100, "{moving} rays hit what moves");
    for variant in VARIANTS {
        for instances in ["flat", "two-level"] {
            let spec = format!("{}:instances={instances}", variant.id);
            compare(&spec, &triangles, (&rays, &times));
        }
    }
}

#[test]
fn a_crowd_is_seen_as_brute_force_sees_it() {
    let triangles = Arc::new(Triangles::new(Arc::new(crowd())).expect("few"));
    let (rays, times) = rays(&triangles, 1000);
    for spec in ["auto", "mbvh8", "mbvh4", "bvh2"] {
        for instances in ["flat", "two-level"] {
            compare(&format!("{spec}:instances={instances}"), &triangles, (&rays, &times));
        }
    }
}

#[test]
fn what_moves_among_many_copies_is_seen_as_brute_force_sees_it() {
    let triangles = Arc::new(Triangles::new(Arc::new(many_copies())).expect("few"));
    let (rays, times) = rays(&triangles, 300);
    compare("mbvh8:instances=two-level", &triangles, (&rays, &times));
}

#[test]
fn small_things_are_seen_as_brute_force_sees_them() {
    for count in 1..=4 {
        let triangles = Arc::new(Triangles::new(Arc::new(small(count))).expect("few"));
        let (rays, times) = rays(&triangles, 1200);
        for row in ["auto", "mbvh8", "mbvh8:triangles=indexed", "mbvh8:triangles=cache", "bvh2"] {
            for instances in ["flat", "two-level"] {
                let options = if row.contains(':') { "," } else { ":" };
                compare(
                    &format!("{row}{options}instances={instances}"),
                    &triangles,
                    (&rays, &times),
                );
            }
        }
    }
}

#[test]
fn bodies_are_seen_as_brute_force_sees_them() {
    let triangles = Arc::new(Triangles::new(Arc::new(bodies())).expect("few"));
    let (rays, times) = rays(&triangles, 2000);
    for row in ["auto", "mbvh8", "mbvh8:triangles=cache", "mbvh4"] {
        for instances in ["flat", "two-level"] {
            let options = if row.contains(':') { "," } else { ":" };
            let spec = format!("{row}{options}instances={instances}");
            compare(&spec, &triangles, (&rays, &times));
        }
    }
}

/// Lets two thirds of all hits count, by ray and triangle.
struct SomeHits;

impl HitFilter for SomeHits {
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool {
        !(ray + hit.triangle.index as usize).is_multiple_of(3)
    }
}

#[test]
fn filters_are_asked_about_the_batchs_own_rays() {
    for (scene, least) in [(crowd(), 150), (bodies(), 150), (small(4), 150)] {
        compare_filtered(scene, least);
    }
}

/// Holds rows against each other where a filter refuses some hits; so many are left at least.
fn compare_filtered(scene: Scene, least: usize) {
    let triangles = Arc::new(Triangles::new(Arc::new(scene)).expect("few"));
    let (mut rays, times) = rays(&triangles, 600);
    // A third passes by all that moves.
    for ray in rays.iter_mut().step_by(3) {
        *ray = Ray::new(Vec3::splat(900.0), Vec3::X, 0.0, f32::INFINITY);
    }
    let batch = Batch::new(&rays).with_times(Some(&times)).with_filter(Some(&SomeHits));
    let found = ["brute", "auto", "mbvh8", "bvh2"].map(|spec| {
        let spec: AccelSpec = format!("{spec}:instances=two-level").parse().expect("a row");
        let accel = build(&spec, triangles.clone(), Isa::Auto).expect("builds");
        let mut hits = vec![ClosestHit::MISS; rays.len()];
        let mut any = vec![AnyHit(false); rays.len()];
        accel.tracer().closest_hits(&batch, &mut hits);
        accel.counting_tracer().any_hits(&batch, &mut any);
        (hits, any)
    });
    assert!(found[0].0.iter().filter(|hit| hit.is_hit()).count() > least);
    for (hits, any) in &found {
        assert!(found[0].0.iter().zip(hits).all(|(a, b)| a.same_bits(b)));
        assert!(hits.iter().zip(any).all(|(hit, any)| hit.is_hit() == any.0));
    }
}

#[test]
fn rays_without_times_see_the_scene_as_the_shutter_opens() {
    let triangles = Arc::new(Triangles::new(Arc::new(scene())).expect("few"));
    let (rays, _) = rays(&triangles, 100);
    let accel = build(&AccelSpec::default(), triangles.clone(), Isa::Auto).expect("builds");
    let mut hits = vec![ClosestHit::MISS; rays.len()];
    accel.tracer().closest_hits(&Batch::new(&rays), &mut hits);
    let expected = oracle(&triangles, &rays, &vec![0.0; rays.len()]);
    assert!(expected.iter().any(ClosestHit::is_hit));
    assert!(hits.iter().zip(&expected).all(|(hit, expected)| hit.same_bits(expected)));
}

#[test]
fn a_change_of_any_key_changes_the_digest() {
    let digest = scene().digest();
    assert_eq!(digest, scene().digest());
    let mut other = scene();
    let motion = Motion::new([turning(DVec3::X, 0.5, [DVec3::ONE; 2], DVec3::Z)]).expect("moves");
    other.motion_mut().move_placement(4, Arc::new(motion));
    assert_ne!(digest, other.digest());
    let mut other = scene();
    other.motion = None;
    assert_ne!(digest, other.digest());
}
