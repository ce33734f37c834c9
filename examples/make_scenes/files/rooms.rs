//! Light in closed rooms and studios.

use dapple::math::Vec3;
use serde_json::{Value, json};

use super::gltf::{Gltf, perspective, rounded};
use super::materials::{emitter, matte, metal, plastic, solid_glass, thin_glass};
use super::shapes::{Shape, cuboid, face, quad, sphere, torus};

type Files = Vec<(String, Vec<u8>)>;

/// The Cornell box by its measured data (<https://www.graphics.cornell.edu/online/box/data.html>)
/// at a hundredth, turned so that it opens towards +Z.
pub fn cornell() -> Files {
    let mut g = Gltf::new("cornell");
    let white = g.push("materials", matte([0.73, 0.73, 0.73]));
    let red = g.push("materials", matte([0.63, 0.065, 0.05]));
    let green = g.push("materials", matte([0.14, 0.45, 0.091]));
    let light = g.push("materials", emitter([27.0, 22.0, 15.0]));

    // The data's x points left and its z away from the camera.
    let metres = |corners: [[f32; 3]; 4]| {
        face(corners.map(|[x, y, z]| [(278.0 - x) / 100.0, y / 100.0, -z / 100.0]))
    };
    let prism = |top: [[f32; 2]; 4], height: f32| {
        let mut shape = metres(top.map(|[x, z]| [x, height, z]));
        for k in 0..4 {
            let ([ax, az], [bx, bz]) = (top[k], top[(k + 1) % 4]);
            shape.add(&metres([[ax, height, az], [ax, 0.0, az], [bx, 0.0, bz], [bx, height, bz]]));
        }
        shape
    };
    let (w, h, d) = (552.8, 548.8, 559.2);
    g.place("floor", &metres([[w, 0.0, 0.0], [0.0; 3], [0.0, 0.0, d], [w, 0.0, d]]), white);
    g.place("ceiling", &metres([[w, h, 0.0], [w, h, d], [0.0, h, d], [0.0, h, 0.0]]), white);
    g.place("back wall", &metres([[w, 0.0, d], [0.0, 0.0, d], [0.0, h, d], [w, h, d]]), white);
    g.place("right wall", &metres([[0.0, 0.0, d], [0.0; 3], [0.0, h, 0.0], [0.0, h, d]]), green);
    g.place("left wall", &metres([[w, 0.0, 0.0], [w, 0.0, d], [w, h, d], [w, h, 0.0]]), red);
    let short = [[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]];
    g.place("short block", &prism(short, 165.0), white);
    let tall = [[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]];
    g.place("tall block", &prism(tall, 330.0), white);
    // Just below the ceiling, in whose plane the data have it.
    let y = 548.0;
    let lamp = [[343.0, y, 227.0], [343.0, y, 332.0], [213.0, y, 332.0], [213.0, y, 227.0]];
    g.place("light", &metres(lamp), light);

    let eye = Vec3::new(0.0, 2.73, 8.0);
    g.camera(eye, eye - Vec3::Z, perspective(37.6, 1.0));
    g.finish()
}

/// White spheres that reflect all they get: under a sky of one radiance they cannot be seen.
/// `--env 1,1,1`, and any shade that differs from 1 is an error.
pub fn furnace() -> Files {
    let mut g = Gltf::new("furnace");
    let white = [1.0; 3];
    let materials = [
        matte(white),
        metal(white, 0.0),
        metal(white, 0.3),
        metal(white, 0.6),
        metal(white, 1.0),
        plastic(white, 0.1),
        plastic(white, 0.4),
        plastic(white, 1.0),
    ];
    let ball = sphere(48).plain();
    let mut mesh = None;
    for (k, material) in materials.into_iter().enumerate() {
        let material = g.push("materials", material);
        let mesh = match mesh {
            Some(first) => g.mesh_again(first, material),
            None => *mesh.insert(g.mesh(&ball, material)),
        };
        let (column, row) = ((k % 4) as f32, (k / 4) as f32);
        let at = [2.2 * (column - 1.5), 2.2 * (0.5 - row), 0.0];
        g.root(json!({ "mesh": mesh, "translation": rounded(at) }));
    }
    g.camera(Vec3::new(0.0, 0.0, 14.0), Vec3::ZERO, perspective(24.0, 16.0 / 9.0));
    g.finish()
}

/// Places spheres that share the triangles of one about the origin: material, centre and radius of
/// each.
pub fn spheres(g: &mut Gltf, sphere: &Shape, balls: &[(Value, [f32; 3], f32)]) {
    let mut mesh: Option<usize> = None;
    for (material, centre, radius) in balls {
        let material = g.push("materials", material.clone());
        let mesh = match mesh {
            Some(first) => g.mesh_again(first, material),
            None => *mesh.insert(g.mesh(sphere, material)),
        };
        let scale = [*radius; 3];
        g.root(json!({
            "mesh": mesh, "translation": rounded(*centre), "scale": rounded(scale),
        }));
    }
}

/// A floor that bends up into a back wall, as photographers have it.
pub fn backdrop() -> Shape {
    let bend = |t: f32| {
        // Flat up to a third, a quarter circle of radius 3 up to two thirds, then upright.
        let (along, turn) = (t * 3.0, (t * 3.0 - 1.0).clamp(0.0, 1.0));
        let (sin, cos) = libm::sincosf(turn * std::f32::consts::FRAC_PI_2);
        let z = 7.0 - 10.0 * along.min(1.0) - 3.0 * sin;
        [z, 3.0 * (1.0 - cos) + 6.0 * (along - 2.0).max(0.0)]
    };
    let mut shape = Shape::default();
    let steps = 48;
    for k in 0..=steps {
        let t = k as f32 / steps as f32;
        let ([z, y], [az, ay]) = (bend(t), bend(t + 1e-3));
        let normal = Vec3::new(0.0, -(az - z), ay - y).normalize();
        for x in [-16.0, 16.0] {
            shape.positions.push([x, y, z]);
            shape.normals.push(normal.to_array());
        }
    }
    for k in 0..steps as u16 {
        let a = 2 * k;
        shape.indices.extend([a, a + 1, a + 3, a, a + 3, a + 2]);
    }
    shape
}

/// A backdrop with a soft light above and a strip of light on the left.
pub fn studio(g: &mut Gltf, above: [f64; 3], left: [f64; 3]) {
    let paper = g.push("materials", matte([0.32, 0.33, 0.36]));
    let soft = g.push("materials", emitter(above));
    let strip = g.push("materials", emitter(left));
    g.place("backdrop", &backdrop(), paper);
    let above = quad(Vec3::new(-3.5, 6.5, 3.0), Vec3::X * 7.0, Vec3::new(0.0, 1.0, -3.0));
    let above = Shape { indices: above.indices.iter().rev().copied().collect(), ..above };
    g.place("softbox", &Shape { normals: Vec::new(), ..above.plain() }, soft);
    let left = quad(Vec3::new(-8.0, 0.5, 3.5), Vec3::new(0.6, 0.0, -2.2), Vec3::Y * 4.5);
    g.place("strip light", &left.plain(), strip);
}

/// Gold and aluminium of roughness 0 to 1 in a studio.
pub fn metals() -> Files {
    let mut g = Gltf::new("metals");
    studio(&mut g, [7.0, 6.7, 6.4], [5.0, 7.5, 12.0]);
    let mut balls = Vec::new();
    for k in 0..6 {
        let (step, roughness) = (k as f32 - 2.5, f64::from(k) / 5.0);
        let gold = metal([1.0, 0.71, 0.29], roughness);
        balls.push((gold, [2.05 * step, 0.9, -0.6], 0.9));
        let aluminium = metal([0.91, 0.92, 0.92], roughness);
        balls.push((aluminium, [1.35 * step, 0.52, 1.5], 0.52));
    }
    spheres(&mut g, &sphere(80).plain(), &balls);
    g.camera(Vec3::new(0.0, 3.4, 11.5), Vec3::new(0.0, 0.85, 0.0), perspective(31.0, 2.0));
    g.finish()
}

/// Glass: smooth, rough, thin and coloured, on a checkered floor in a lit room.
pub fn glass() -> Files {
    let mut g = Gltf::new("glass");
    let nearest = json!({ "magFilter": 9728, "minFilter": 9728 });
    let checker = g.texture("textures/checker.png", nearest);
    let mut floor = matte([1.0; 3]);
    floor["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": checker });
    let floor = g.push("materials", floor);
    let wall = g.push("materials", matte([0.75, 0.74, 0.7]));
    let teal = g.push("materials", matte([0.12, 0.42, 0.45]));
    let light = g.push("materials", emitter([14.0, 13.0, 11.5]));

    let (x, y, z) = (Vec3::X * 9.0, Vec3::Y * 5.0, Vec3::Z * 12.0);
    let corner = Vec3::new(-4.5, 0.0, -3.5);
    g.place("floor", &quad(corner + z, x, -z).tiled(4.5, 6.0), floor);
    g.place("ceiling", &quad(corner + y, x, z).plain(), wall);
    g.place("back wall", &quad(corner, x, y).plain(), teal);
    g.place("left wall", &quad(corner + z, -z, y).plain(), wall);
    g.place("right wall", &quad(corner + x, z, y).plain(), wall);
    g.place("front wall", &quad(corner + x + z, -x, y).plain(), wall);
    let lamp = quad(Vec3::new(-1.6, 4.98, -1.2), Vec3::X * 3.2, Vec3::Z * 2.4);
    g.place("light", &lamp.plain(), light);

    let clear = solid_glass([1.0; 3], 1.0, 0.0);
    spheres(
        &mut g,
        &sphere(80).plain(),
        &[
            (clear, [-2.3, 1.0, -0.6], 1.0),
            (solid_glass([1.0; 3], 1.0, 0.35), [2.3, 1.0, -0.6], 1.0),
            (thin_glass([1.0, 1.0, 1.0], 0.0), [0.0, 1.15, -1.6], 1.15),
            (solid_glass([0.1, 0.55, 0.25], 0.45, 0.0), [-0.95, 0.5, 1.5], 0.5),
        ],
    );
    let amber = g.push("materials", solid_glass([0.9, 0.4, 0.05], 0.25, 0.0));
    let ring = g.mesh(&torus(96, 32, 0.36).plain(), amber);
    g.root(json!({
        "name": "ring", "mesh": ring, "translation": [1.0, 0.27, 1.5], "scale": [0.75, 0.75, 0.75],
    }));
    let blue = g.push("materials", solid_glass([0.25, 0.45, 0.95], 0.5, 0.0));
    let block = g.mesh(&cuboid(Vec3::splat(-0.4), Vec3::splat(0.4)).plain(), blue);
    let turn = [0.0, 0.258_819, 0.0, 0.965_926];
    g.root(json!({
        "name": "block", "mesh": block, "translation": [2.6, 0.41, 1.3], "rotation": turn,
    }));
    g.camera(Vec3::new(0.0, 2.3, 7.6), Vec3::new(0.0, 0.95, 0.0), perspective(35.0, 16.0 / 9.0));
    g.finish()
}
