//! Environments in lanes give the bits of plain numbers.

use fearless_simd::Simd;

use super::{Environment, Sun};
use crate::math::Vec3;
use crate::sampling::{Sampler, warp};
use crate::simd::lanes::{Float, Lanes, Lanes8, Lanes16, MAX_LANES, Scalar, Uint, Vec3f};
use crate::simd::{Isa, vectorized};

/// Numbers by lane: a direction to look up, and a point of the unit square.
type Inputs = [[f32; MAX_LANES]; 5];
const RESULTS: usize = 11;

/// Bits by result and lane, any NaN the same.
#[inline(always)]
fn compute<L: Lanes>(
    lanes: L,
    environment: &Environment,
    inputs: &Inputs,
) -> [[u32; MAX_LANES]; RESULTS] {
    let [x, y, z, u, v] = inputs.each_ref().map(|input| lanes.load(input));
    let (radiance, pdf) = environment.radiance_and_pdf_in_lanes(lanes, Vec3f::new(x, y, z));
    let sample = environment.sample_in_lanes(lanes, [u, v]);
    let (a, b, d) = (radiance, sample.radiance, sample.direction);
    [a.x, a.y, a.z, pdf, b.x, b.y, b.z, sample.pdf, d.x, d.y, d.z].map(|result| {
        let mut bits = [0; MAX_LANES];
        result.to_bits().store(&mut bits);
        bits.map(|bits| if f32::from_bits(bits).is_nan() { f32::NAN.to_bits() } else { bits })
    })
}

#[inline(always)]
fn check<S: Simd>(
    simd: S,
    environment: &Environment,
    inputs: &Inputs,
    plain: &[[u32; RESULTS]; MAX_LANES],
) {
    let same = |found: [[u32; MAX_LANES]; RESULTS], width: usize| {
        for (lane, plain) in plain.iter().enumerate().take(width) {
            let input = inputs.map(|input| input[lane]);
            assert_eq!(found.map(|bits| bits[lane]), *plain, "of {input:?}");
        }
    };
    same(compute(Lanes8(simd), environment, inputs), 8);
    same(compute(Lanes16(simd), environment, inputs), 16);
}

/// The `lane`th direction and point of a turn: by chance, but now and then an axis, or a corner.
fn input(turn: u64, lane: u64) -> [f32; 5] {
    let mut sampler = Sampler::new(turn * 16 + lane, 0, 9);
    let mut direction = warp::sphere(sampler.next_2d());
    let mut u = sampler.next_2d().to_array();
    match (turn + lane) % 11 {
        0 => direction = [Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::X][turn as usize % 5],
        1 => u = [[0.0; 2], [1.0 - 0.5 * f32::EPSILON; 2], [0.5, 0.0]][turn as usize % 3],
        _ => {}
    }
    [direction.x, direction.y, direction.z, u[0], u[1]]
}

#[test]
fn environments_give_the_same_bits_in_any_lanes() {
    let sun = || Sun::new(Vec3::new(0.6, 0.64, -0.48), 70.0, Vec3::splat(4.0));
    let image = |width: usize, height: usize, turned: f32| {
        let pixel = |i: usize| [((i * 7919) % 13) as f32, ((i * 31) % 7) as f32 * 0.3, 1.0];
        let mut pixels: Vec<_> = (0..width * height).map(pixel).collect();
        pixels[width * height / 2] = [f32::NAN, f32::INFINITY, -1.0];
        Environment::image(width, height, pixels, 0.7, turned)
    };
    let all = [
        Environment::constant(Vec3::new(1.0, 2.0, 3.0)),
        Environment::constant(Vec3::ZERO).with_sun(sun()),
        Environment::constant(Vec3::ONE).with_sun(sun()),
        image(37, 20, 0.0),
        image(64, 32, 200.0),
        image(16, 9, 33.0).with_sun(sun()),
        image(1, 1, 0.0),
        image(2, 1, -70.0),
        image(1, 5, 0.0),
        Environment::image(4, 3, vec![[0.0; 3]; 12], 1.0, 0.0),
    ];
    for environment in &all {
        for turn in 0..100 {
            let lanes: [[f32; 5]; MAX_LANES] = std::array::from_fn(|lane| input(turn, lane as u64));
            let inputs = std::array::from_fn(|k| lanes.map(|input| input[k]));
            let plain = lanes.map(|input| {
                let input = input.map(|number| [number; MAX_LANES]);
                compute(Scalar, environment, &input).map(|bits| bits[0])
            });
            for isa in Isa::available() {
                let level = isa.level().expect("available");
                vectorized!(level, simd => check(simd, environment, &inputs, &plain));
            }
        }
    }
}
