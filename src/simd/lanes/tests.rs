//! Each operation in lanes gives the bits of plain numbers.

use fearless_simd::Simd;

use super::{Float, Lanes, Lanes8, Lanes16, MAX_LANES, Mask, Rows, Scalar, Uint, Vec3f};
use crate::simd::{Isa, vectorized};

/// Numbers where operations go wrong: zeros, infinities, NaN, denormals, and plain ones.
const NUMBERS: [f32; MAX_LANES] = [
    0.0,
    -0.0,
    1.0,
    -1.5,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    1e-42,
    0.1,
    -0.3,
    1234.567,
    -7e8,
    3e-20,
    0.499_999_97,
    2.0,
    -2.5,
];

/// What some operations make of two numbers and an integer a lane, as bits.
#[inline(always)]
fn compute<L: Lanes>(lanes: L, a: L::Float, b: L::Float) -> [L::Uint; 16] {
    let small = (a.abs().lt(lanes.float(1e6))).select(a, lanes.float(3.7));
    let v = Vec3f::<L>::new(a, b, a + b);
    let hash = (a.to_bits() ^ (b.to_bits() >> 13)) * 0x7feb_352d + 77;
    [
        (a + b).to_bits(),
        (a - b * 0.3).to_bits(),
        (a / b).to_bits(),
        a.abs().sqrt().to_bits(),
        small.floor().to_bits(),
        a.least(b).to_bits(),
        a.most(b).to_bits(),
        a.copysign(b).to_bits(),
        small.to_int(),
        small.to_int().to_float().to_bits(),
        hash.reverse_bits(),
        hash.min(lanes.uint(0x8000_0000)),
        a.le(b).select_uint(hash, hash << 3),
        v.normalize(lanes).cross(v).x.to_bits(),
        (v.is_zero() | !v.is_finite(lanes)).select_uint(hash, lanes.uint(5)),
        (a.flip(hash) * b.eq(a).select(a, b)).to_bits(),
    ]
}

/// The bits of [`compute`], any NaN the same, by lane and operation.
#[inline(always)]
fn run<L: Lanes>(lanes: L, a: &[f32; MAX_LANES], b: &[f32; MAX_LANES], out: &mut [[u32; 16]]) {
    let mut column = [0; MAX_LANES];
    for (operation, value) in compute(lanes, lanes.load(a), lanes.load(b)).into_iter().enumerate() {
        value.store(&mut column);
        for (lane, bits) in column.iter().enumerate().take(L::WIDTH) {
            let nan = f32::from_bits(*bits).is_nan();
            out[lane][operation] = if nan { f32::NAN.to_bits() } else { *bits };
        }
    }
}

#[test]
fn lanes_compute_as_plain_numbers_do() {
    for turn in 0..MAX_LANES {
        let mut b = NUMBERS;
        b.rotate_left(turn);
        let mut plain = [[0; 16]; MAX_LANES];
        for lane in 0..MAX_LANES {
            let (a, b) = ([NUMBERS[lane]; MAX_LANES], [b[lane]; MAX_LANES]);
            run(Scalar, &a, &b, &mut plain[lane..=lane]);
        }
        for isa in Isa::available() {
            let level = isa.level().expect("available");
            vectorized!(level, simd => check(simd, &b, &plain));
        }
    }
}

#[inline(always)]
fn check<S: Simd>(simd: S, b: &[f32; MAX_LANES], plain: &[[u32; 16]; MAX_LANES]) {
    let mut out = [[0; 16]; MAX_LANES];
    run(Lanes8(simd), &NUMBERS, b, &mut out);
    assert_eq!(out[..8], plain[..8]);
    run(Lanes16(simd), &NUMBERS, b, &mut out);
    assert_eq!(out, *plain);
}

#[test]
fn rows_become_columns_and_rows_again() {
    #[inline(always)]
    fn there_and_back<L: Lanes>(lanes: L) {
        let mut rows: Rows = [[0.0; 4]; MAX_LANES];
        for (i, value) in rows.as_flattened_mut().iter_mut().enumerate() {
            *value = i as f32;
        }
        let columns = lanes.columns(&rows);
        let mut first = [0; MAX_LANES];
        columns[2].to_int().store(&mut first);
        for (lane, value) in first.iter().enumerate().take(L::WIDTH) {
            assert_eq!(*value as usize, 4 * lane + 2);
        }
        let mut back: Rows = [[-1.0; 4]; MAX_LANES];
        lanes.rows(columns, &mut back);
        assert_eq!(rows[..L::WIDTH], back[..L::WIDTH]);
        assert_eq!(lanes.first(1).to_bits(), 1);
        assert_eq!(lanes.first(L::WIDTH).to_bits(), ((1_u64 << L::WIDTH) - 1) as u32);
    }
    there_and_back(Scalar);
    for isa in Isa::available() {
        let level = isa.level().expect("available");
        vectorized!(level, simd => {
            there_and_back(Lanes8(simd));
            there_and_back(Lanes16(simd));
        });
    }
}
