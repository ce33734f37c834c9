//! Light that goes through things: scattered in media, and by sheets.

use dapple::math::{DVec3, Vec3};
use serde_json::{Value, json};

use super::gltf::{Gltf, perspective};
use super::materials::{Rgb, emitter, matte, plastic, solid_glass};
use super::rooms::{spheres, studio};
use super::shapes::{cuboid, quad, sphere, surface};

type Files = Vec<(String, Vec<u8>)>;

/// A solid that takes away all but `left` of light over `distance` metres and scatters most of it,
/// so that it seems to have a colour.
fn scattering(mut solid: Value, left: Rgb, distance: f64, (color, g): (Rgb, f64)) -> Value {
    let extensions = &mut solid["extensions"];
    extensions["KHR_materials_volume"] = json!({
        "thicknessFactor": 1.0, "attenuationColor": left, "attenuationDistance": distance,
    });
    extensions["KHR_materials_volume_scatter"] =
        json!({ "multiscatterColorFactor": color, "scatterAnisotropy": g });
    solid
}

/// A surface whose diffuse base lets light through.
fn translucent(mut surface: Value, share: f64, color: Rgb) -> Value {
    surface["extensions"]["KHR_materials_diffuse_transmission"] =
        json!({ "diffuseTransmissionFactor": share, "diffuseTransmissionColorFactor": color });
    surface
}

fn of_index(mut solid: Value, ior: f64) -> Value {
    solid["extensions"]["KHR_materials_ior"] = json!({ "ior": ior });
    solid
}

fn prior(mut solid: Value) -> Value {
    solid["extras"] = json!({ "dapple_priority": 1 });
    solid
}

/// Media in a studio. Behind, a cloud around a lamp, milk in a ball of water in a glass, and amber
/// with haze in it; before them wax, skin, jade and smoke, and a slab of soap.
pub fn media() -> Files {
    let mut g = Gltf::new("media");
    studio(&mut g, [10.0, 9.8, 9.6], [14.0, 15.0, 17.0]);
    let clear = || solid_glass([1.0; 3], 1.0, 0.0);
    let e = [0.37; 3];
    let cloud = scattering(of_index(clear(), 1.0), e, 0.5, ([0.95, 0.96, 0.98], 0.3));
    let milk = scattering(of_index(clear(), 1.33), e, 0.04, ([0.93, 0.9, 0.83], 0.6));
    let haze = scattering(clear(), [0.7, 0.35, 0.05], 0.5, ([0.8, 0.5, 0.1], 0.0));
    let wax = translucent(plastic([0.9, 0.85, 0.7], 0.4), 0.9, [1.0; 3]);
    let wax = scattering(wax, [0.4, 0.3, 0.2], 0.1, ([0.95, 0.8, 0.45], 0.0));
    let skin = translucent(plastic([0.8, 0.6, 0.5], 0.5), 1.0, [1.0; 3]);
    let skin = scattering(skin, [0.5, 0.2, 0.1], 0.06, ([0.8, 0.5, 0.4], 0.0));
    let jade = scattering(clear(), [0.3, 0.6, 0.4], 0.15, ([0.3, 0.75, 0.4], 0.2));
    let smoke = scattering(of_index(clear(), 1.0), [0.3; 3], 0.25, ([0.2, 0.2, 0.22], -0.3));
    spheres(
        &mut g,
        &sphere(36).plain(),
        &[
            (cloud, [-2.6, 1.05, -0.6], 1.0),
            (emitter([60.0, 42.0, 24.0]), [-2.6, 1.0, -0.6], 0.12),
            (clear(), [0.0, 1.05, -0.6], 1.05),
            (of_index(clear(), 1.33), [0.0, 1.05, -0.6], 0.85),
            (prior(milk), [0.0, 0.95, -0.6], 0.55),
            (haze, [2.6, 0.95, -0.6], 0.95),
            (wax, [-2.35, 0.5, 1.8], 0.5),
            (skin, [-1.05, 0.5, 1.9], 0.5),
            (jade, [0.25, 0.5, 1.9], 0.5),
            (smoke, [2.9, 0.55, 1.7], 0.5),
        ],
    );
    let soap = translucent(plastic([0.8, 0.85, 0.9], 0.3), 1.0, [1.0; 3]);
    let soap = scattering(soap, [0.5, 0.6, 0.7], 0.1, ([0.7, 0.85, 0.95], 0.0));
    let soap = g.push("materials", soap);
    let bar = cuboid(Vec3::new(1.2, 0.005, 1.6), Vec3::new(2.1, 0.35, 2.2));
    g.place("soap", &bar.plain(), soap);
    g.camera(Vec3::new(0.0, 3.4, 11.5), Vec3::new(0.0, 0.85, 0.0), perspective(31.0, 2.0));
    g.finish()
}

/// Sheets that let light through scattered: five of growing share before a lamp, a picture among
/// them, and a paper lantern.
pub fn leaves() -> Files {
    let mut g = Gltf::new("leaves");
    studio(&mut g, [2.0, 2.1, 2.3], [1.0, 1.2, 1.5]);
    let lamp = g.push("materials", emitter([9.0, 8.5, 7.5]));
    let tube = quad(Vec3::new(-4.4, 0.3, -1.4), Vec3::X * 6.6, Vec3::Y * 1.6);
    g.place("lamp", &tube.plain(), lamp);
    let leaf = surface(16, 12, false, |u, v| {
        let (across, along) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        let width = 0.52 * (1.0 - 0.35 * along * along);
        let bow = 0.12 * across * across - 0.1 * along;
        DVec3::new(width * across, 0.95 + 0.85 * along, bow)
    });
    let bricks = g.texture("textures/bricks.png", json!({ "magFilter": 9729 }));
    let mut mesh: Option<usize> = None;
    for k in 0..5_u8 {
        let share = f64::from(k) / 4.0;
        let mut material = translucent(plastic([0.12, 0.3, 0.05], 0.35), share, [0.55, 0.8, 0.1]);
        if k == 3 {
            let extension = &mut material["extensions"]["KHR_materials_diffuse_transmission"];
            extension["diffuseTransmissionColorTexture"] = json!({ "index": bricks });
        }
        let material = g.push("materials", material);
        let mesh = match mesh {
            Some(first) => g.mesh_again(first, material),
            None => *mesh.insert(g.mesh(&leaf, material)),
        };
        let at = [-3.8 + 1.35 * f32::from(k), 0.0, 0.4];
        g.root(json!({ "name": format!("leaf {share}"), "mesh": mesh, "translation": at }));
    }
    let paper = translucent(matte([0.75, 0.7, 0.6]), 0.5, [0.95, 0.85, 0.65]);
    spheres(
        &mut g,
        &sphere(28).plain(),
        &[(paper, [3.4, 1.05, 0.4], 0.95), (emitter([30.0, 22.0, 13.0]), [3.4, 0.95, 0.4], 0.25)],
    );
    g.camera(Vec3::new(0.0, 3.0, 11.5), Vec3::new(0.0, 0.95, 0.0), perspective(31.0, 2.0));
    g.finish()
}
