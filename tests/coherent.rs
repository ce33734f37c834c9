//! Structures for many rays at once answer as brute force does where rays run side by side: rasters
//! of a camera outside, inside and amid the triangles, with a lens, cut by any slice.

use std::sync::Arc;

use dapple::Isa;
use dapple::accel::{
    Accel, AnyHit, Batch, ClosestHit, Counts, Event, HitFilter, Regions, Tracer, build,
};
use dapple::geom::{Shaft, Triangle, TriangleList, TriangleSource};
use dapple::math::{Aabb, Ray, Vec3};
use dapple::testing::Random;

const SPECS: &[&str] = &[
    "auto",
    "bvh-packet",
    "bvh-packet:size=5",
    "bvh-packet:build=sbvh,triangles=cache,cache=1",
    "bvh-partition",
    "bvh-partition:size=8",
    "bvh-entry-point",
    "bvh-path-compression",
    "bvh-path-compression:pc=recursive,with=partition,per-packet=on",
    "bvh-path-compression:with=single",
    "bvh-entry-point:with=single",
    "kd-packet",
    "kd-packet:size=2",
    "kd-packet:size=5",
    "kd-packet-ropes",
    "kd-omnidirectional",
    "kd-omnidirectional-origin:size=8",
    "kd-lcts",
    "kd-lcts:size=4",
    "kd-relevant-triangles",
    "kd-relevant-triangles:size=3",
    "kd-entry-point",
    "kd-entry-point:tiles=4",
    "kd-path-compression",
    "kd-path-compression:pc=recursive,size=8",
];

fn soup(count: usize, size: f32, scale: f32) -> Vec<Triangle> {
    (0..count)
        .map(|i| {
            let random = &mut Random::new(11, i as u64);
            let at = random.cube();
            let corner = |random: &mut Random| (at + (random.cube() - 0.5) * size) * scale;
            Triangle { a: corner(random), b: corner(random), c: corner(random) }
        })
        .collect()
}

/// A floor and a wall of twin squares, whose edges rays run along and whose hits tie.
fn room() -> Vec<Triangle> {
    let square = |i: usize, at: fn(f32, f32) -> Vec3| {
        let (x, y) = ((i % 8) as f32 / 8.0, (i / 8) as f32 / 8.0);
        let (a, b, c, d) = (at(x, y), at(x + 0.125, y), at(x + 0.125, y + 0.125), at(x, y + 0.125));
        [Triangle { a, b, c }, Triangle { a, b: c, c: d }]
    };
    let floor = (0..64).flat_map(|i| square(i, |x, y| Vec3::new(x, 0.0, y)));
    let wall = (0..64).flat_map(|i| square(i, |x, y| Vec3::new(x, y, 1.0)));
    let twins = (0..64).flat_map(|i| square(i, |x, y| Vec3::new(x, y, 1.0)));
    floor.chain(wall).chain(twins).collect()
}

/// A raster of `WIDTH` by `HEIGHT` pixels with so many rays in each.
fn raster(eye: Vec3, towards: Vec3, open: f32, lens: f32, each: usize, scale: f32) -> Vec<Ray> {
    let across = towards.cross(Vec3::Y).normalize();
    let up = across.cross(towards).normalize();
    (0..WIDTH * HEIGHT * each)
        .map(|i| {
            let (x, y) = (i / each % WIDTH, i / each / WIDTH);
            let random = &mut Random::new(3, i as u64);
            let jitter = if each > 1 { random.cube() } else { Vec3::splat(0.5) };
            let at = |place: usize, count: usize, jitter: f32| {
                ((place as f32 + jitter) / count as f32 - 0.5) * open
            };
            let towards = towards + across * at(x, WIDTH, jitter.x) + up * at(y, HEIGHT, jitter.y);
            let eye = eye + (random.cube() - 0.5) * lens;
            // Some end early, some are not there at all.
            let t_max = if i % 7 == 0 { 0.8 } else { f32::INFINITY };
            if i % 101 == 0 {
                Ray::MISS
            } else {
                Ray::new(eye * scale, towards * scale, 0.0, t_max)
            }
        })
        .collect()
}

const WIDTH: usize = 37;
const HEIGHT: usize = 21;

struct Sieve;

impl HitFilter for Sieve {
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool {
        (ray as u32).wrapping_mul(0x9e37_79b9).wrapping_add(hit.triangle.index * 0x85eb) >> 8 & 3
            != 0
    }
}

/// Answers in one slice with its raster.
fn answers(
    accel: &dyn Accel,
    rays: &[Ray],
    filter: Option<&dyn HitFilter>,
    counting: bool,
) -> (Vec<ClosestHit>, Vec<AnyHit>) {
    let mut tracer = if counting { accel.counting_tracer() } else { accel.tracer() };
    trace(&mut *tracer, rays, filter)
}

/// Answers in one slice with its raster, by a tracer that may be narrowed to a region.
fn trace(
    tracer: &mut dyn Tracer,
    rays: &[Ray],
    filter: Option<&dyn HitFilter>,
) -> (Vec<ClosestHit>, Vec<AnyHit>) {
    let batch = Batch::new(rays).with_grid(WIDTH as u32, HEIGHT as u32).with_filter(filter);
    let (mut hits, mut any) = (vec![ClosestHit::MISS; rays.len()], vec![AnyHit(true); rays.len()]);
    tracer.closest_hits(&batch, &mut hits);
    tracer.any_hits(&batch, &mut any);
    (hits, any)
}

#[test]
fn rasters_are_answered_as_brute_force_does() {
    let scenes = [
        ("soup", soup(3000, 0.2, 1.0), 1.0),
        ("few", soup(24, 0.6, 1.0), 1.0),
        ("dust", soup(10_000, 0.02, 1.0), 1.0),
        ("room", room(), 1.0),
        ("large", soup(500, 0.3, 1e15), 1e15),
        ("small", soup(500, 0.3, 1e-15), 1e-15),
    ];
    // The sets between stand for the baseline, which the portable one is as well.
    let isas: Vec<Isa> =
        Isa::available().filter(|isa| !matches!(isa, Isa::Sse2 | Isa::Sse42)).collect();
    for (name, triangles, scale) in scenes {
        let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(triangles));
        let structure = |spec: &str, isa| {
            build(&spec.parse().expect("known"), Arc::clone(&source), isa).expect("it builds")
        };
        let oracle = structure("brute", Isa::Auto);
        let views = [
            (Vec3::new(0.5, 0.5, -1.5), Vec3::new(0.0, 0.0, 1.0), 0.6, 0.0, 1),
            (Vec3::new(0.5, 0.4, 0.5), Vec3::new(0.3, -0.4, 1.0), 1.2, 0.0, 3),
            (Vec3::new(-1.0, 1.5, -0.7), Vec3::new(1.0, -0.8, 0.9), 0.3, 0.05, 1),
            (Vec3::new(0.5, 0.5, 0.5), Vec3::new(1.0, 0.0, 0.0), 0.1, 0.0, 9),
        ];
        for (number, (eye, towards, open, lens, each)) in views.into_iter().enumerate() {
            let rays = raster(eye, towards, open, lens, each, scale);
            let filters = [None, Some(&Sieve as &dyn HitFilter)];
            let expected = filters.map(|filter| answers(&*oracle, &rays, filter, false));
            let hit = expected[0].0.iter().filter(|hit| hit.is_hit()).count();
            let sparse = ["room", "few"].contains(&name) && number == 3;
            assert!(hit > 20 || sparse, "{name}, view {number}");
            for spec in SPECS {
                for &isa in &isas {
                    let accel = structure(spec, isa);
                    for (filter, expected) in filters.into_iter().zip(&expected) {
                        for counting in [false, true] {
                            let (hits, any) = answers(&*accel, &rays, filter, counting);
                            let what = format!("{name}, view {number}, {spec}, {isa}");
                            for (i, (hit, sure)) in hits.iter().zip(&expected.0).enumerate() {
                                assert!(hit.same_bits(sure), "{what}: ray {i} {hit:?} {sure:?}");
                            }
                            assert!(any == expected.1, "{what}: any hit");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn a_tracer_in_a_region_answers_rays_inside_and_outside_of_it() {
    let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(soup(3000, 0.2, 1.0)));
    let structure = |spec: &str| {
        build(&spec.parse().expect("known"), Arc::clone(&source), Isa::Auto).expect("it builds")
    };
    let eye = Vec3::new(0.5, 0.5, -1.5);
    // Around the raster, around a part of it, and aside.
    let corners = |half: f32, x: f32| {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(i, j)| Vec3::new(i * half + x, j * half, 1.0))
    };
    let shaft = |half: f32, x: f32| {
        Shaft::pyramid(Aabb::of_points([eye]), corners(half, x)).expect("a pyramid")
    };
    let rays = raster(eye, Vec3::Z, 0.6, 0.0, 4, 1.0);
    let expected = answers(&*structure("brute"), &rays, None, false);
    for id in ["bvh-packet", "kd-packet", "kd-lcts"] {
        assert!(structure(id).tracer().regions().is_none(), "{id}");
    }
    for spec in SPECS.iter().filter(|spec| spec.contains("entry") || spec.contains("path")) {
        let whole = structure(spec);
        let mut tracer = whole.tracer();
        let mut check = |what: &str, change: &dyn Fn(&mut dyn Regions)| {
            change(&mut *tracer.regions().expect("it can be narrowed"));
            let (hits, any) = trace(&mut *tracer, &rays, None);
            let same = hits.iter().zip(&expected.0).all(|(hit, sure)| hit.same_bits(sure));
            assert!(same && any == expected.1, "{spec}, {what}");
        };
        check("around", &|regions| regions.enter(&shaft(0.4, 0.0)));
        check("and once more", &|regions| regions.enter(&shaft(0.1, 0.1)));
        check("around again", &|regions| regions.leave());
        check("outside", &|regions| regions.leave());
        check("aside, where there is nothing", &|regions| regions.enter(&shaft(0.1, 40.0)));
        check("outside again, whatever is left", &|regions| {
            regions.leave();
            regions.leave();
        });
    }
}

/// What a raster counts in one slice.
fn counts(source: &Arc<dyn TriangleSource>, rays: &[Ray], spec: &str) -> Counts {
    let accel = build(&spec.parse().expect("known"), Arc::clone(source), Isa::Auto);
    let accel = accel.expect("it builds");
    let mut tracer = accel.counting_tracer();
    let batch = Batch::new(rays).with_grid(WIDTH as u32, HEIGHT as u32);
    tracer.closest_hits(&batch, &mut vec![ClosestHit::MISS; rays.len()]);
    tracer.counts()
}

#[test]
fn rays_that_run_side_by_side_share_their_nodes() {
    let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(soup(3000, 0.2, 1.0)));
    let eye = Vec3::new(0.5, 0.5, -1.5);
    let rays = raster(eye, Vec3::Z, 0.6, 0.0, 16, 1.0);
    let nodes = |spec: &str| counts(&source, &rays, spec)[Event::InnerNode];
    for single in ["bvh2", "kd-stack-direction"] {
        let of_single = nodes(single);
        let alike =
            SPECS.iter().filter(|spec| spec[..3] == single[..3] && !spec.contains("single"));
        for spec in alike.filter(|spec| !spec.contains("build")) {
            let share =
                match spec.split_once("size=").map_or(16, |(_, side)| side.parse().unwrap_or(8)) {
                    2 | 3 => 2,
                    4 | 5 => 4,
                    _ => 8,
                };
            let nodes = nodes(spec);
            assert!(nodes * share < of_single, "{spec}: {nodes} nodes, {single} {of_single}");
        }
    }
}

#[test]
fn what_shafts_spare_shows_in_the_counters() {
    // A wall of squares that are larger than a packet.
    let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(room()));
    let rays = raster(Vec3::new(0.2, 0.3, 0.1), Vec3::new(0.3, 0.2, 1.0), 0.2, 0.0, 1, 1.0);
    let count = |spec: &str, event: Event| counts(&source, &rays, spec)[event];
    let lanes = |spec: &str| count(spec, Event::TriangleLane);
    assert!(lanes("kd-relevant-triangles:size=8") < lanes("kd-lcts:size=8"));
    assert_eq!(lanes("kd-lcts:size=8"), lanes("kd-packet:size=8"), "the same leaves");
    let nodes = |spec: &str| count(spec, Event::InnerNode);
    assert!(nodes("kd-entry-point:tiles=16") < nodes("kd-packet"));
    // Small triangles everywhere.
    let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(soup(3000, 0.2, 1.0)));
    let rays = raster(Vec3::new(0.5, 0.5, -1.5), Vec3::Z, 0.6, 0.0, 1, 1.0);
    // The search for entry points goes from the root for each tile; with it, a compressed tree
    // takes fewer nodes.
    let nodes = |spec: &str| {
        let counts = counts(&source, &rays, spec);
        counts[Event::InnerNode] + counts[Event::Search]
    };
    let (compressed, entered) = (nodes("kd-path-compression"), nodes("kd-entry-point:tiles=16"));
    assert!(compressed < entered, "{compressed} {entered}");
}
