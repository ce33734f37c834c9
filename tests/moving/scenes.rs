//! Scenes of which all or some moves.

use std::sync::Arc;

use dapple::Scene;
use dapple::geom::{Deformation, Mesh, VertexKey};
use dapple::math::{Affine3A, DAffine3, DQuat, DVec3, MaterialId, MeshId, Vec3};
use dapple::motion::{Link, Motion, MovingParts, Track};
use dapple::scene::{Instance, Material, Transform};
use dapple::testing::Random;

/// Triangles about the origin.
fn soup(seed: u64, count: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for number in 0..count {
        let random = &mut Random::new(seed, u64::from(number));
        let at = random.cube() * 2.0 - 1.0;
        let corner = |random: &mut Random| at + (random.cube() - 0.5) * 0.4;
        mesh.positions.extend([corner(random), corner(random), corner(random)]);
        mesh.indices.push([3 * number, 3 * number + 1, 3 * number + 2]);
    }
    mesh
}

/// A turn about an axis, and a way with a jump; by scales at both ends.
pub fn turning(axis: DVec3, turns: f64, scale: [DVec3; 2], way: DVec3) -> Link {
    let steps = (turns * 4.0).ceil() as i32;
    let key = |step: i32| {
        let part = f64::from(step) / f64::from(steps);
        (part, DQuat::from_axis_angle(axis.normalize(), part * turns * std::f64::consts::TAU))
    };
    let keys: Vec<_> = (0..=steps).map(key).collect();
    Link::Moving(Arc::new(MovingParts {
        translation: Track::new(&[(0.0, DVec3::ZERO), (0.4, way), (0.4, -way), (1.0, way)])
            .expect("has keys"),
        rotation: Track::new(&keys).expect("has keys"),
        scale: Track::new(&[(0.0, scale[0]), (1.0, scale[1])]).expect("has keys"),
    }))
}

/// Still, turning, mirrored midway, flat at the end, deforming, both, and many copies.
pub fn scene() -> Scene {
    let meshes = [soup(1, 120), soup(2, 40), soup(3, 60)];
    let bent = |time: f64| {
        let moved = meshes[1].positions.iter().enumerate().map(|(i, p)| {
            let swing = libm::sinf(time as f32 * 5.0 + i as f32);
            *p + Vec3::new(swing * 0.3, time as f32, swing * swing * 0.2)
        });
        VertexKey { time, positions: moved.collect(), ..VertexKey::default() }
    };
    let deformation = Deformation::new([0.0, 0.3, 0.5, 1.0].map(bent).to_vec());
    let first = Mesh { positions: bent(0.0).positions, ..meshes[1].clone() };
    let still = |at: Vec3| {
        Affine3A::from_scale_rotation_translation(
            Vec3::new(1.0, 0.5, 2.0),
            dapple::math::Quat::from_rotation_x(at.y),
            at,
        )
    };
    let one = DVec3::ONE;
    let around = |at: Vec3| Link::Still(DAffine3::from_translation(at.as_dvec3()));
    let fast = turning(DVec3::new(0.2, 1.0, 0.1), 2.8, [one, one], DVec3::ZERO);
    let mirrored = turning(DVec3::X, 0.3, [one, DVec3::new(-1.0, 1.0, 0.7)], DVec3::Y);
    let flat = turning(DVec3::Z, 0.1, [one, DVec3::new(1.0, 0.0, 1.0)], DVec3::X);
    let outer = turning(DVec3::Y, 0.2, [one, one * 1.5], DVec3::new(0.5, 0.0, -0.5));
    let moving = [
        (0, vec![around(Vec3::new(3.0, 0.0, 0.0)), fast.clone()]),
        (2, vec![around(Vec3::new(-3.0, 0.0, 1.0)), mirrored]),
        (2, vec![around(Vec3::new(0.0, 3.0, 0.0)), flat]),
        (1, vec![outer.clone(), around(Vec3::new(0.0, 0.0, 3.0)), fast.clone()]),
        (2, vec![around(Vec3::new(1e5, 1e5, 0.0)), outer, around(-Vec3::splat(0.5))]),
    ];
    let mut scene = Scene {
        meshes: [meshes[0].clone(), first, meshes[2].clone()].map(Arc::new).to_vec(),
        materials: vec![Material::default()],
        ..Scene::default()
    };
    let place = |scene: &mut Scene, mesh: u32, to_world: Affine3A| {
        let transform = Transform::new(to_world);
        scene.instances.push(Instance { mesh: MeshId(mesh), material: MaterialId(0), transform });
    };
    for number in 0..4 {
        place(&mut scene, number % 3, still(Vec3::new(number as f32, -3.0, 0.5)));
    }
    for (mesh, links) in moving {
        let motion = Motion::new(links).expect("moves");
        let start = motion.at(0.0).to_cols_array().map(|x| x as f32);
        let number = scene.instances.len();
        scene.motion_mut().move_placement(number, Arc::new(motion));
        place(&mut scene, mesh, Affine3A::from_cols_array(&start));
    }
    scene.motion_mut().deform(1, Arc::new(deformation.expect("has keys")));
    scene
}

/// Ninety more that move, each on a way of its own, and thirty that stand still beside them.
pub fn crowd() -> Scene {
    let mut scene = scene();
    for number in 0..120_u32 {
        let random = &mut Random::new(5, u64::from(number));
        let (at, way) = (random.cube() * 12.0 - 6.0, random.sphere().as_dvec3());
        let at = Link::Still(DAffine3::from_translation(at.as_dvec3()));
        let turns = f64::from(number % 7) * 0.1 + 0.1;
        let chain = [at, turning(way, turns, [DVec3::splat(0.4); 2], way)];
        let motion = Motion::new(chain).expect("moves");
        let start = motion.at(0.0).to_cols_array().map(|x| x as f32);
        let transform = Transform::new(Affine3A::from_cols_array(&start));
        if number % 4 != 0 {
            let number = scene.instances.len();
            scene.motion_mut().move_placement(number, Arc::new(motion));
        }
        let (mesh, material) = (MeshId(2 * (number % 2)), MaterialId(0));
        scene.instances.push(Instance { mesh, material, transform });
    }
    scene
}

/// As many copies as are too many to be looked into, beside what moves.
pub fn many_copies() -> Scene {
    let mut scene = scene();
    let mesh = MeshId(scene.meshes.len() as u32);
    scene.meshes.push(Arc::new(soup(7, 20)));
    for number in 0..17_000_u32 {
        let random = &mut Random::new(8, u64::from(number));
        let to_world = Affine3A::from_translation(random.cube() * 60.0 - 30.0);
        let transform = Transform::new(to_world);
        scene.instances.push(Instance { mesh, material: MaterialId(0), transform });
    }
    scene
}

/// Thirty triangles that stand still, and so many of: one triangle that spins, five that jump as
/// well, twelve on a way of two links, and three that are bent, last of all just before the shutter
/// closes.
pub fn small(count: usize) -> Scene {
    let meshes = [soup(11, 1), soup(12, 5), soup(13, 12), soup(14, 3), soup(15, 30)];
    let (one, jump) = (DVec3::ONE, DVec3::new(1.0, 0.5, 0.0));
    let jumping = Link::Moving(Arc::new(MovingParts {
        translation: Track::new(&[(0.0, one), (0.5, jump), (0.5, -jump), (1.0, one), (1.0, jump)])
            .expect("has keys"),
        rotation: Track::new(&[(0.0, DQuat::IDENTITY), (1.0, DQuat::from_rotation_y(2.0))])
            .expect("has keys"),
        scale: Track::still(DVec3::new(1.0, -0.5, 2.0)),
    }));
    let spin = turning(DVec3::new(0.3, 0.2, 1.0), 2.8, [one, one], DVec3::X);
    let wide = turning(DVec3::Y, 0.4, [one, one * 2.0], DVec3::Y);
    let ways = [vec![spin.clone()], vec![jumping], vec![wide, spin]];
    let bent = |(time, by): (f64, f32)| {
        let positions = meshes[3].positions.iter().map(|p| *p + Vec3::new(by, by * p.x, 0.0));
        VertexKey { time, positions: positions.collect(), ..VertexKey::default() }
    };
    let keys = [(0.0, 0.0), (0.3, 2.0), (0.5, 1.0), (1.0 - 1e-8, 1.5), (1.0, 4.0)];
    let deformation = Deformation::new(keys.map(bent).to_vec()).expect("has keys");
    let mut scene = Scene {
        meshes: meshes.map(Arc::new).to_vec(),
        materials: vec![Material::default()],
        ..Scene::default()
    };
    for (number, links) in ways.into_iter().map(Some).chain([None]).take(count).enumerate() {
        let motion = links.map(|links| Motion::new(links).expect("moves"));
        let start = motion.as_ref().map_or(DAffine3::IDENTITY, |motion| motion.at(0.0));
        let start = Affine3A::from_cols_array(&start.to_cols_array().map(|x| x as f32));
        let (transform, material) = (Transform::new(start), MaterialId(0));
        scene.instances.push(Instance { mesh: MeshId(number as u32), material, transform });
        match motion {
            Some(motion) => scene.motion_mut().move_placement(number, Arc::new(motion)),
            None => scene.motion_mut().deform(3, Arc::new(deformation.clone())),
        }
    }
    let transform = Transform::new(Affine3A::IDENTITY);
    scene.instances.push(Instance { mesh: MeshId(4), material: MaterialId(0), transform });
    scene
}

/// Stiff bodies: hubs that turn, and jump, with blades that are copies, mirrored, sheared, small
/// and far out; and some of the same meshes by themselves.
pub fn bodies() -> Scene {
    let meshes = [soup(21, 60), soup(22, 9), soup(23, 200)];
    let mut scene = Scene {
        meshes: meshes.map(Arc::new).to_vec(),
        materials: vec![Material::default()],
        ..Scene::default()
    };
    let mut place = |mesh: u32, start: DAffine3, motion: Option<Motion>| {
        let start = Affine3A::from_cols_array(&start.to_cols_array().map(|x| x as f32));
        if let Some(motion) = motion {
            let number = scene.instances.len();
            scene.motion_mut().move_placement(number, Arc::new(motion));
        }
        let (transform, material) = (Transform::new(start), MaterialId(0));
        scene.instances.push(Instance { mesh: MeshId(mesh), material, transform });
    };
    let at = |x: f64, y: f64, z: f64| DAffine3::from_translation(DVec3::new(x, y, z));
    let blade = |turned: f64, scale: [f64; 3]| {
        let scale = DAffine3::from_scale(DVec3::from(scale));
        DAffine3::from_rotation_z(turned)
            * at(2.0, 0.0, 0.0)
            * scale
            * DAffine3::from_rotation_x(1.0)
    };
    let blades = [
        (0, blade(0.0, [1.0, 0.3, 0.5])),
        (0, blade(2.1, [1.0, 0.3, 0.5])),
        (1, blade(4.2, [-1.0, 2.0, 0.5])),
        (2, blade(5.0, [1e-3, 1e-3, 1e-3])),
        (1, at(0.0, 40.0, 0.0)),
        (2, DAffine3::IDENTITY),
    ];
    let one = DVec3::ONE;
    let tilt = |x: f64| Link::Still(at(x, 0.0, 0.0) * DAffine3::from_rotation_y(0.5));
    let spin = turning(DVec3::Z, 2.8, [one, one], DVec3::ZERO);
    let jumps = turning(DVec3::new(0.1, 0.2, 1.0), 0.6, [one, one], DVec3::Y);
    let grows = turning(DVec3::Y, 0.2, [one, one * 1.5], DVec3::X);
    let hubs =
        [vec![tilt(0.0), spin.clone()], vec![tilt(9.0), jumps], vec![grows, tilt(-9.0), spin]];
    for hub in hubs {
        let hub = Motion::new(hub).expect("moves");
        for (mesh, inner) in blades {
            let motion = hub.around(inner);
            place(mesh, motion.at(0.0), Some(motion));
        }
        place(0, at(0.0, 0.0, 5.0), None);
    }
    scene
}
