//! Solids within solids, and glass that parts colours: renders whose result is known on paper.

mod stage;

use dapple::camera::Camera;
use dapple::light::Environment;
use dapple::math::Vec3;
use dapple::scene::{Material, Scene, Volume};
use stage::{assert_mean, flat_camera, lambert, rectangle, run, scene, settings, sphere};

fn glass(ior: f32) -> Material {
    Material {
        metallic: 0.0,
        roughness: 0.0,
        ior,
        transmission: 1.0,
        volume: Some(Volume { attenuation_color: Vec3::ONE, attenuation_distance: f32::INFINITY }),
        ..Material::default()
    }
}

/// What halves light in half a metre.
fn smoke(ior: f32, priority: i32) -> Material {
    let attenuation_color = Vec3::splat(0.5);
    let volume = Some(Volume { attenuation_color, attenuation_distance: 0.5 });
    Material { volume, priority, ..glass(ior) }
}

/// Slabs between two heights, seen from above in a white world.
fn slabs(slabs: impl IntoIterator<Item = (Material, [f32; 2])>) -> (Scene, Camera) {
    let mut all = Scene::default();
    for (material, [low, high]) in slabs {
        let top = rectangle(Vec3::Y * high, Vec3::Z, Vec3::X);
        let bottom = rectangle(Vec3::Y * low, Vec3::X, Vec3::Z);
        let part = scene([(top, material.clone()), (bottom, material.clone())]);
        // Both faces are of one material.
        let (first, id) = (all.meshes.len() as u32, all.materials.len() as u32);
        all.materials.push(material);
        all.meshes.extend(part.meshes);
        for mut instance in part.instances {
            instance.mesh.0 += first;
            instance.material.0 = id;
            all.instances.push(instance);
        }
    }
    all.environment = Some(Environment::constant(Vec3::ONE));
    (all, flat_camera(Vec3::Y * 3.0, Vec3::ZERO, 0.1))
}

#[test]
fn of_two_that_overlap_the_higher_priority_absorbs() {
    for (priority, meters) in [(1, 0.75), (-1, 0.25)] {
        let clear = glass(1.0);
        let (scene, camera) = slabs([(smoke(1.0, priority), [0.0, 0.75]), (clear, [0.25, 1.0])]);
        let expected = libm::powf(0.5, 2.0 * meters);
        assert_mean(&run(scene, &camera, &settings(4, 4, 10)), expected);
    }
}

/// Between two kinds of glass of the same index nothing is reflected, whichever is inside; between
/// glass and water less than between glass and air.
#[test]
fn borders_bend_by_the_ratio_of_both_sides() {
    let reflectance =
        |ratio: f32| ((ratio - 1.0) / (ratio + 1.0)) * ((ratio - 1.0) / (ratio + 1.0));
    let outer = reflectance(1.5);
    for inner_ior in [1.5, 1.33] {
        let (scene, camera) = slabs([(glass(1.5), [0.0, 1.0]), (glass(inner_ior), [0.3, 0.6])]);
        let inner = reflectance(inner_ior / 1.5);
        // Five segments: straight through all four faces, or back from the first two of them.
        let through = 1.0 - outer;
        let straight = through * through * (1.0 - inner) * (1.0 - inner);
        let back = outer + through * inner * through;
        assert_mean(&run(scene, &camera, &settings(16, 4096, 5)), straight + back);
    }
}

/// A camera in a solid, and solids whose faces are of several materials, are no trap.
#[test]
fn who_starts_inside_comes_out() {
    let (scene, _) = slabs([(smoke(1.0, 0), [-5.0, 0.5])]);
    let camera = flat_camera(Vec3::ZERO, Vec3::Y, 0.1);
    assert_mean(&run(scene, &camera, &settings(4, 4, 10)), 0.5);

    let top = rectangle(Vec3::Y * 0.5, Vec3::Z, Vec3::X);
    let bottom = rectangle(Vec3::ZERO, Vec3::X, Vec3::Z);
    let mut scene = scene_of_two(top, bottom);
    scene.environment = Some(Environment::constant(Vec3::ONE));
    let camera = flat_camera(Vec3::Y * 3.0, Vec3::ZERO, 0.1);
    assert_mean(&run(scene, &camera, &settings(4, 4, 10)), 0.5);
}

fn scene_of_two(top: dapple::geom::Mesh, bottom: dapple::geom::Mesh) -> Scene {
    scene([(top, smoke(1.0, 0)), (bottom, glass(1.0))])
}

#[test]
fn nested_spheres_in_a_white_world_are_invisible() {
    let mut small = sphere(3);
    small.positions.iter_mut().for_each(|position| *position *= 0.6);
    let mut smaller = sphere(3);
    smaller.positions.iter_mut().for_each(|position| *position *= 0.3);
    let dispersing = Material { dispersion: 2.0, ..glass(1.6) };
    let parts = [(sphere(3), glass(1.33)), (small, dispersing), (smaller, lambert(1.0))];
    let mut scene = scene(parts);
    scene.environment = Some(Environment::constant(Vec3::ONE));
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, Vec3::Y, 0.6);
    assert_mean(&run(scene, &camera, &settings(64, 64, 400)), 1.0);
}

/// Glass that parts colours bends green by its index, red less and blue more: a thick slab seen at
/// an angle shifts what is seen through it by as much.
#[test]
fn colours_part_in_their_order() {
    let prism = Material { dispersion: 4.0, ..glass(1.5) };
    let edge = |channel: &str| {
        let (mut scene, _) = slabs([(prism.clone(), [0.0, 0.5])]);
        scene.environment = None;
        // An emitter below whose edge is seen through the slab.
        let bright = Material { emissive: Vec3::ONE, ..lambert(0.0) };
        let half = rectangle(Vec3::new(-1.0, -0.1, 0.0), Vec3::Z, Vec3::X);
        let below = stage::scene([(half, bright)]);
        let (mesh, material) = (scene.meshes.len() as u32, scene.materials.len() as u32);
        scene.meshes.extend(below.meshes);
        scene.materials.extend(below.materials);
        for mut instance in below.instances {
            instance.mesh.0 += mesh;
            instance.material.0 += material;
            scene.instances.push(instance);
        }
        let camera = flat_camera(Vec3::new(1.5, 2.0, 0.0), Vec3::new(0.0, 0.0, 0.0), 0.5);
        let rendered = run(scene, &camera, &settings(32, 256, 4));
        let seen = rendered.picture.channel(channel).expect("a colour");
        f64::from(seen.iter().sum::<f32>())
    };
    let [red, green, blue] = ["R", "G", "B"].map(edge);
    let parted = |a: f64, b: f64| (a - b).abs() > 0.01 * green && (a < b) == (red < blue);
    assert!(parted(red, green) && parted(green, blue), "{red} {green} {blue}");
}
