//! Renders whose result is known on paper.

mod stage;

use std::f32::consts::PI;

use dapple::Transport;
use dapple::camera::Camera;
use dapple::film::Window;
use dapple::light::{Environment, Punctual, PunctualKind};
use dapple::math::{Affine3A, Vec3};
use dapple::render::Settings;
use dapple::scene::{Material, Scene, Transform, Volume};
use stage::{assert_mean, flat_camera, lambert, mean, rectangle, run, scene, settings, sphere};

#[test]
fn a_white_sphere_in_a_white_world_is_invisible() {
    let mut scene = scene([(sphere(3), lambert(1.0))]);
    scene.environment = Some(Environment::constant(Vec3::ONE));
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y, 0.6);
    assert_mean(&run(scene, &camera, &settings(64, 64, 20)), 1.0);
}

#[test]
fn a_glass_sphere_in_a_white_world_is_invisible() {
    let glass = Material {
        metallic: 0.0,
        roughness: 0.0,
        transmission: 1.0,
        volume: Some(Volume { attenuation_color: Vec3::ONE, attenuation_distance: f32::INFINITY }),
        ..Material::default()
    };
    let mut scene = scene([(sphere(3), glass)]);
    scene.environment = Some(Environment::constant(Vec3::ONE));
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y, 0.6);
    assert_mean(&run(scene, &camera, &settings(64, 16, 200)), 1.0);
}

#[test]
fn a_glass_slab_absorbs_by_its_thickness() {
    let glass = |transmission: f32| Material {
        metallic: 0.0,
        roughness: 0.0,
        ior: 1.0, // nothing is reflected or refracted
        transmission,
        volume: Some(Volume { attenuation_color: Vec3::splat(0.5), attenuation_distance: 0.5 }),
        ..Material::default()
    };
    let top = rectangle(Vec3::Y * 0.75, Vec3::Z, Vec3::X);
    let bottom = rectangle(Vec3::ZERO, Vec3::X, Vec3::Z);
    let mut scene = scene([(top, glass(1.0)), (bottom, glass(1.0))]);
    scene.environment = Some(Environment::constant(Vec3::ONE));
    let camera = flat_camera(Vec3::Y * 3.0, Vec3::ZERO, 0.1);
    // 0.75 m of what halves light in 0.5 m.
    assert_mean(&run(scene, &camera, &settings(4, 4, 10)), libm::powf(0.5, 1.5));
}

/// An inward cube of emitters that also reflect: after d segments, radiance is the geometric sum.
#[test]
fn an_enclosure_of_glowing_walls_gains_by_depth() {
    let (emission, reflectance) = (0.25, 0.75);
    for depth in [1, 2, 3, 8] {
        let axes =
            [(Vec3::X, Vec3::Y, Vec3::Z), (Vec3::Y, Vec3::Z, Vec3::X), (Vec3::Z, Vec3::X, Vec3::Y)];
        let walls = axes.into_iter().flat_map(|(right, up, normal)| {
            [rectangle(-normal, right, up), rectangle(normal, up, right)]
        });
        let glowing = Material { emissive: Vec3::splat(emission), ..lambert(reflectance) };
        let scene = scene(walls.map(|wall| (wall, glowing.clone())));
        let camera = Camera::look_at(Vec3::new(0.1, 0.2, 0.3), Vec3::ONE, Vec3::Y, 1.5);
        let expected: f32 = (0..depth).map(|k| emission * libm::powf(reflectance, k as f32)).sum();
        assert_mean(&run(scene, &camera, &settings(32, 256, depth as u32)), expected);
    }
}

#[test]
fn roulette_does_not_change_the_mean() {
    let walls = [rectangle(Vec3::ZERO, Vec3::Z * 9.0, Vec3::X * 9.0), sphere(2)];
    let mut scene = scene(walls.map(|wall| (wall, lambert(0.5))));
    scene.environment = Some(Environment::constant(Vec3::ONE));
    let scene = || Scene {
        meshes: scene.meshes.clone(),
        instances: scene.instances.clone(),
        materials: scene.materials.clone(),
        environment: Some(Environment::constant(Vec3::ONE)),
        ..Scene::default()
    };
    let camera = Camera::look_at(Vec3::new(1.5, 1.5, 1.5), Vec3::ZERO, Vec3::Y, 1.0);
    let mut roulette = settings(64, 256, 20);
    roulette.transport.roulette_depth = Some(1);
    let (with, error) = mean(&run(scene(), &camera, &roulette).picture);
    let (without, other_error) = mean(&run(scene(), &camera, &settings(64, 256, 20)).picture);
    assert!((with - without).abs() < 3.0 * (error + other_error), "{with} {without}");
    assert!((with / without - 1.0).abs() < 0.005);
}

#[test]
fn punctual_lights_give_the_irradiance_of_the_books() {
    let ground = || rectangle(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0);
    let camera = flat_camera(Vec3::Y, Vec3::ZERO, 1e-3);
    let light = Punctual {
        kind: PunctualKind::Point,
        position: Vec3::new(3.0, 4.0, 0.0),
        direction: Vec3::new(-0.6, -0.8, 0.0),
        intensity: Vec3::splat(50.0),
        range: None,
    };
    // 5 m away, cosine 0.8.
    for (kind, irradiance) in [
        (PunctualKind::Point, 50.0 / 25.0 * 0.8),
        (PunctualKind::Spot { inner: 0.2, outer: 0.3 }, 50.0 / 25.0 * 0.8),
        (PunctualKind::Directional, 50.0 * 0.8),
    ] {
        let mut scene = scene([(ground(), lambert(0.6))]);
        scene.lights.push(Punctual { kind, ..light });
        let rendered = run(scene, &camera, &settings(2, 4, 5));
        let (found, _) = mean(&rendered.picture);
        let expected = 0.6 / PI * irradiance;
        assert!((found / expected - 1.0).abs() < 1e-3, "{kind:?}: {found}, not {expected}");
    }
}

#[test]
fn a_square_light_gives_its_form_factor() {
    // From a point to a parallel square right above, half as high as wide: four times the factor
    // of a quarter, a / h = b / h = 1 (any text book on radiative heat transfer).
    let root = 2.0_f32.sqrt();
    let quarter = 1.0 / (2.0 * PI) * 2.0 * (1.0 / root) * libm::atanf(1.0 / root);
    let ground = rectangle(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0);
    let lamp = rectangle(Vec3::Y, Vec3::X, Vec3::Z); // shines down
    let shining = Material { emissive: Vec3::splat(3.0), ..lambert(0.0) };
    let scene = scene([(ground, lambert(0.5)), (lamp, shining)]);
    // From beside the lamp; the spot is small.
    let camera = Camera::look_at(Vec3::new(3.0, 0.5, 0.0), Vec3::ZERO, Vec3::Y, 1e-3);
    assert_mean(&run(scene, &camera, &settings(32, 256, 2)), 0.5 * 3.0 * 4.0 * quarter);
}

/// A coordinate of zero has no rounding error, so that nothing but the segment's own keeps light
/// that was sampled off the lamp that it comes from.
#[test]
fn lamps_at_a_coordinate_of_zero_are_not_in_their_own_light() {
    let shining = || Material { emissive: Vec3::splat(3.0), ..lambert(0.0) };
    let root = 2.0_f32.sqrt();
    let quarter = 1.0 / (2.0 * PI) * 2.0 * (1.0 / root) * libm::atanf(1.0 / root);
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let (right, up) = (Vec3::new(axis.y, axis.z, axis.x), Vec3::new(axis.z, axis.x, axis.y));
        for height in [0.7, 1.0, 3.0, 1000.0] {
            for off in [0.0, 1e-9, -1e-7] {
                let lamp = rectangle(axis * off, up * height, right * height);
                let far = rectangle(axis * height, right * (5.0 * height), up * (5.0 * height));
                let scene = scene([(far, lambert(0.5)), (lamp, shining())]);
                // From beside the lamp; the spot is small.
                let eye = axis * (0.5 * height) + right * (3.0 * height);
                let camera = Camera::look_at(eye, axis * height, axis, 1e-3);
                let rendered = run(scene, &camera, &settings(16, 64, 2));
                let (found, error) = mean(&rendered.picture);
                let expected = 0.5 * 3.0 * 4.0 * quarter;
                let off_by = (found - expected).abs();
                let at = format!("{axis} {height} {off}: {found} +- {error}, not {expected}");
                assert!(off_by < 5.0 * error && off_by < 0.02 * expected, "{at}");
            }
        }
    }
}

#[test]
fn emitters_shine_from_their_front_unless_double_sided() {
    for (double_sided, expected) in [(false, 0.0), (true, 2.0)] {
        let lamp = rectangle(Vec3::ZERO, Vec3::X, Vec3::Z); // front down
        let material = Material { emissive: Vec3::splat(2.0), double_sided, ..lambert(0.0) };
        let camera = flat_camera(Vec3::Y, Vec3::ZERO, 0.1);
        let rendered = run(scene([(lamp, material)]), &camera, &settings(2, 4, 3));
        assert_eq!(mean(&rendered.picture).0, expected);
    }
}

#[test]
fn an_environment_lights_a_plane_as_its_integral_says() {
    let (width, height) = (64, 32);
    let mut pixels = vec![[0.2, 0.3, 0.4]; width * height];
    pixels[5 * width + 40] = [900.0, 800.0, 700.0]; // a sun
    pixels[20 * width + 3] = [900.0, 800.0, 700.0]; // and one below the horizon
    let environment = || Environment::image(width, height, pixels.clone(), 1.5, 30.0);
    // The irradiance on a plane that looks up: a sum over directions, evenly.
    let (rows, columns) = (1024, 2048);
    let sky = environment();
    let mut irradiance = 0.0_f64;
    for row in 0..rows / 2 {
        let theta = PI * (row as f32 + 0.5) / rows as f32;
        let (sin, cos) = libm::sincosf(theta);
        for column in 0..columns {
            let phi = 2.0 * PI * (column as f32 + 0.5) / columns as f32;
            let direction = Vec3::new(sin * libm::cosf(phi), cos, sin * libm::sinf(phi));
            irradiance += f64::from(sky.radiance(direction).y * cos * sin);
        }
    }
    irradiance *= f64::from(PI / rows as f32) * f64::from(2.0 * PI / columns as f32);

    let ground = rectangle(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0);
    let mut scene = scene([(ground, lambert(0.5))]);
    scene.environment = Some(environment());
    let camera = flat_camera(Vec3::Y, Vec3::ZERO, 0.1);
    let rendered = run(scene, &camera, &settings(32, 256, 2));
    assert_mean(&rendered, (0.5 / f64::from(PI) * irradiance) as f32);
}

/// Some of everything, small.
fn mixed_scene() -> Scene {
    let shining = Material { emissive: Vec3::splat(3.0), ..lambert(0.0) };
    let metal = Material { roughness: 0.3, ..Material::default() };
    let mut scene = scene([
        (rectangle(Vec3::NEG_Y, Vec3::Z * 3.0, Vec3::X * 3.0), lambert(0.5)),
        (rectangle(Vec3::Y * 2.0, Vec3::X, Vec3::Z), shining),
        (sphere(2), metal),
    ]);
    scene.materials[0].alpha_mode = dapple::scene::AlphaMode::Blend;
    scene.materials[0].base_color.w = 0.7;
    scene.environment = Some(Environment::constant(Vec3::new(0.2, 0.3, 0.4)));
    scene
}

#[test]
fn threads_and_crops_change_no_bit() {
    let camera = Camera::look_at(Vec3::new(2.0, 1.0, 4.0), Vec3::ZERO, Vec3::Y, 0.9);
    let render_on = |threads: usize, settings: &Settings| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| run(mixed_scene(), &camera, settings).picture)
    };
    let whole_frame = Settings {
        transport: Transport { max_depth: 8, roulette_depth: Some(3), transparent: true },
        ..settings(40, 37, 8)
    };
    let one = render_on(1, &whole_frame);
    for threads in [2, 7] {
        assert!(render_on(threads, &whole_frame) == one, "{threads} threads");
    }
    // Two crops side by side are the whole.
    for (x0, x1) in [(0, 13), (13, 40)] {
        let crop = Window { x0, y0: 0, x1, y1: 40 };
        let part = render_on(2, &Settings { crop, ..whole_frame.clone() });
        for channel in part.channels() {
            let of_whole = one.channel(&channel.name).expect("the same channels");
            for (i, &value) in channel.samples.iter().enumerate() {
                let (x, y) = (i % crop.width() + x0 as usize, i / crop.width());
                assert_eq!(value.to_bits(), of_whole[y * 40 + x].to_bits(), "{}", channel.name);
            }
        }
    }
}

#[test]
fn a_scene_of_any_scale_is_the_same_picture() {
    let render_at = |scale: f32| {
        let mut scene = mixed_scene();
        for instance in &mut scene.instances {
            instance.transform = Transform::new(Affine3A::from_scale(Vec3::splat(scale)));
        }
        let eye = Vec3::new(2.0, 1.0, 4.0) * scale;
        let camera = Camera::look_at(eye, Vec3::ZERO, Vec3::Y, 0.9);
        mean(&run(scene, &camera, &settings(32, 64, 6)).picture).0
    };
    let plain = render_at(1.0);
    for scale in [1e-4, 1e4] {
        let scaled = render_at(scale);
        assert!((scaled / plain - 1.0).abs() < 2e-3, "{scale}: {scaled}, not {plain}");
    }
}
