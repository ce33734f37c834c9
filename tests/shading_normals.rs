//! Shading normals that lose no light, and let none through.

mod stage;

use std::f32::consts::PI;

use dapple::ShadingNormals;
use dapple::camera::Camera;
use dapple::geom::Mesh;
use dapple::light::{Environment, Punctual, PunctualKind};
use dapple::math::{Vec3, Vec4};
use dapple::scene::{Material, Scene};
use stage::{flat_camera, lambert, mean, run_with, scene, settings, sphere};

/// A sphere of `8 * 4^levels` triangles whose normals are those of the sphere, bent by some random
/// slopes.
fn smooth_sphere(levels: u32, slope: f32) -> Mesh {
    let mut mesh = sphere(levels);
    let hash = |p: Vec3, k: f32| libm::sinf(p.dot(Vec3::new(91.7, 57.3, 33.1)) * k);
    let bend = |p: Vec3| Vec3::new(hash(p, 1.0), hash(p, 1.7), hash(p, 2.3));
    mesh.normals = mesh.positions.iter().map(|&p| (p + bend(p) * slope).normalize()).collect();
    mesh
}

fn white_metal(roughness: f32) -> Material {
    Material { base_color: Vec4::ONE, metallic: 1.0, roughness, ..Material::default() }
}

/// The mean of a white sphere in a white world, which fills some two thirds of the picture.
fn furnace(mesh: Mesh, material: Material, kind: ShadingNormals) -> f32 {
    let mut scene = scene([(mesh, material)]);
    scene.environment = Some(Environment::constant(Vec3::ONE));
    let camera = flat_camera(Vec3::new(1.0, 4.0, 2.0), Vec3::ZERO, 1.0);
    mean(&run_with(scene, &camera, &settings(64, 64, 64), kind).picture).0
}

#[test]
fn coarse_white_spheres_in_a_white_world_are_invisible() {
    for (material, lost) in
        [(lambert(1.0), 0.02), (white_metal(0.1), 0.03), (white_metal(0.5), 0.02)]
    {
        for levels in [1, 2, 3] {
            let robust =
                furnace(smooth_sphere(levels, 0.0), material.clone(), ShadingNormals::Robust);
            assert!((robust - 1.0).abs() < 0.003, "{levels}, {}: {robust}", material.roughness);
        }
        let plain = furnace(smooth_sphere(1, 0.0), material, ShadingNormals::Plain);
        assert!(plain < 1.0 - lost, "{plain}");
    }
}

/// With facets, too, a white sphere is invisible: however coarse, and however bent its normals.
#[test]
fn white_spheres_of_facets_are_invisible() {
    for material in [lambert(1.0), white_metal(0.1), white_metal(0.5)] {
        for (levels, slope) in [(1, 0.0), (2, 0.0), (3, 0.0), (4, 0.5), (3, 4.0)] {
            let mesh = smooth_sphere(levels, slope);
            let seen = furnace(mesh, material.clone(), ShadingNormals::Microfacet);
            let what = format!("{levels}, {slope}, {}: {seen}", material.roughness);
            assert!((seen - 1.0).abs() < 0.003, "{what}");
        }
    }
}

#[test]
fn white_spheres_with_wild_normals_are_invisible() {
    for material in [lambert(1.0), white_metal(0.1), white_metal(0.5)] {
        let robust = furnace(smooth_sphere(4, 0.5), material.clone(), ShadingNormals::Robust);
        assert!((robust - 1.0).abs() < 0.003, "{}: {robust}", material.roughness);
        let plain = furnace(smooth_sphere(4, 0.5), material, ShadingNormals::Plain);
        assert!(plain < 0.95, "{plain}");
    }
}

/// A clear solid neither loses nor makes light, whichever side its normals send it to.
#[test]
fn coarse_smooth_glass_in_a_white_world_is_invisible() {
    let glass = Material {
        transmission: 1.0,
        roughness: 0.0,
        volume: Some(dapple::scene::Volume {
            attenuation_color: Vec3::ONE,
            attenuation_distance: f32::INFINITY,
        }),
        ..lambert(1.0)
    };
    let glass = Material { specular: 1.0, ..glass };
    let mut scene = scene([(smooth_sphere(2, 0.1), glass)]);
    scene.environment = Some(Environment::constant(Vec3::ONE));
    let camera = flat_camera(Vec3::new(1.0, 4.0, 2.0), Vec3::ZERO, 1.0);
    for kind in [ShadingNormals::Robust, ShadingNormals::Microfacet] {
        let picture = run_with(scene.clone(), &camera, &settings(64, 16, 200), kind).picture;
        let (mean, _) = mean(&picture);
        assert!((mean - 1.0).abs() < 0.003, "{kind} {mean}");
    }
}

/// Not one sample of light gets through a closed mesh, however its normals bend.
#[test]
fn nothing_gets_through() {
    let kinds = [ShadingNormals::Robust, ShadingNormals::Microfacet];
    for (slope, kind) in [0.0, 0.7].into_iter().flat_map(|slope| kinds.map(|kind| (slope, kind))) {
        let shell = || (smooth_sphere(1, slope), lambert(0.9));
        let mut glowing = sphere(1);
        glowing.positions.iter_mut().for_each(|p| *p *= 0.3);
        let lamp = Material { emissive: Vec3::splat(1e3), ..lambert(0.0) };
        let outside = flat_camera(Vec3::new(1.0, 4.0, 2.0), Vec3::ZERO, 1.2);
        let lit_within = scene([shell(), (glowing, lamp)]);
        let dark = run_with(lit_within, &outside, &settings(32, 64, 20), kind);
        assert_eq!(mean(&dark.picture).0, 0.0, "{slope} {kind}");

        let mut lit_without: Scene = scene([shell()]);
        lit_without.environment = Some(Environment::constant(Vec3::splat(1e3)));
        let inside = Camera::look_at(Vec3::new(0.1, 0.2, 0.1), Vec3::X, Vec3::Y, 2.0);
        let dark = run_with(lit_without, &inside, &settings(32, 64, 20), kind);
        assert_eq!(mean(&dark.picture).0, 0.0, "{slope} {kind}");
    }
}

/// Where light grazes a coarse sphere, it fades as on a round one, not triangle by triangle.
#[test]
fn the_terminator_of_a_coarse_sphere_is_smooth() {
    let error = |kind| {
        let mut scene = scene([(smooth_sphere(2, 0.0), lambert(1.0))]);
        let towards = Vec3::new(0.8, 0.6, 0.0);
        scene.lights.push(Punctual {
            kind: PunctualKind::Directional,
            position: Vec3::ZERO,
            direction: -towards,
            intensity: Vec3::splat(PI),
            range: None,
        });
        // Straight down, so that the outline is far from where the light fades.
        let camera = flat_camera(Vec3::Y * 4.0, Vec3::ZERO, 0.6);
        let picture = run_with(scene, &camera, &settings(48, 16, 2), kind).picture;
        let of = |name: &str| picture.channel(name).expect("asked for").to_vec();
        let [green, x, y, z] = ["G", "normal.X", "normal.Y", "normal.Z"].map(of);
        let off = |i: usize| {
            let expected = Vec3::new(x[i], y[i], z[i]).dot(towards).max(0.0);
            f64::from((green[i] - expected).abs())
        };
        (0..green.len()).map(off).sum::<f64>() / green.len() as f64
    };
    let (robust, plain) = (error(ShadingNormals::Robust), error(ShadingNormals::Plain));
    assert!(plain > 2e-3 && robust < 0.2 * plain, "{robust} {plain}");
}
