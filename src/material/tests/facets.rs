//! What must hold for BSDFs on the facets of a shading normal.

use std::f32::consts::{FRAC_1_PI, PI};

use super::family::{LEAF, direction};
use crate::material::sample::mean;
use crate::material::{Bsdf, BsdfForm, FacetNumbers, FacetSample, Facets, OnFacet, SurfaceParams};
use crate::math::{Frame, Vec3};
use crate::sampling::chi_squared::assert_fits;
use crate::sampling::{Sampler, warp};

const WHITE: SurfaceParams = SurfaceParams {
    base_color: Vec3::ONE,
    metallic: 0.0,
    transmission: 0.0,
    diffuse_transmission: 0.0,
    diffuse_transmission_color: Vec3::ONE,
    thin: false,
    specular: 0.0,
    ..LEAF
};

fn metal(roughness: f32) -> SurfaceParams {
    SurfaceParams { metallic: 1.0, roughness, ..WHITE }
}

fn glass(roughness: f32) -> SurfaceParams {
    SurfaceParams {
        transmission: 1.0,
        specular: 1.0,
        specular_color: Vec3::ONE,
        roughness,
        ..WHITE
    }
}

fn bsdf(params: &SurfaceParams) -> Bsdf {
    Bsdf::new(params, BsdfForm::Conserving)
}

/// The facets of a triangle in the plane of x and y, which rises against x.
fn facets(slope: f32) -> Facets {
    let frame = Frame::from_normal(Vec3::new(slope, 0.0, 1.0).normalize());
    Facets::new(Vec3::Z, &frame).expect("not flat")
}

/// Follows way number `i` and visits each of its scatterings.
fn walk(
    (facets, bsdf): (&Facets, &Bsdf),
    viewer: Vec3,
    i: u64,
    mut visit: impl FnMut(&OnFacet),
) -> Option<FacetSample> {
    let mut sampler = Sampler::new(3, i, 21);
    let u_facet = sampler.next_1d();
    let numbers = |scattering: u32| {
        sampler.seek(4 + 4 * scattering);
        let direction = sampler.next_2d();
        FacetNumbers { direction, lobe: sampler.next_1d(), escape: sampler.next_1d() }
    };
    facets.walk(bsdf, viewer, u_facet, numbers, |_, on| visit(on))
}

/// What comes back to a viewer of the light from a direction, and the mean density of its being
/// sampled, over `count` ways.
fn eval(on: (&Facets, &Bsdf), viewer: Vec3, light: Vec3, count: u64) -> (Vec3, f32) {
    let (mut sum, mut density) = (Vec3::ZERO, 0.0);
    for i in 0..count {
        walk(on, viewer, i, |on| {
            let (value, pdf) = on.eval(light);
            sum += value;
            density += pdf;
        });
    }
    (sum / count as f32, density / count as f32)
}

fn any_direction(i: u64) -> Vec3 {
    warp::sphere(Sampler::new(i, 0, 2).next_2d())
}

/// White facets send all light back, or through, whatever their slope and wherever it comes from:
/// within .5 %, but for what chance adds where weights differ.
#[test]
fn white_furnaces_close() {
    const COUNT: u64 = 16_384;
    let kinds = [
        ("lambert", WHITE),
        ("smooth metal", metal(0.0)),
        ("metal", metal(0.3)),
        ("rough metal", metal(0.5)),
        ("coated", SurfaceParams { specular: 1.0, specular_color: Vec3::ONE, ..WHITE }),
        ("smooth glass", glass(0.0)),
        ("rough glass", glass(0.4)),
        ("paper", SurfaceParams { diffuse_transmission: 0.5, ..WHITE }),
    ];
    for (name, params) in kinds {
        let bsdf = bsdf(&params);
        for slope in [0.05, 0.25, 0.5, 1.0, 2.0] {
            let facets = facets(slope);
            for cos in [1.0, 0.5, 0.25, 0.05, -0.3] {
                for turned in [1.0, -1.0] {
                    let viewer = direction(cos) * Vec3::new(turned, turned, 1.0);
                    let weight = |i| {
                        let way = walk((&facets, &bsdf), viewer, i, |_| {});
                        way.map_or(0.0, |it| f64::from(mean(it.weight) * (it.eta * it.eta)))
                    };
                    let (albedo, error) = mean_and_error(COUNT, weight);
                    let off = (albedo - 1.0).abs();
                    let what = format!("{name}, slope {slope}, cosine {cos} {turned}: {albedo}");
                    assert!(error < 0.006 && off < 0.005 + 2.0 * error, "{what} +- {error}");
                }
            }
        }
    }
}

/// The light that diffuse facets return is that of radiosity between them: of each the light that
/// falls on it, and what of the other's light the crossed strings between their edges tell.
#[test]
fn diffuse_facets_shine_on_each_other() {
    let mut worst = 0.0_f32;
    for (slope, albedo) in [(0.3, 1.0), (1.0, 0.8), (2.0, 0.5)] {
        let facets = facets(slope);
        let bsdf = bsdf(&SurfaceParams { base_color: Vec3::splat(albedo), ..WHITE });
        let areas = [f32::hypot(1.0, slope), slope];
        let between = 0.5 * (areas[0] + areas[1] - 1.0);
        for i in 0..24 {
            let [viewer, light] = [2 * i, 2 * i + 1].map(|i| {
                let v = any_direction(i);
                Vec3::new(v.x, v.y, v.z.abs())
            });
            let lit = facets.shown(true, light).map(|area| area * facets.unblocked(true, light));
            // The radiosities b: areas * b = albedo * (lit + between * the other's b).
            let share = albedo * between;
            let determinant = areas[0] * areas[1] - share * share;
            let radiosities =
                [0, 1].map(|i| albedo * (areas[1 - i] * lit[i] + share * lit[1 - i]) / determinant);
            let seen = facets.shown(true, viewer).map(|a| a * facets.unblocked(true, viewer));
            let expected = (seen[0] * radiosities[0] + seen[1] * radiosities[1]) / viewer.z;
            let expected = expected * FRAC_1_PI;
            let (value, _) = eval((&facets, &bsdf), viewer, light, 8192);
            worst = worst.max((value.x - expected).abs() / expected.max(0.02));
        }
    }
    assert!(worst < 0.02, "{worst}");
}

/// As much light gets from one direction to another as back. By one scattering, that holds within
/// rounding; by all of them, in the mean.
#[test]
fn light_counts_alike_both_ways() {
    const COUNT: u64 = 8192;
    let (mut worst_once, mut worst, mut off, mut all) = (0.0_f32, 0.0_f64, 0.0, 0.0);
    for params in [WHITE, metal(0.4), metal(0.7), SurfaceParams { metallic: 0.5, ..metal(0.6) }] {
        let bsdf = bsdf(&params);
        for i in 0..50 {
            let geometric = any_direction(5 * i);
            let up = |v: Vec3| if v.dot(geometric) < 0.0 { -v } else { v };
            let [shading, a, b] = [1, 2, 3].map(|k| up(any_direction(5 * i + k)));
            let facets = Facets::new(geometric, &Frame::from_normal(shading)).expect("not flat");
            let on = (&facets, &bsdf);
            let [there, back] = [(a, b), (b, a)].map(|(viewer, light)| {
                let upright = geometric.dot(light);
                let of_way = |i| f64::from(way_value(on, viewer, light, i) / upright);
                (once(on, viewer, light) / upright, mean_and_error(COUNT, of_way))
            });
            worst_once = worst_once.max((there.0 - back.0).abs() / there.0.max(1e-3));
            let ((there, error), (back, other)) = (there.1, back.1);
            worst = worst.max((there - back).abs() / (error.hypot(other) + 1e-6));
            off += there - back;
            all += there;
        }
    }
    assert!(worst_once < 1e-4, "{worst_once}");
    assert!(worst < 4.5 && (off / all).abs() < 0.005, "{worst} {off} {all}");
}

/// What comes back of the light by way number `i`.
fn way_value(on: (&Facets, &Bsdf), viewer: Vec3, light: Vec3, i: u64) -> f32 {
    let mut sum = 0.0;
    walk(on, viewer, i, |on| sum += mean(on.eval(light).0));
    sum
}

/// The mean over ways and its standard error.
fn mean_and_error(count: u64, value: impl Fn(u64) -> f64) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for i in 0..count {
        let value = value(i);
        sum += value;
        squares += value * value;
    }
    let n = count as f64;
    (sum / n, ((squares / n - (sum / n) * (sum / n)).max(0.0) / n).sqrt())
}

/// What comes back by one scattering on either facet.
fn once((facets, bsdf): (&Facets, &Bsdf), viewer: Vec3, light: Vec3) -> f32 {
    let shown = facets.shown(true, viewer);
    let mut sum = 0.0;
    for i in 0..2 {
        let frame = &facets.frames[i];
        let (wo, wi) = (frame.to_local(viewer), frame.to_local(light));
        if wo.z > 0.0 && wi.z > 0.0 {
            let value = mean(bsdf.eval(wo, wi).0);
            sum += shown[i] / (shown[0] + shown[1]) * value * facets.unblocked(true, light);
        }
    }
    sum
}

/// Grid of cosines and azimuths that directions are counted in.
const COSINES: usize = 12;
const AZIMUTHS: usize = 12;

fn cell(wi: Vec3) -> usize {
    let slot = |x: f32, n: usize| ((x * n as f32) as usize).min(n - 1);
    let azimuth = libm::atan2f(wi.y, wi.x) / (2.0 * PI) + 0.5;
    slot(wi.z * 0.5 + 0.5, COSINES) * AZIMUTHS + slot(azimuth, AZIMUTHS)
}

/// Directions come as often as the densities of all scatterings say together.
#[test]
fn samples_follow_their_density() {
    const COUNT: u64 = 20_000;
    const PER_CELL: usize = 24;
    let kinds = [WHITE, metal(0.6), glass(0.7), LEAF];
    let views = [0.9, 0.3, -0.6];
    for params in kinds {
        let bsdf = bsdf(&params);
        for (slope, cos) in [0.3, 1.5].into_iter().flat_map(|s| views.map(|cos| (s, cos))) {
            let facets = facets(slope);
            let on = (&facets, &bsdf);
            let mut counts = vec![0; COSINES * AZIMUTHS];
            for i in 0..COUNT {
                if let Some(it) = walk(on, direction(cos), i, |_| {}) {
                    assert!(it.direction.z != 0.0 && it.front == (it.direction.z > 0.0));
                    counts[cell(it.direction)] += 1;
                }
            }
            let (n, per_cell) = (COSINES * AZIMUTHS, PER_CELL * PER_CELL);
            let area = 4.0 * PI / (n * per_cell) as f32;
            let mut expected = vec![0.0; n];
            for (i, place) in (0..n * per_cell).enumerate() {
                let (row, column) = (place / (AZIMUTHS * PER_CELL), place % (AZIMUTHS * PER_CELL));
                let z = 2.0 * (row as f32 + 0.5) / (COSINES * PER_CELL) as f32 - 1.0;
                let turns = (column as f32 + 0.5) / (AZIMUTHS * PER_CELL) as f32 - 0.5;
                let ring = warp::unit_circle(turns) * (1.0 - z * z).sqrt();
                let wi = Vec3::new(ring.x, ring.y, z);
                let mut density = 0.0;
                for k in 0..8 {
                    let way = COUNT + (i * 8) as u64 + k;
                    walk(on, direction(cos), way, |on| density += on.eval(wi).1 / 8.0);
                }
                expected[cell(wi)] += f64::from(density * area) * COUNT as f64;
            }
            assert_fits(&counts, &expected, 24, &format!("{params:?}, {slope}, {cos}"));
        }
    }
}
