//! How far functions in lanes are from the truth, and that they are the same at every width.

use std::f64::consts::TAU;

use fearless_simd::Simd;

use super::{
    Float, Lanes, Lanes8, Lanes16, MAX_LANES, Scalar, Uint, atan2, exp, ln, pow, unit_circle,
};
use crate::simd::{Isa, vectorized};

/// Evenly spread over `[from, to]`.
fn range(from: f64, to: f64, count: usize) -> impl Iterator<Item = f32> {
    (0..=count).map(move |i| (from + (to - from) * i as f64 / count as f64) as f32)
}

#[test]
fn the_unit_circle_is_round() {
    let turns = range(-2.0, 2.0, 400_001).chain(range(-1000.0, 1000.0, 100_003));
    let mut worst = 0.0_f64;
    for turns in turns.chain([0.0, -0.0, 1e-30]) {
        let (x, y) = unit_circle::<Scalar>(turns);
        let (sin, cos) = libm::sincos(f64::from(turns) * TAU);
        worst = worst.max((f64::from(x) - cos).abs()).max((f64::from(y) - sin).abs());
        // Near the axes also against the lesser coordinate.
        if turns.abs() < 0.1 && sin != 0.0 {
            assert!((f64::from(y) / sin - 1.0).abs() < 3e-7, "{turns}");
        }
    }
    assert!(worst < 1.5e-7, "{worst:e}");
}

#[test]
fn angles_are_those_of_their_points() {
    let mut worst = 0.0_f64;
    let radii = [1e-30, 0.7, 1e15];
    for (turns, radius) in range(-0.5, 0.5, 100_003).flat_map(|turns| radii.map(|r| (turns, r))) {
        let (sin, cos) = libm::sincos(f64::from(turns) * TAU);
        let (y, x) = ((radius * sin) as f32, (radius * cos) as f32);
        let truth = libm::atan2(f64::from(y), f64::from(x));
        let found = f64::from(atan2(Scalar, y, x));
        worst = worst.max((found - truth).abs());
        if x > 0.0 && y != 0.0 {
            assert!((found / truth - 1.0).abs() < 4e-7, "{turns}");
        }
    }
    assert!(worst < 3e-7, "{worst:e}");
    let axes = [(0.0, 0.0), (0.0, 1.0), (0.0, -1.0), (-0.0, -1.0), (1.0, 0.0), (-1.0, 0.0)];
    for (y, x) in axes {
        let truth = libm::atan2(f64::from(y), f64::from(x));
        assert!((f64::from(atan2(Scalar, y, x)) - truth).abs() < 3e-7, "{y} {x}");
    }
}

#[test]
fn exponentials_and_logarithms_are_those_of_f64() {
    let mut worst = 0.0_f64;
    for x in range(-87.3, 88.7, 500_001).chain(range(-0.01, 0.01, 1000)) {
        let truth = libm::exp(f64::from(x));
        worst = worst.max((f64::from(exp(Scalar, x)) / truth - 1.0).abs());
    }
    assert!(worst < 2e-7, "{worst:e}");
    let (inf, nan) = (f32::INFINITY, f32::NAN);
    assert_eq!([-inf, -200.0, 0.0, 90.0, inf].map(|x| exp(Scalar, x)), [0.0, 0.0, 1.0, inf, inf]);
    assert!(exp(Scalar, nan).is_nan());
    assert!((exp(Scalar, -100.0) / 3.7835e-44 - 1.0).abs() < 0.02);

    worst = 0.0;
    let all = range(-140.0, 127.9, 300_001).map(|x| libm::exp2(f64::from(x)) as f32);
    for x in all.chain(range(0.5, 2.0, 100_000)) {
        let truth = libm::log(f64::from(x));
        worst = worst.max((f64::from(ln(Scalar, x)) - truth).abs() / truth.abs().max(1.0));
    }
    assert!(worst < 1e-7, "{worst:e}");
    assert_eq!([0.0, -0.0, 1.0, inf].map(|x| ln(Scalar, x)), [-inf, -inf, 0.0, inf]);
    assert!(ln(Scalar, nan).is_nan() && ln(Scalar, -1.0).is_nan() && ln(Scalar, -1e-40).is_nan());
}

#[test]
fn powers_are_those_of_f64() {
    for x in range(0.001, 1.5, 500).chain([1e-20, 1e20]) {
        for y in range(-20.0, 20.0, 500) {
            let logarithm = libm::log(f64::from(x)) * f64::from(y);
            if logarithm.abs() < 87.0 {
                let found = f64::from(pow(Scalar, x, y)) / libm::exp(logarithm) - 1.0;
                assert!(found.abs() < 2e-7 + 1.5e-7 * logarithm.abs(), "{x}^{y}: {found:e}");
            }
        }
    }
    let inf = f32::INFINITY;
    let corners = [(0.0, 0.0), (0.0, 2.0), (1.0, 1e30), (1.0, inf), (0.5, inf), (0.0, inf)];
    assert_eq!(corners.map(|(x, y)| pow(Scalar, x, y)), [1.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
}

const RESULTS: usize = 6;

/// Bits by function and lane, any NaN the same.
#[inline(always)]
fn compute<L: Lanes>(
    lanes: L,
    a: &[f32; MAX_LANES],
    b: &[f32; MAX_LANES],
) -> [[u32; MAX_LANES]; RESULTS] {
    let (a, b) = (lanes.load(a), lanes.load(b));
    let (x, y) = unit_circle::<L>(a);
    let powers = pow(lanes, a.abs(), b);
    let results = [x, y, atan2(lanes, a, b), exp(lanes, b), ln(lanes, a), powers];
    results.map(|result| {
        let mut bits = [0; MAX_LANES];
        result.to_bits().store(&mut bits);
        bits.map(|bits| if f32::from_bits(bits).is_nan() { f32::NAN.to_bits() } else { bits })
    })
}

#[inline(always)]
fn check<S: Simd>(
    simd: S,
    a: &[f32; MAX_LANES],
    b: &[f32; MAX_LANES],
    plain: &[[u32; RESULTS]; MAX_LANES],
) {
    let same = |found: [[u32; MAX_LANES]; RESULTS], width: usize| {
        for (lane, plain) in plain.iter().enumerate().take(width) {
            assert_eq!(found.map(|bits| bits[lane]), *plain, "of {} and {}", a[lane], b[lane]);
        }
    };
    same(compute(Lanes8(simd), a, b), 8);
    same(compute(Lanes16(simd), a, b), 16);
}

#[test]
fn functions_give_the_same_bits_in_any_lanes() {
    let odd = [0.0, -0.0, 1.0, -1.0, 1e-42, -3e-20, f32::INFINITY, 77.7];
    for turn in 0..500 {
        let number = |lane: usize, k: usize| {
            let i = (turn * 37 + lane * 11 + k * 5) % 1009;
            let plain = (i as f32 - 500.0) * 0.037;
            if i.is_multiple_of(13) { odd[i / 13 % odd.len()] } else { plain }
        };
        let a: [f32; MAX_LANES] = std::array::from_fn(|lane| match number(lane, 0) {
            f32::INFINITY => 0.25, // no turns
            plain => plain,
        });
        let b: [f32; MAX_LANES] = std::array::from_fn(|lane| number(lane, 1));
        let plain: [[u32; RESULTS]; MAX_LANES] = std::array::from_fn(|lane| {
            compute(Scalar, &[a[lane]; MAX_LANES], &[b[lane]; MAX_LANES]).map(|bits| bits[0])
        });
        for isa in Isa::available() {
            let level = isa.level().expect("available");
            vectorized!(level, simd => check(simd, &a, &b, &plain));
        }
    }
}
