//! Holes, mirrored meshes and bent normals, seen in renders.

mod stage;

use std::sync::Arc;

use dapple::camera::Camera;
use dapple::light::{Environment, Punctual, PunctualKind};
use dapple::math::{Affine3A, MaterialId, MeshId, TextureId, Vec2, Vec3, Vec4};
use dapple::scene::{AlphaMode, Instance, Material, Scene, TextureRef, Transform};
use dapple::texture::{ColorSpace, Filter, Image, Texture, Wrap};
use stage::{assert_mean, flat_camera, lambert, mean, rectangle, run, scene, settings, sphere};

fn in_white_world(part: (dapple::geom::Mesh, Material)) -> Scene {
    let mut scene = scene([part]);
    scene.environment = Some(Environment::constant(Vec3::ONE));
    scene
}

#[test]
fn alpha_lets_its_share_of_light_through() {
    let wall = || rectangle(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0);
    let camera = flat_camera(Vec3::Y, Vec3::ZERO, 0.1);
    for (mode, alpha, expected) in [
        (AlphaMode::Opaque, 0.25, 0.0),
        (AlphaMode::Blend, 0.25, 0.75),
        (AlphaMode::Mask(0.5), 0.25, 1.0),
        (AlphaMode::Mask(0.25), 0.25, 0.0),
    ] {
        let mut material = Material { alpha_mode: mode, ..lambert(0.0) };
        material.base_color.w = alpha;
        let mut settings = settings(64, 256, 4);
        settings.transport.transparent = mode == AlphaMode::Opaque;
        let rendered = run(in_white_world((wall(), material)), &camera, &settings);
        assert_mean(&rendered, expected);
    }
}

/// Light that comes through a half-there roof: shadow rays are let through by the same odds.
#[test]
fn shadows_of_blended_surfaces_are_half_dark() {
    let ground = rectangle(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0);
    let roof = rectangle(Vec3::Y, Vec3::Z * 5.0, Vec3::X * 5.0);
    let mut half_there = Material { alpha_mode: AlphaMode::Blend, ..lambert(0.0) };
    half_there.base_color.w = 0.5;
    let mut scene = scene([(ground, lambert(1.0)), (roof, half_there)]);
    scene.lights.push(Punctual {
        kind: PunctualKind::Directional,
        position: Vec3::ZERO,
        direction: Vec3::NEG_Y,
        intensity: Vec3::splat(std::f32::consts::PI),
        range: None,
    });
    // From below the roof.
    let camera = flat_camera(Vec3::Y * 0.5, Vec3::ZERO, 0.1);
    assert_mean(&run(scene, &camera, &settings(64, 1024, 2)), 0.5);
}

/// A sphere with smooth normals under a lamp, plain and as the mirror image of its mirror image.
#[test]
fn a_mirrored_mesh_is_shaded_like_its_mirror_image() {
    let picture = |mirrored: bool| {
        let mut mesh = sphere(2);
        mesh.normals.clone_from(&mesh.positions);
        let mut transform = Affine3A::from_translation(Vec3::X * 0.3);
        if mirrored {
            // The same set of points: the octahedron's sphere is symmetric.
            transform *= Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
        }
        let mut scene = scene([(mesh, lambert(0.5))]);
        scene.instances[0].transform = Transform::new(transform);
        scene.lights.push(Punctual {
            kind: PunctualKind::Point,
            position: Vec3::new(3.0, 3.0, 3.0),
            direction: Vec3::NEG_Y,
            intensity: Vec3::splat(20.0),
            range: None,
        });
        let camera = Camera::look_at(Vec3::new(0.3, 0.0, 4.0), Vec3::X * 0.3, Vec3::Y, 0.6);
        run(scene, &camera, &settings(32, 4, 2)).picture
    };
    let (plain, mirrored) = (picture(false), picture(true));
    let (a, b) = (plain.channel("G").expect("green"), mirrored.channel("G").expect("green"));
    assert!(mean(&plain).0 > 0.01);
    let differing = a.iter().zip(b).filter(|(a, b)| (**a - **b).abs() > 1e-3).count();
    assert!(differing < 10, "{differing} of {} pixels", a.len());
}

/// A wall with a normal texture of one colour, lit from one side or from above.
fn relief(texel: [f32; 3], light_from: Vec3) -> f32 {
    let mut mesh = rectangle(Vec3::ZERO, Vec3::X, Vec3::Y); // front along +Z, u right, v down
    mesh.uvs[0] = vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO];
    let bytes = texel.map(|value| ((value * 0.5 + 0.5) * 255.0).round() as u8);
    let image = Image::of(1, 1, vec![bytes]);
    let texture = Texture::new(
        Arc::new(image),
        ColorSpace::Linear,
        [Wrap::Repeat, Wrap::Repeat],
        Filter::Bilinear,
    );
    let material = Material { normal_texture: Some(TextureRef::new(TextureId(0))), ..lambert(1.0) };
    let mut scene = scene([(mesh, material)]);
    scene.textures.push(texture);
    scene.lights.push(Punctual {
        kind: PunctualKind::Directional,
        position: Vec3::ZERO,
        direction: -light_from.normalize(),
        intensity: Vec3::splat(std::f32::consts::PI),
        range: None,
    });
    let camera = flat_camera(Vec3::Z, Vec3::ZERO, 0.1);
    mean(&run(scene, &camera, &settings(2, 4, 2)).picture).0
}

#[test]
fn red_bends_normals_right_and_green_up() {
    let right = Vec3::new(1.0, 0.0, 1.0);
    let up = Vec3::new(0.0, 1.0, 1.0);
    let (bent_right, bent_up) = ([0.6, 0.0, 0.8], [0.0, 0.6, 0.8]);
    // Cosines between the bent normal and the light.
    let (towards, away) = ((0.6 + 0.8) / 2.0_f32.sqrt(), 0.8 / 2.0_f32.sqrt());
    for (texel, light, expected) in [
        (bent_right, right, towards),
        (bent_up, up, towards),
        (bent_right, up, away),
        (bent_up, right, away),
    ] {
        let found = relief(texel, light);
        assert!((found - expected).abs() < 0.01, "{texel:?} {light}: {found}, not {expected}");
    }
}

/// Many instances of one mesh are as many meshes.
#[test]
fn instances_share_their_mesh() {
    let mut shared = scene([(rectangle(Vec3::ZERO, Vec3::Z, Vec3::X), lambert(0.5))]);
    let at = |x: f32| Transform::new(Affine3A::from_translation(Vec3::X * x));
    shared.instances = [-2.0, 0.0, 2.0]
        .map(|x| Instance { mesh: MeshId(0), material: MaterialId(0), transform: at(x) })
        .to_vec();
    shared.environment = Some(Environment::constant(Vec3::ONE));
    // Three touching squares of side 2 fill the view.
    let camera = flat_camera(Vec3::Y, Vec3::ZERO, 0.9);
    assert_mean(&run(shared, &camera, &settings(32, 64, 4)), 0.5);
}

/// Albedo, normal, and the height of the position, of a wall above the camera that is seen in a
/// surface below it, or of the sky in its place.
fn seen_in(below: Material, above: Option<Material>) -> [f32; 7] {
    let floor = rectangle(Vec3::ZERO, Vec3::Z * 5.0, Vec3::X * 5.0);
    let ceiling = rectangle(Vec3::Y * 4.0, Vec3::Z * 50.0, Vec3::X * 50.0);
    let mut scene = scene([(floor, below)].into_iter().chain(above.map(|it| (ceiling, it))));
    scene.environment = Some(Environment::constant(Vec3::new(3.0, 0.5, 0.25)));
    let camera = flat_camera(Vec3::Y, Vec3::ZERO, 0.1);
    let picture = run(scene, &camera, &settings(4, 16, 8)).picture;
    let channels = ["albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z"];
    let mean = |name: &str| {
        let values = picture.channel(name).expect("asked for");
        values.iter().sum::<f32>() / values.len() as f32
    };
    let [r, g, b, x, y, z] = channels.map(mean);
    [r, g, b, x, y, z, mean("position.Y")]
}

fn assert_near(found: [f32; 7], expected: [f32; 7]) {
    let near = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 0.01);
    assert!(near, "{found:?}, not {expected:?}");
}

/// Albedo and normal are those of what is seen in a mirror, the position is the mirror's.
#[test]
fn layers_show_what_is_seen_in_mirrors() {
    let metal = |roughness| Material {
        base_color: Vec4::new(0.5, 0.5, 0.5, 1.0),
        metallic: 1.0,
        roughness,
        ..Material::default()
    };
    let wall = || Some(lambert(0.6));
    for roughness in [0.0, 0.1] {
        let found = seen_in(metal(roughness), wall());
        assert_near(found, [0.3, 0.3, 0.3, 0.0, -1.0, 0.0, 0.0]);
    }
    // Of light that is brighter than white no more is taken.
    assert_near(seen_in(metal(0.0), None), [0.5, 0.25, 0.125, 0.0, 0.0, 0.0, 0.0]);
    // A mirror behind a mirror, of which the second one is not smooth.
    assert_near(seen_in(metal(0.0), Some(metal(0.5))), [0.25, 0.25, 0.25, 0.0, -1.0, 0.0, 0.0]);
    // What is rough is seen itself.
    assert_near(seen_in(metal(0.5), wall()), [0.5, 0.5, 0.5, 0.0, 1.0, 0.0, 0.0]);
    assert_near(seen_in(lambert(0.4), wall()), [0.4, 0.4, 0.4, 0.0, 1.0, 0.0, 0.0]);
}

/// The same through a pane: what passes shows the sky below, what it reflects the wall.
#[test]
fn layers_show_what_is_seen_through_glass() {
    let pane = Material { metallic: 0.0, roughness: 0.0, transmission: 1.0, ..Material::default() };
    let found = seen_in(pane, Some(lambert(0.6)));
    // Both faces of glass of index 1.5 with all reflections between them.
    let reflected = 2.0 * 0.04 / 1.04;
    let passes = 1.0 - reflected;
    let of = |sky: f32| passes * sky + reflected * 0.6;
    assert_near(found, [of(1.0), of(0.5), of(0.25), 0.0, -reflected, 0.0, 0.0]);
}
