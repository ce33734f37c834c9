//! Directions to lights come as often as their densities say.

use std::f32::consts::{PI, TAU};

use super::*;
use crate::geom::Triangle;
use crate::math::{Vec2, Vec3};
use crate::sampling::Sampler;
use crate::sampling::chi_squared::assert_fits;

/// Cells of equal solid angle that directions are counted in.
const HEIGHTS: usize = 24;
const AZIMUTHS: usize = 32;
/// Of a cell in each of its directions, to integrate over.
const STEPS: usize = 24;
const COUNT: u64 = 40_000;

fn cell(direction: Vec3) -> usize {
    let slot = |x: f32, n: usize| ((x * n as f32) as usize).min(n - 1);
    let azimuth = libm::atan2f(direction.z, direction.x) / TAU + 0.5;
    slot(direction.y * 0.5 + 0.5, HEIGHTS) * AZIMUTHS + slot(azimuth, AZIMUTHS)
}

/// Counts `sample`'s directions against `pdf` over solid angle.
fn assert_directions(
    sample: impl Fn(Vec2) -> Option<(Vec3, f32)>,
    pdf: impl Fn(Vec3) -> f32,
    family: usize,
    what: &str,
) {
    let mut counts = vec![0; HEIGHTS * AZIMUTHS];
    let mut told = 0.0;
    for i in 0..COUNT {
        let u = Sampler::independent(i, 0, 31).next_2d();
        let (direction, density) = sample(u).expect("it shines");
        counts[cell(direction)] += 1;
        told += (density / pdf(direction) - 1.0).abs().min(1.0) / COUNT as f32;
    }
    // At the edge of a disc, or of an image's cell, one of both may say that it is outside.
    assert!(told < 1e-2, "{what}: densities differ by {told} in the mean");
    let mut expected = vec![0.0; HEIGHTS * AZIMUTHS];
    let around = TAU / (AZIMUTHS * STEPS) as f32;
    for row in 0..HEIGHTS {
        // Even in the angle, since densities of images may rise without bound towards the poles.
        let angle = |row: usize| libm::acosf((2.0 * row as f32 / HEIGHTS as f32 - 1.0).min(1.0));
        let step = (angle(row) - angle(row + 1)) / STEPS as f32;
        for below in 0..STEPS {
            let (ring, y) = libm::sincosf(angle(row) - step * (below as f32 + 0.5));
            for column in 0..AZIMUTHS * STEPS {
                let (s, c) = libm::sincosf(around * (column as f32 + 0.5) - PI);
                let density = pdf(Vec3::new(ring * c, y, ring * s));
                expected[row * AZIMUTHS + column / STEPS] +=
                    f64::from(density * ring * step * around) * COUNT as f64;
            }
        }
    }
    let sum: f64 = expected.iter().sum::<f64>() / COUNT as f64;
    assert!((sum - 1.0).abs() < 2e-3, "{what}: the density integrates to {sum}");
    // What a grid makes of an edge is less than what chance makes of a cell.
    let expected: Vec<f64> = expected.iter().map(|count| count / sum + 1e-6).collect();
    assert_fits(&counts, &expected, family, what);
}

/// Eight by four pixels, one of them a hundred times as bright as the others.
fn image() -> Environment {
    let mut pixels: Vec<[f32; 3]> =
        (0..32).map(|i| [0.2 + 0.1 * (i % 5) as f32, 0.5, 0.1 * (i % 7) as f32]).collect();
    pixels[11] = [40.0, 50.0, 60.0];
    pixels[20] = [0.0; 3];
    Environment::image(8, 4, pixels, 1.0, 35.0)
}

#[test]
fn surroundings_are_chosen_with_the_density_told() {
    let sun = || Sun::new(Vec3::new(0.6, 0.64, -0.48), 50.0, Vec3::splat(4.0));
    let of = |width, values: &[f32], turned| {
        let pixels: Vec<[f32; 3]> = values.iter().map(|&value| [value, 1.0, 0.0]).collect();
        Environment::image(width, values.len() / width, pixels, 1.0, turned)
    };
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let all = [
        ("even", Environment::constant(Vec3::ONE)),
        ("image", image()),
        ("image with a sun", image().with_sun(sun())),
        ("even with a sun", Environment::constant(Vec3::ONE).with_sun(sun())),
        ("1x1", of(1, &[2.0], 77.0)),
        ("2x1", of(2, &[2.0, 0.5], -40.0)),
        ("1x2", of(1, &[2.0, 0.5], 0.0)),
        (
            "bright at the seam and a pole",
            of(3, &[0.0, 9.0, 9.0, 9.0, 0.0, 9.0, 3.0, 0.0, 0.0], 0.0),
        ),
        ("odd numbers", of(4, &[nan, 9.0, -inf, -5.0, 2.0, 0.0, 1.0, 70.0], 200.0)),
        ("infinite", of(4, &[1.0, inf, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0], 0.0)),
        ("black", Environment::image(2, 1, vec![[0.0; 3]; 2], 1.0, 0.0)),
        ("black with a sun", Environment::constant(Vec3::ZERO).with_sun(sun())),
    ];
    let count = all.len();
    for (name, environment) in all {
        let sample = |u| environment.sample(u).map(|sample| (sample.direction, sample.pdf));
        let pdf = |direction| environment.radiance_and_pdf(direction).1;
        assert_directions(sample, pdf, count, name);
    }
}

#[test]
fn the_sun_is_chosen_evenly_over_its_disc() {
    let sun = Sun::new(Vec3::new(-0.48, 0.6, 0.64), 80.0, Vec3::ONE);
    let pdf = |direction| if sun.covers(direction) { sun.pdf() } else { 0.0 };
    assert_directions(|u| Some((sun.sample(u), sun.pdf())), pdf, 1, "the sun");
}

/// Seen from a point, the density over solid angle is that over area, transformed.
#[test]
fn emitting_triangles_are_chosen_with_the_density_told() {
    let triangle = Triangle {
        a: Vec3::new(1.0, -0.7, -0.8),
        b: Vec3::new(0.8, 1.2, -0.4),
        c: Vec3::new(0.3, 0.4, 1.5),
    };
    let normal = triangle.double_area().normalize();
    let at = |point: Vec3, area: f32| {
        area_to_solid_angle(area, point.length_squared(), normal.dot(point.normalize()))
    };
    let sample = |u| {
        let sample = sample_triangle(&triangle, u);
        Some((sample.point.normalize(), at(sample.point, sample.area)))
    };
    let area = 0.5 * triangle.double_area().length();
    let pdf = |direction: Vec3| {
        let t = normal.dot(triangle.a) / normal.dot(direction);
        let point = direction * t;
        let corners = [triangle.a, triangle.b, triangle.c];
        let within = |k: usize| {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            (to - from).cross(point - from).dot(normal) >= -1e-6
        };
        if t > 0.0 && (0..3).all(within) { at(point, area) } else { 0.0 }
    };
    assert_directions(sample, pdf, 1, "a triangle");
}
