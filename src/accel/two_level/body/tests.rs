//! Which bodies are found, and that their vertices are where they are told to be.

use glam::DQuat;

use super::super::bodies::find_bodies;
use super::super::placement::LocalRay;
use super::*;
use crate::accel::Phases;
use crate::geom::Mesh;
use crate::math::{MaterialId, MeshId};
use crate::motion::{Link, Motion, MovingParts, Track};
use crate::scene::{Instance, Material, Scene, Transform, Triangles};
use crate::testing::Random;

/// Triangles about the origin.
fn soup(count: u32) -> Arc<Mesh> {
    let mut mesh = Mesh::default();
    for number in 0..count {
        let random = &mut Random::new(3, u64::from(number));
        mesh.positions.extend([random.cube(), random.cube(), random.cube()]);
        mesh.indices.push([3 * number, 3 * number + 1, 3 * number + 2]);
    }
    Arc::new(mesh)
}

/// What turns once, and jumps.
fn hub(tilt: f64) -> Motion {
    let turn = |part: f64| (part, DQuat::from_rotation_z(part * std::f64::consts::TAU));
    let translation = [(0.0, DVec3::ZERO), (0.4, DVec3::X), (0.4, DVec3::Y), (1.0, DVec3::Z)];
    let parts = MovingParts {
        translation: Track::new(&translation).expect("has keys"),
        rotation: Track::new(&[0.0, 0.25, 0.5, 0.75, 1.0].map(turn)).expect("has keys"),
        scale: Track::still(DVec3::ONE),
    };
    let tilt = Link::Still(DAffine3::from_rotation_x(tilt));
    Motion::new([tilt, Link::Moving(Arc::new(parts))]).expect("moves")
}

/// A scene of meshes of so many triangles, placed by hubs.
fn levels(meshes: &[u32], placed: &[(&Motion, u32, DAffine3)]) -> Levels {
    let mut scene = Scene {
        meshes: meshes.iter().map(|&count| soup(count)).collect(),
        materials: vec![Material::default()],
        ..Scene::default()
    };
    for (number, (hub, mesh, inner)) in placed.iter().enumerate() {
        let motion = hub.around(*inner);
        let start = motion.at(0.0).to_cols_array().map(|x| x as f32);
        let transform = Transform::new(Affine3A::from_cols_array(&start));
        scene.instances.push(Instance { mesh: MeshId(*mesh), material: MaterialId(0), transform });
        scene.motion_mut().move_placement(number, Arc::new(motion));
    }
    let triangles = Triangles::new(Arc::new(scene)).expect("few");
    let placed = Placed::new(Arc::new(triangles)).expect("placed");
    Levels::new(placed, true, &mut Phases::start())
}

fn at(x: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::X * x)
}

/// Blades about the hub: copies, one mirrored and sheared, a small one and a flat one.
fn blades() -> [(u32, DAffine3); 5] {
    let scaled = |x: f64, y: f64, z: f64| DAffine3::from_scale(DVec3::new(x, y, z));
    let turned = DAffine3::from_rotation_z(2.0);
    [
        (0, at(1.0) * scaled(1.0, 1.0, 0.0)),
        (0, at(2.0)),
        (0, turned * at(2.0)),
        (1, turned * scaled(-1.0, 3.0, 0.5) * DAffine3::from_rotation_y(1.0)),
        (1, at(5.0) * scaled(1e-3, 1e-3, 1e-3)),
    ]
}

#[test]
fn blades_on_a_hub_are_one_body_and_others_are_none() {
    let [a, b, c] = [0.1, 0.2, 0.3].map(hub);
    let mut placed: Vec<_> = blades().into_iter().map(|(mesh, inner)| (&a, mesh, inner)).collect();
    // By itself; and together too few triangles.
    placed.extend([(&b, 0, at(1.0)), (&c, 1, at(0.0)), (&c, 1, at(1.0))]);
    let bodies = find_bodies(&levels(&[60, 9], &placed));
    let members: Vec<&[u32]> = bodies.iter().map(|body| &*body.members).collect();
    assert_eq!(members, [[0, 1, 2, 3, 4]]);
    assert_eq!(bodies[0].own.len(), 198);
    // Not one that is flat or stretched.
    assert!([1, 2, 4].contains(&bodies[0].base.0));
}

#[test]
fn copies_are_made_as_far_as_there_is_room() {
    let [a, b] = [0.1, 0.2].map(hub);
    let copies = |count: u32, hub| (0..count).map(move |i| (hub, 0, at(f64::from(i))));
    let of = |placed: Vec<_>| {
        let bodies = find_bodies(&levels(&[40_000], &placed));
        bodies.iter().map(|body| body.members.len()).collect::<Vec<_>>()
    };
    assert_eq!(of(copies(2, &a).collect()), [2]);
    assert_eq!(of(copies(3, &a).collect()), [0; 0]);
    assert_eq!(of(copies(2, &a).chain(copies(2, &b)).collect()), [2]);
}

#[test]
fn vertices_are_where_the_way_into_the_body_leads() {
    let hub = hub(0.4);
    let placed: Vec<_> = blades().into_iter().map(|(mesh, inner)| (&hub, mesh, inner)).collect();
    let levels = levels(&[60, 9], &placed);
    let bodies = find_bodies(&levels);
    let motions = levels.placed.get().motions().expect("it moves");
    let (body, random) = (&bodies[0], &mut Random::new(8, 0));
    for _ in 0..20_000 {
        let (time, prim) = (random.unit(), PrimId(random.below(body.own.len()) as u32));
        let OwnTriangle { id, corners } = *body.own(prim);
        let vertex = motions.to_world_at(id.instance, time).transform_point3(corners.b);
        let ray = Ray::new(vertex, Vec3::X, 0.0, f32::INFINITY);
        match body.enter(time, &ray, f32::INFINITY) {
            Some(Entered::Inside(LocalRay { ray, shift })) => {
                let off = (ray.origin() - body.triangles.triangle(prim).b).abs().max_element();
                assert!(shift == 0.0 && off <= body.apart.slack, "{off} at {time}");
            }
            Some(_) => panic!("it begins outside at {time}"),
            // What jumps leaves no way through.
            None => assert!((time - 0.4).abs() <= 1.0 / body.ways.len() as f32, "{time}"),
        }
    }
    let ray = Ray::new(Vec3::ZERO, Vec3::X, 0.0, f32::INFINITY);
    assert!(body.enter(0.4, &ray, f32::INFINITY).is_none());
}
