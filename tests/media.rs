//! Light in media: renders whose result is known on paper.

mod stage;

use std::f32::consts::PI;
use std::sync::Arc;

use dapple::Transport;
use dapple::camera::Camera;
use dapple::geom::Mesh;
use dapple::light::{Environment, Punctual, PunctualKind};
use dapple::material::BsdfForm;
use dapple::math::{Affine3A, DQuat, DVec3, MaterialId, Vec3, Vec4};
use dapple::medium::{HenyeyGreenstein, Medium};
use dapple::motion::{Link, Motion, MovingParts, Track};
use dapple::render::Settings;
use dapple::scene::{Material, ScatterColor, Scattering, Scene, Transform, Volume};
use dapple::world::{LightSamplerKind, World};
use stage::{assert_mean, flat_camera, lambert, mean, rectangle, run, scene, settings, sphere};

/// More scatterings than any path takes here.
const ENDLESS: u32 = 1 << 16;

/// What takes away `extinction` per metre, of which it scatters `albedo`; with the index `ior`.
fn cloud(extinction: f32, albedo: f32, anisotropy: f32, ior: f32) -> Material {
    let color = ScatterColor::One(Vec3::splat(albedo));
    Material {
        metallic: 0.0,
        roughness: 0.0,
        ior,
        transmission: 1.0,
        volume: Some(Volume {
            attenuation_color: Vec3::splat(libm::expf(-1.0)),
            attenuation_distance: 1.0 / extinction,
        }),
        scattering: Some(Scattering { color, color_texture: None, anisotropy }),
        ..Material::default()
    }
}

/// A box about the origin, its faces outwards.
fn cuboid(half: Vec3) -> Mesh {
    let [x, y, z] = [Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z];
    let mut all = Mesh::default();
    for (right, up, out) in [(x, y, z), (y, x, -z), (y, z, x), (z, y, -x), (z, x, y), (x, z, -y)] {
        let face = rectangle(out, right, up);
        let first = all.positions.len() as u32;
        all.positions.extend(face.positions);
        all.indices.extend(face.indices.iter().map(|face| face.map(|corner| corner + first)));
    }
    all
}

fn white_world(parts: impl IntoIterator<Item = (Mesh, Material)>) -> Scene {
    Scene { environment: Some(Environment::constant(Vec3::ONE)), ..scene(parts) }
}

fn towards_middle() -> Camera {
    Camera::look_at(Vec3::new(0.3, 0.4, 4.0), Vec3::ZERO, Vec3::Y, 0.6)
}

/// What absorbs nothing is not seen before white, however dense, wherever it scatters to, whatever
/// its border does.
#[test]
fn white_media_in_a_white_world_are_invisible() {
    let check = |material: Material, tolerance: f32| {
        let scene = white_world([(sphere(2), material)]);
        let (found, error) = mean(&run(scene, &towards_middle(), &quick(32)).picture);
        let off = (found - 1.0).abs();
        assert!(off < 3.0 * error + 1e-5 && off < tolerance, "{found} +- {error}");
    };
    for (extinction, anisotropy) in [(0.5, 0.0), (4.0, 0.8), (4.0, -0.6), (12.0, 0.0)] {
        check(cloud(extinction, 1.0, anisotropy, 1.0), 0.005);
    }
    let milk = cloud(5.0, 1.0, 0.3, 1.33);
    check(milk.clone(), 0.005);
    let wax = Material { transmission: 0.0, diffuse_transmission: 0.8, roughness: 0.5, ..milk };
    check(wax.clone(), 0.005);
    // Light goes in one way and comes out the other.
    check(Material { transmission: 0.5, roughness: 0.0, ..wax }, 0.005);
}

/// Few pixels, many samples, no roulette.
fn quick(spp: u64) -> Settings {
    settings(24, spp, ENDLESS)
}

/// What is seen straight through a slab: colour by colour, and the borders do not count as
/// vertices.
#[test]
fn a_slab_lets_through_what_its_thickness_leaves() {
    let slab = Material {
        volume: Some(Volume {
            attenuation_color: Vec3::new(0.5, 0.25, 0.9),
            attenuation_distance: 0.5,
        }),
        ..cloud(1.0, 0.7, 0.0, 1.0)
    };
    let lamp = Material { emissive: Vec3::splat(2.0), ..lambert(0.0) };
    let floor = rectangle(Vec3::NEG_Y, Vec3::Z * 3.0, Vec3::X * 3.0);
    let parts = [(cuboid(Vec3::new(2.0, 0.375, 2.0)), slab), (floor, lamp)];
    let camera = flat_camera(Vec3::Y * 3.0, Vec3::ZERO, 0.1);
    let picture = run(scene(parts), &camera, &settings(16, 1024, 1)).picture;
    for (channel, color) in [("R", 0.5), ("G", 0.25), ("B", 0.9)] {
        let pixels = picture.channel(channel).expect("a colour");
        let found = pixels.iter().sum::<f32>() / pixels.len() as f32;
        // 0.75 m of what leaves that much after 0.5 m.
        let expected = 2.0 * libm::powf(color, 1.5);
        assert!((found / expected - 1.0).abs() < 0.005, "{channel}: {found}, not {expected}");
    }
}

/// Chandrasekhar's H-function of isotropic scattering, by iteration; "Radiative Transfer", 1950, V.
fn h_function(albedo: f64) -> impl Fn(f64) -> f64 {
    const POINTS: usize = 400;
    let root = (1.0 - albedo).sqrt();
    // The midpoint rule in a variable whose square is the cosine.
    let nodes: Vec<(f64, f64)> = (0..POINTS)
        .map(|i| (i as f64 + 0.5) / POINTS as f64)
        .map(|t| (t * t, 2.0 * t / POINTS as f64))
        .collect();
    let at = move |mu: f64, nodes: &[(f64, f64)], h: &[f64]| {
        let sum: f64 = nodes.iter().zip(h).map(|(&(x, w), h)| w * x * h / (mu + x)).sum();
        1.0 / (root + 0.5 * albedo * sum)
    };
    let mut h = vec![1.0; POINTS];
    for _ in 0..2000 {
        let next: Vec<f64> = nodes.iter().map(|&(x, _)| at(x, &nodes, &h)).collect();
        let change = next.iter().zip(&h).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        h = next;
        if change < 1e-12 {
            break;
        }
    }
    move |mu| at(mu, &nodes, &h)
}

/// What a half-space that scatters alike in all directions returns of the light that falls in at
/// `cosine`, held to `1 - sqrt(1 - a) H(μ)` within 0.1 %.
///
/// Paths end where less than 1e-5 of the light is left, at most `albedo` to the power `depth`:
/// those that never come out of a half-space would be followed for nothing.
fn assert_half_space(albedo: f64, cosine: f64, spp: u64, depth: u32) {
    let half = Vec3::new(1000.0, 500.0, 1000.0);
    let space = white_world([(cuboid(half), cloud(1.0, albedo as f32, 0.0, 1.0))]);
    let from = Vec3::new(libm::sqrt(1.0 - cosine * cosine) as f32, cosine as f32, 0.0);
    let top = Vec3::Y * half.y;
    let camera = flat_camera(top + from * 10.0, top, 0.1);
    let (found, error) = mean(&run(space, &camera, &settings(8, spp, depth)).picture);
    let expected = 1.0 - (1.0 - albedo).sqrt() * h_function(f64::from(albedo as f32))(cosine);
    let off = f64::from(found) / expected - 1.0;
    assert!(f64::from(error) < 8e-4 * expected, "{albedo} {cosine}: {error}");
    assert!(off.abs() < 1e-3, "{albedo} {cosine}: {found} +- {error}, not {expected}");
}

#[test]
fn a_half_space_returns_what_chandrasekhar_says() {
    // The book's own table: H(1) for the albedos 0.5 and 0.9.
    for (albedo, expected) in [(0.5, 1.251_26), (0.9, 1.850_10)] {
        assert!((h_function(albedo)(1.0) - expected).abs() < 2e-4, "{}", h_function(albedo)(1.0));
    }
    assert_half_space(0.5, 1.0, 40_000, 20);
    assert_half_space(0.9, 0.4, 16_000, 110);
}

#[test]
#[ignore = "takes a minute"]
fn a_half_space_that_takes_little_returns_what_chandrasekhar_says() {
    assert_half_space(0.99, 1.0, 16_000, 1200);
}

/// A point light in a medium, scattered once: the integral along the line of sight of
/// `s p(θ) I exp(-e (t + r)) / r²`, up to `end`.
fn single_scattering(extinction: f64, albedo: f64, g: f32, end: f64, distance: f64) -> f64 {
    const STEPS: usize = 200_000;
    let phase = HenyeyGreenstein::new(g);
    let step = end / STEPS as f64;
    // The camera looks along the line; the light is beside the point one metre on.
    let at = |t: f64| {
        let (along, across) = (t - 1.0, distance);
        let r = libm::hypot(along, across);
        let cosine = -along / r; // from the way of the sight to the way to the light
        let left = libm::exp(-extinction * (t + r));
        extinction * albedo * f64::from(phase.eval(cosine as f32)) * left / (r * r)
    };
    (0..STEPS).map(|i| at((i as f64 + 0.5) * step) * step).sum()
}

/// In a medium that fills all space, and through the border of one with a light outside of it: a
/// path alone never finds the light.
#[test]
fn light_is_scattered_once_as_its_integral_says() {
    let light = Punctual {
        kind: PunctualKind::Point,
        position: Vec3::new(0.5, 0.0, -1.0),
        direction: Vec3::NEG_Y,
        intensity: Vec3::splat(4.0),
        range: None,
    };
    // A wall that ends the line of sight.
    let wall = || (rectangle(Vec3::NEG_Z * 3.0, Vec3::X, Vec3::Y), lambert(0.0));
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1e-3);
    for g in [0.0, 0.7, -0.5] {
        let mut fog = scene([wall()]);
        fog.medium = Some(Medium::new(Vec3::splat(0.6), Vec3::splat(0.5), g));
        fog.lights.push(light);
        let expected = 4.0 * single_scattering(0.6, 0.5, g, 3.0, 0.5);
        assert_mean(&run(fog, &camera, &settings(16, 4096, 2)), expected as f32);
    }
    // The same line in a box; the light is outside, and part of its way is clear.
    let mesh = Mesh {
        positions: cuboid(Vec3::new(0.25, 1.0, 1.5))
            .positions
            .iter()
            .map(|p| *p - Vec3::Z * 1.5)
            .collect(),
        ..cuboid(Vec3::ONE)
    };
    let wall = (rectangle(Vec3::NEG_Z * 4.0, Vec3::X, Vec3::Y), lambert(0.0));
    let camera = Camera::look_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1e-3);
    let mut fog = scene([wall, (mesh, cloud(0.6, 0.5, 0.0, 1.0))]);
    fog.lights.push(light);
    let at = |t: f64| {
        let (along, across) = (t - 1.0, 0.5);
        let r = libm::hypot(along, across);
        let left = libm::exp(-0.6 * (t + 0.5 * r)); // half of the way to the light
        0.3 / (4.0 * std::f64::consts::PI) * 4.0 * left / (r * r)
    };
    let steps = 200_000;
    let width = 3.0 / f64::from(steps);
    let expected: f64 = (0..steps).map(|i| at((f64::from(i) + 0.5) * width) * width).sum();
    assert_mean(&run(fog, &camera, &settings(16, 4096, 2)), expected as f32);
}

/// A lamp that is asked for light and one that is found by chance alone give the same picture: of
/// coloured, dense and clear media, within and outside of borders that tint.
#[test]
fn lamps_are_weighed_against_paths() {
    let color = ScatterColor::One(Vec3::new(0.95, 0.6, 0.2));
    let volume = Volume { attenuation_color: Vec3::new(0.9, 0.4, 0.1), attenuation_distance: 1.0 };
    let fog = Material {
        base_color: Vec4::new(0.9, 0.8, 1.0, 1.0),
        volume: Some(volume),
        scattering: Some(Scattering { color, color_texture: None, anisotropy: 0.4 }),
        ..cloud(1.0, 1.0, 0.0, 1.0)
    };
    let floor = || (rectangle(Vec3::Y * -0.8, Vec3::Z * 4.0, Vec3::X * 4.0), lambert(0.5));
    let camera = Camera::look_at(Vec3::new(0.2, 0.4, 3.0), Vec3::Y * -0.4, Vec3::Y, 0.8);
    for height in [0.7, 1.6] {
        let lamp = |material: Material| {
            let shade = rectangle(Vec3::Y * height, Vec3::X * 0.4, Vec3::Z * 0.4);
            let parts = [floor(), (sphere(2), fog.clone()), (shade, material)];
            let picture = run(scene(parts), &camera, &settings(24, 512, 12)).picture;
            ["R", "G", "B"].map(|channel| {
                let pixels = picture.channel(channel).expect("a colour");
                let variance = picture.channel(&format!("variance.{channel}")).expect("asked for");
                let count = pixels.len() as f32;
                (pixels.iter().sum::<f32>() / count, variance.iter().sum::<f32>().sqrt() / count)
            })
        };
        let asked =
            lamp(Material { emissive: Vec3::splat(5.0), double_sided: true, ..lambert(0.0) });
        let base_color = Vec4::new(5.0, 5.0, 5.0, 1.0);
        let found = lamp(Material { base_color, unlit: true, ..Material::default() });
        for ((a, a_error), (b, b_error)) in asked.into_iter().zip(found) {
            assert!(a_error < b_error, "{height}: {a_error} {b_error}");
            assert!((a - b).abs() < 3.5 * (a_error + b_error), "{height}: {a} {b} +- {b_error}");
        }
    }
}

/// A scattering is a vertex: with two segments light is scattered once, and roulette takes nothing
/// from the mean.
#[test]
fn scatterings_count_and_roulette_takes_nothing() {
    let of = |max_depth, roulette_depth| {
        let cloud = cloud(3.0, 0.8, 0.0, 1.0);
        let mut settings = settings(24, 512, max_depth);
        settings.transport = Transport { roulette_depth, ..settings.transport };
        mean(&run(white_world([(sphere(2), cloud)]), &towards_middle(), &settings).picture)
    };
    let [once, twice, all] = [2, 3, ENDLESS].map(|depth| of(depth, None).0);
    assert!(once < twice - 0.01 && twice < all - 0.01, "{once} {twice} {all}");
    let (with, error) = of(ENDLESS, Some(2));
    assert!((with - all).abs() < 4.0 * error.max(1e-4), "{with} {all} {error}");
}

/// A camera that stands in fog sees it from the first metre on, though it never came in.
#[test]
fn who_starts_in_fog_sees_it() {
    let lamp = Material { emissive: Vec3::ONE, ..lambert(0.0) };
    let wall = rectangle(Vec3::NEG_Z * 0.5, Vec3::X, Vec3::Y);
    let parts = [(sphere(3), cloud(1.0, 0.5, 0.0, 1.0)), (wall, lamp)];
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1e-3);
    assert_mean(&run(scene(parts), &camera, &settings(16, 2048, 1)), libm::expf(-0.5));
}

/// Fog that comes over the camera while the shutter is open: each path begins in what is around at
/// its time.
#[test]
fn fog_comes_with_time() {
    let lamp = Material { emissive: Vec3::ONE, ..lambert(0.0) };
    let wall = rectangle(Vec3::NEG_Z * 0.5, Vec3::X, Vec3::Y);
    let fog = cuboid(Vec3::new(1.0, 1.0, 2.0));
    let mut scene = scene([(fog, cloud(1.0, 0.5, 0.0, 1.0)), (wall, lamp)]);
    // Its front is one metre behind the camera at first, and one metre before it at last.
    let way = [(0.0, DVec3::Z * 3.0), (1.0, DVec3::Z)];
    let motion = Motion::new([Link::Moving(Arc::new(MovingParts {
        translation: Track::new(&way).expect("has keys"),
        rotation: Track::new(&[(0.0, DQuat::IDENTITY)]).expect("has keys"),
        scale: Track::new(&[(0.0, DVec3::ONE)]).expect("has keys"),
    }))]);
    let motion = motion.expect("moves");
    let start = motion.at(0.0).to_cols_array().map(|x| x as f32);
    scene.instances[0].transform = Transform::new(Affine3A::from_cols_array(&start));
    scene.motion_mut().move_placement(0, Arc::new(motion));
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1e-3);
    // It reaches the camera in the middle, and the wall after three quarters.
    let whole = libm::expf(-0.5);
    let expected = 0.5 + 0.5 * (1.0 - whole) + 0.25 * whole;
    assert_mean(&run(scene, &camera, &settings(16, 2048, 1)), expected);
}

/// Other lights in a world leave its media as they are.
#[test]
fn media_stay_when_lights_change() {
    let mut fog = scene([(sphere(1), cloud(2.0, 0.5, 0.0, 1.0))]);
    fog.medium = Some(Medium::new(Vec3::splat(0.6), Vec3::splat(0.5), 0.0));
    let mut world = World::new(Arc::new(fog), BsdfForm::Conserving).expect("few triangles");
    world.relight(LightSamplerKind::default(), |scene| {
        scene.environment = Some(Environment::constant(Vec3::ONE));
    });
    assert!(world.scene.environment.is_some() && !world.lights.is_dark());
    assert!(world.has_media() && world.has_passable_borders());
    for (id, extinction) in [(MaterialId::NONE, 0.6), (MaterialId::from_index(0), 2.0)] {
        let medium = world.medium(id).expect("it scatters");
        assert!((medium.extinction() - extinction).abs().max_element() < 1e-5, "{medium:?}");
    }
}

/// Milk in a glass in water: where solids overlap, the first by priority scatters, and lamps are
/// asked through the borders that it hides.
#[test]
fn the_prior_medium_is_there() {
    let of = |milk: i32, depth: u32| {
        let water = Material { priority: 0, ..cloud(0.2, 0.0, 0.0, 1.0) };
        let milk = Material { priority: milk, ..cloud(2.0, 0.6, 0.0, 1.0) };
        let lamp = Material { emissive: Vec3::ONE, ..lambert(0.0) };
        let floor = rectangle(Vec3::NEG_Y, Vec3::Z * 3.0, Vec3::X * 3.0);
        let mut all = scene([
            (cuboid(Vec3::new(2.0, 0.5, 2.0)), water),
            (cuboid(Vec3::new(2.5, 0.25, 2.5)), milk),
            (floor, lamp),
        ]);
        all.instances[0].material = MaterialId::from_index(0);
        let camera = flat_camera(Vec3::Y * 3.0, Vec3::ZERO, 0.1);
        mean(&run(all, &camera, &settings(16, 1024, depth)).picture)
    };
    // Half a metre of milk, and what of the water is not milk; or a metre of water alone.
    for (priority, expected) in
        [(1, libm::expf(-1.0 - 0.1)), (-1, libm::expf(-0.2)), (0, libm::expf(-1.0 - 0.1))]
    {
        let (found, error) = of(priority, 1);
        let off = (found - expected).abs();
        assert!(off < 3.0 * error + 1e-4, "{priority}: {found} +- {error}, not {expected}");
    }
    assert!(of(1, 4).0 > of(1, 1).0 + 0.02);
}

/// A leaf before a lamp: half of the light that falls on its back comes out at its front, evenly.
#[test]
fn leaves_let_light_through() {
    let leaf = Material {
        specular: 0.0,
        metallic: 0.0,
        base_color: Vec4::new(0.0, 0.0, 0.0, 1.0),
        diffuse_transmission: 0.5,
        diffuse_transmission_color: Vec3::splat(0.6),
        ..Material::default()
    };
    let light = Punctual {
        kind: PunctualKind::Directional,
        position: Vec3::ZERO,
        direction: Vec3::new(0.0, 0.8, 0.6),
        intensity: Vec3::splat(3.0),
        range: None,
    };
    let mut scene = scene([(rectangle(Vec3::ZERO, Vec3::Z, Vec3::X), leaf)]);
    scene.lights.push(light);
    let rendered = run(scene, &flat_camera(Vec3::Y, Vec3::ZERO, 0.1), &settings(4, 16, 3));
    assert_mean(&rendered, 0.5 * 0.6 / PI * 3.0 * 0.8);
}
