//! What environments send, and how directions to them are sampled.

use std::f32::consts::PI;

use super::{Environment, EnvironmentSample, Sun};
use crate::math::{DVec3, Vec2, Vec3};
use crate::sampling::warp;

/// Red towards -Z, green towards +X, blue above the rest; a bright sun somewhere.
fn image(rotate: f32) -> Environment {
    let (width, height) = (32, 16);
    let mut pixels = vec![[0.1, 0.1, 0.2]; width * height];
    for y in 6..11 {
        for x in 15..17 {
            pixels[y * width + x] = [5.0, 0.0, 0.0];
            pixels[y * width + x + 8] = [0.0, 5.0, 0.0];
        }
    }
    pixels[3 * width + 5] = [1000.0, 1000.0, 1000.0];
    Environment::image(width, height, pixels, 2.0, rotate)
}

#[test]
fn the_centre_looks_along_minus_z_with_plus_x_to_its_right() {
    let environment = image(0.0);
    assert_eq!(environment.radiance(Vec3::NEG_Z), Vec3::new(10.0, 0.0, 0.0));
    assert_eq!(environment.radiance(Vec3::X), Vec3::new(0.0, 10.0, 0.0));
    // Turned a quarter counter-clockwise seen from above, what was at +X stands at -Z.
    let turned = image(90.0);
    assert!(turned.radiance(Vec3::NEG_Z).distance(Vec3::new(0.0, 10.0, 0.0)) < 1e-3);
    assert!(turned.radiance(Vec3::NEG_X).distance(Vec3::new(10.0, 0.0, 0.0)) < 1e-3);
}

/// The integral over the sphere of radiance times `weight` of the direction, by samples of the
/// environment and as many uniform directions, each weighed by both densities.
fn integral(environment: &Environment, side: u32, weight: impl Fn(Vec3) -> f32) -> Vec3 {
    let even = warp::SPHERE_PDF;
    let (mut sum, mut count) = (DVec3::ZERO, 0.0);
    for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
        let u = (Vec2::new(i as f32, j as f32) + 0.5) / side as f32;
        if let Some(EnvironmentSample { direction, radiance, pdf }) = environment.sample(u) {
            sum += (radiance * weight(direction) / (pdf + even)).as_dvec3();
        }
        let direction = warp::sphere(u);
        let (radiance, pdf) = environment.radiance_and_pdf(direction);
        sum += (radiance * weight(direction) / (pdf + even)).as_dvec3();
        count += 1.0;
    }
    (sum / count).as_vec3()
}

#[test]
fn samples_agree_with_look_ups() {
    let environment = image(37.0);
    let mut agreeing = 0;
    for (i, j) in (0..128).flat_map(|i| (0..128).map(move |j| (i, j))) {
        let u = Vec2::new((i as f32 + 0.5) / 128.0, (j as f32 + 0.5) / 128.0);
        let sample = environment.sample(u).expect("no pole");
        let (radiance, pdf) = environment.radiance_and_pdf(sample.direction);
        // On the border of two cells, rounding may find the other one's density.
        agreeing += i32::from((pdf / sample.pdf - 1.0).abs() < 1e-3);
        assert!(radiance.distance(sample.radiance) < 0.01 * (1.0 + radiance.length()));
    }
    assert!(agreeing > 16200, "{agreeing} of 16384");
}

#[test]
fn samples_and_what_they_leave_out_integrate_to_the_mean() {
    let sun = Sun::new(Vec3::new(0.6, 0.8, 0.0), 5.0, Vec3::splat(20.0));
    for environment in [image(0.0), image(37.0), image(37.0).with_sun(sun)] {
        let mean = integral(&environment, 256, |_| 1.0) / (4.0 * PI);
        assert!(mean.distance(environment.mean()) < 0.02 * mean.length(), "{mean}");
    }
}

#[test]
fn a_sun_adds_its_light() {
    let sun = Sun::new(Vec3::new(0.6, 0.8, 0.0), 5.0, Vec3::splat(20.0));
    for behind in [0.0, 0.5] {
        let environment = Environment::constant(Vec3::splat(behind)).with_sun(sun);
        let (found, up) = (integral(&environment, 256, |d| d.y.max(0.0)), 16.0 + behind * PI);
        assert!((found.x / up - 1.0).abs() < 2e-3, "{found} {up}");
        assert!(!environment.is_constant());
    }
}

#[test]
fn a_black_image_can_be_sampled() {
    let black = Environment::image(2, 1, vec![[0.0; 3]; 2], 1.0, 0.0);
    let sample = black.sample(Vec2::splat(0.3)).expect("some direction");
    assert_eq!((sample.radiance, black.mean()), (Vec3::ZERO, Vec3::ZERO));
    assert!(sample.pdf > 0.0);
}

#[test]
fn images_next_to_black_can_be_sampled() {
    for dark in [1e-45, 3e-45, 1e-40, 1e-38] {
        for (width, height) in [(4, 3), (1, 1), (2, 1)] {
            let image =
                Environment::image(width, height, vec![[dark; 3]; width * height], 1.0, 0.0);
            let sample = image.sample(Vec2::splat(0.4)).expect("some direction");
            assert!(sample.pdf > 0.0 && sample.pdf.is_finite());
        }
    }
}
