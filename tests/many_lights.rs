//! A thousand lights: what choosing among them costs in noise, and that it changes no mean.

mod stage;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use dapple::Isa;
use dapple::SamplePattern;
use dapple::accel::{self, AccelSpec};
use dapple::camera::Camera;
use dapple::geom::Mesh;
use dapple::light::{Punctual, PunctualKind};
use dapple::material::BsdfForm;
use dapple::math::Vec3;
use dapple::render::{Control, Rendered, Settings, render};
use dapple::scene::{Material, Scene};
use dapple::world::{LightSamplerKind, World};
use stage::{lambert, mean, rectangle, scene, settings, sphere};

/// A room of side 4 that is open towards the camera, a ball in it.
fn room() -> Vec<(Mesh, Material)> {
    let wall =
        |centre, right, up, reflectance| (rectangle(centre, right, up), lambert(reflectance));
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0);
    let mut ball = sphere(3);
    ball.positions.iter_mut().for_each(|p| *p = *p * 0.7 + Vec3::new(0.5, -1.3, 0.2));
    vec![
        wall(-y, z, x, 0.7),
        wall(y, x, z, 0.7),
        wall(-z, x, y, 0.7),
        wall(-x, y, z, 0.5),
        wall(x, z, y, 0.3),
        (ball, lambert(0.6)),
    ]
}

/// The room under a grid of lamps of one power in all, below its whole ceiling.
fn lit(columns: u32, rows: u32) -> Scene {
    let (width, depth) = (3.6 / columns as f32, 3.6 / rows as f32);
    // Each as large as a part of one lamp of 1 by 1.
    let (right, up) = (0.5 / columns as f32, 0.5 / rows as f32);
    let mut lamps = Mesh::default();
    for k in 0..columns * rows {
        let (column, row) = ((k % columns) as f32, (k / columns) as f32);
        let (x, z) = (width * (column + 0.5) - 1.8, depth * (row + 0.5) - 1.8);
        let lamp = rectangle(Vec3::new(x, 1.95, z), Vec3::X * right, Vec3::Z * up);
        let first = lamps.positions.len() as u32;
        lamps.positions.extend(lamp.positions);
        lamps.indices.extend(lamp.indices.iter().map(|t| t.map(|i| first + i)));
    }
    let mut parts = room();
    parts.push((lamps, Material { emissive: Vec3::splat(12.0), ..lambert(0.0) }));
    scene(parts)
}

fn run(scene: Scene, choice: LightSamplerKind, settings: &Settings) -> Rendered {
    let world = World::with_lights(Arc::new(scene), BsdfForm::Conserving, choice);
    let world = world.expect("few triangles");
    let spec: AccelSpec = "bvh2".parse().expect("a row of the table");
    let accel = accel::build(&spec, world.triangles.clone(), Isa::Auto).expect("within limits");
    let cancel = AtomicBool::new(false);
    let control = Control { cancel: &cancel, progress: &|_| {} };
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 7.0), Vec3::ZERO, Vec3::Y, 0.6);
    let rendered = render(&world, camera, &*accel, settings, &control);
    assert_eq!(rendered.lost_count, 0, "{:?}", rendered.lost);
    rendered
}

fn independent(side: u32, spp: u64) -> Settings {
    Settings { pattern: SamplePattern::Independent, ..settings(side, spp, 5) }
}

/// Root of the mean variance of one sample, over the mean, in the lower half of the picture: above,
/// the camera sees lamps, whose edges are noise that no choice among them takes away.
fn noise(rendered: &Rendered, spp: u64) -> f64 {
    let below = |name: &str| {
        let channel = rendered.picture.channel(name).expect("asked for");
        let below = &channel[channel.len() / 2..];
        below.iter().map(|&v| f64::from(v)).sum::<f64>() / below.len() as f64
    };
    (below("variance.G") * spp as f64).sqrt() / below("G")
}

/// A thousand small lamps make no more than half as much noise again as one, where the tree chooses
/// among them.
#[test]
fn a_thousand_lamps_are_hardly_noisier_than_one() {
    let spp = 128;
    let of = |scene, choice| noise(&run(scene, choice, &independent(48, spp)), spp);
    let one = of(lit(1, 1), LightSamplerKind::Tree);
    let tree = of(lit(40, 25), LightSamplerKind::Tree);
    let power = of(lit(40, 25), LightSamplerKind::Power);
    assert!(tree <= 1.5 * one, "one {one}, a thousand {tree}, by power {power}");
    assert!(tree < power, "{tree} {power}");
}

/// However lights are chosen, the mean is one; triangles of one and of two sides, points, spots
/// and a sun together.
#[test]
fn the_choice_changes_no_mean() {
    let made = || {
        let mut scene = lit(6, 5);
        scene.materials.last_mut().expect("the lamps").double_sided = true;
        let light = |kind, position, intensity: f32| Punctual {
            kind,
            position,
            direction: Vec3::new(0.6, -0.8, 0.0),
            intensity: Vec3::splat(intensity),
            range: None,
        };
        let spot = PunctualKind::Spot { inner: 0.2, outer: 0.5 };
        scene.lights = vec![
            light(PunctualKind::Point, Vec3::new(-1.0, 0.0, 0.5), 1.5),
            light(PunctualKind::Directional, Vec3::ZERO, 0.5),
            light(spot, Vec3::new(-1.5, 1.5, 0.0), 6.0),
        ];
        scene
    };
    let [tree, power] = [LightSamplerKind::Tree, LightSamplerKind::Power]
        .map(|choice| mean(&run(made(), choice, &independent(48, 512)).picture));
    let (off, error) = ((tree.0 - power.0).abs(), tree.1.hypot(power.1));
    assert!(off < 3.5 * error, "{tree:?} {power:?}");
    assert!(error < 0.004 * power.0, "{error} says too little");
}
