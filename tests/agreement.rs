//! Every structure of the table answers as brute force does, to the bit.

use std::sync::Arc;

use dapple::Isa;
use dapple::accel::{
    Accel, AccelSpec, AnyHit, Batch, ClosestHit, HitFilter, Tracer, VARIANTS, Values, build,
};
use dapple::geom::{Triangle, TriangleList, TriangleSource};
use dapple::math::{Ray, Vec3};
use dapple::testing::{Random, RaySet, Target};
use rayon::prelude::*;

/// A row that is not at its defaults, yet asked at every instruction set: its lists are read by
/// different code at each.
const OCTANTS: &str = "mbvh8:build=esc,leaves=any,order=octant,triangles=cache,cache=1";

/// All structures with all choices of all their options.
fn specs() -> Vec<AccelSpec> {
    let mut specs = Vec::new();
    for variant in VARIANTS {
        specs.push(variant.id.to_owned());
        for option in variant.options {
            let id = variant.id;
            // Packets walk trees that are asked in all their forms under other names.
            let packets = ["size", "tiles"];
            let packets = variant.options.iter().any(|option| packets.contains(&option.name));
            if packets && ["build", "refine"].contains(&option.name) {
                continue;
            }
            match option.values {
                Values::Choice(words) => {
                    specs.extend(words.iter().map(|word| format!("{id}:{}={word}", option.name)));
                }
                // A cache of one line, in which every leaf takes another's place.
                Values::Bytes(least) => {
                    specs.push(format!("{id}:triangles=cache,{}={least}", option.name));
                }
                Values::Integer(..) | Values::Number(..) => {}
            }
        }
    }
    specs.push("bvh2:build=sbvh,refine=on".to_owned());
    specs.push("bvh-path-compression:build=sbvh,with=partition,per-packet=on".to_owned());
    specs.push("mbvh8:build=sbvh,refine=on,leaves=any".to_owned());
    specs.push("mbvh4:build=direct,order=octant,triangles=cache,cache=1".to_owned());
    specs.push(OCTANTS.to_owned());
    specs.iter().map(|spec| spec.parse().expect("made from the table")).collect()
}

fn soup(count: usize, size: f32, scale: f32) -> Vec<Triangle> {
    (0..count)
        .map(|i| {
            let random = &mut Random::new(7, i as u64);
            let at = random.cube();
            let corner = |random: &mut Random| (at + (random.cube() - 0.5) * size) * scale;
            Triangle { a: corner(random), b: corner(random), c: corner(random) }
        })
        .collect()
}

/// A sheet of squares, each of two triangles, in the plane z = `z`.
fn sheet(n: usize, z: f32) -> Vec<Triangle> {
    let p = |x: usize, y: usize| Vec3::new(x as f32, y as f32, z);
    (0..n * n)
        .flat_map(|i| {
            let (x, y) = (i % n, i / n);
            let (a, b, c, d) = (p(x, y), p(x + 1, y), p(x + 1, y + 1), p(x, y + 1));
            [Triangle { a, b, c }, Triangle { a, b: c, c: d }]
        })
        .collect()
}

fn scenes() -> Vec<(&'static str, Vec<Triangle>)> {
    let twins: Vec<_> = soup(200, 0.3, 1.0).into_iter().flat_map(|t| [t, t]).collect();
    let one = Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Y };
    let mut cube = sheet(8, 0.0);
    let turned = |t: &Triangle, f: fn(Vec3) -> Vec3| Triangle { a: f(t.a), b: f(t.b), c: f(t.c) };
    let sides: [fn(Vec3) -> Vec3; 3] =
        [|p| Vec3::new(p.x, p.y, 8.0), |p| Vec3::new(0.0, p.x, p.y), |p| Vec3::new(p.y, 8.0, p.x)];
    for side in sides {
        let moved: Vec<_> = cube[..128].iter().map(|t| turned(t, side)).collect();
        cube.extend(moved);
    }
    vec![
        ("none", vec![]),
        ("one", vec![one]),
        ("copies", vec![one; 70]),
        ("flat", vec![Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::X * 3.0 }; 20]),
        ("few", soup(30, 0.6, 1.0)),
        ("some", [soup(20, 0.9, 1.0), soup(20, 0.1, 1.0), sheet(3, 0.5)].concat()),
        ("few and tiny", soup(12, 0.6, 1e-11)),
        ("few and huge", soup(12, 0.6, 1e11)),
        (
            "few and odd",
            [
                soup(6, 0.6, 1.0),
                sheet(1, -0.0),
                sheet(1, 1e-7),
                vec![
                    one,
                    one,
                    Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::X * 3.0 },
                    Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::new(0.5, 1e-6, 0.0) },
                    Triangle { a: Vec3::ONE, b: Vec3::ONE, c: Vec3::ONE },
                ],
                soup(6, 1e-4, 1.0),
            ]
            .concat(),
        ),
        ("soup", soup(2000, 0.2, 1.0)),
        ("big and small", [soup(50, 2.0, 1.0), soup(500, 0.01, 1.0)].concat()),
        ("twins", twins),
        ("sheet", sheet(16, 0.0)),
        ("sheets", [sheet(8, -0.0), sheet(8, 1e-7), sheet(8, 1.0)].concat()),
        ("cube", cube),
        ("tiny", soup(300, 0.3, 1e-20)),
        ("huge", soup(300, 0.3, 1e20)),
        (
            "far away",
            soup(300, 0.3, 1.0).iter().map(|t| turned(t, |p| p + Vec3::splat(1e6))).collect(),
        ),
        (
            "exponential",
            (0..120)
                .map(|i| {
                    let s = f32::from_bits(((i + 4) as u32) << 23);
                    Triangle { a: Vec3::X * s, b: Vec3::new(s, s, 0.0), c: Vec3::new(s, 0.0, s) }
                })
                .collect(),
        ),
    ]
}

#[test]
fn every_structure_answers_as_brute_force_does() {
    let isas: Vec<Isa> = Isa::available().collect();
    let octants = OCTANTS.parse::<AccelSpec>().expect("a row with its options").to_string();
    for (name, triangles) in scenes() {
        let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(triangles));
        let oracle = build(&"brute".parse().expect("known"), Arc::clone(&source), Isa::Auto)
            .expect("brute force has no limits");
        let target = Target::new(&*source, &*oracle);
        let rays: Vec<Ray> = RaySet::ALL
            .into_iter()
            .flat_map(|set| target.rays(set, if set == RaySet::Hostile { 3000 } else { 400 }, 1))
            .collect();
        let expected = [false, true].map(|sieved| {
            let mut hits = vec![ClosestHit::MISS; rays.len()];
            let sieve = Sieve { first: 0 };
            let filter = sieved.then_some(&sieve as &dyn HitFilter);
            oracle.tracer().closest_hits(&Batch::new(&rays).with_filter(filter), &mut hits);
            hits
        });
        if !["none", "flat", "exponential"].contains(&name) {
            let [all, sieved] = &expected;
            assert!(all.iter().any(ClosestHit::is_hit), "no ray hits {name}");
            assert_ne!(all, sieved, "no hit of {name} is taken back");
        }
        specs().par_iter().for_each(|spec| {
            // The product of options and instruction sets is left to rows at their defaults.
            let plain = spec.to_string() == spec.variant.id || spec.to_string() == octants;
            let telling = ["soup", "copies", "sheets", "cube", "huge", "exponential"];
            if !plain && !telling.contains(&name) {
                return;
            }
            for (i, &isa) in isas.iter().enumerate() {
                // The sets between stand for the baseline: one row shows that they can be chosen.
                let between = matches!(isa, Isa::Sse2 | Isa::Sse42);
                let best = i + 1 == isas.len();
                if !(best || plain && (!between || spec.variant.id == "bvh2")) {
                    continue;
                }
                let accel = build(spec, Arc::clone(&source), isa).expect("small scenes build");
                // Short slices once: what they could break does not depend on the lanes.
                let short: &[usize] = &[1, 2, 3, 7, 17, 33, 257];
                let short = if plain && best { short } else { &[] };
                for &slice in short.iter().chain(&[rays.len()]) {
                    check(
                        &format!("{name}, {spec}, {isa}, {slice}"),
                        &*accel,
                        &rays,
                        &expected,
                        slice,
                    );
                }
            }
        });
    }
}

/// Takes back every third hit or so, by ray and triangle; the ray's number is that of all rays.
struct Sieve {
    /// Number of the slice's first ray.
    first: usize,
}

impl HitFilter for Sieve {
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool {
        let mixed = ((self.first + ray) as u32).wrapping_mul(0x9e37_79b9) ^ hit.triangle.index;
        mixed.wrapping_mul(0x85eb_ca6b) >> 8 & 3 != 0
    }
}

/// Holds a structure's answers against brute force's to all rays: without and with the sieve.
fn check(
    what: &str,
    accel: &dyn Accel,
    rays: &[Ray],
    expected: &[Vec<ClosestHit>; 2],
    slice: usize,
) {
    let [all, passed] = expected;
    let (mut tracer, mut counting) = (accel.tracer(), accel.counting_tracer());
    if slice < rays.len() {
        // A part only; what short slices could break does not depend on the ray.
        let rays = &rays[..rays.len().min(slice * 60)];
        check_answers(what, &mut *tracer, rays, passed, slice, true);
        return;
    }
    check_answers(what, &mut *tracer, rays, all, slice, false);
    check_answers(&format!("{what}, sieved"), &mut *tracer, rays, passed, slice, true);
    check_answers(&format!("{what}, counting"), &mut *counting, rays, all, slice, false);
}

fn check_answers(
    what: &str,
    tracer: &mut dyn Tracer,
    rays: &[Ray],
    expected: &[ClosestHit],
    slice: usize,
    sieved: bool,
) {
    let (mut hits, mut any) = (vec![ClosestHit::MISS; slice], vec![AnyHit(true); slice]);
    for (number, rays) in rays.chunks(slice).enumerate() {
        let sieve = Sieve { first: number * slice };
        let filter = sieved.then_some(&sieve as &dyn HitFilter);
        let batch = Batch::new(rays).with_filter(filter);
        tracer.closest_hits(&batch, &mut hits[..rays.len()]);
        tracer.any_hits(&batch, &mut any[..rays.len()]);
        for (i, (ray, expected)) in rays.iter().zip(&expected[sieve.first..]).enumerate() {
            let hit = &hits[i];
            let i = sieve.first + i;
            assert!(hit.same_bits(expected), "{what}: ray {i} {ray:?}: {hit:?}, not {expected:?}");
            let any = any[i - sieve.first].0;
            assert_eq!(any, expected.is_hit(), "{what}: any hit of ray {i} {ray:?}");
        }
    }
}
