//! Whatever moves while the shutter is open, each ray sees it as it is at its own time: every
//! structure as brute force over the triangles of that time, to the bit.

use std::sync::Arc;

use dapple::accel::HitFilter;
use dapple::geom::{Deformation, Mesh, Triangle, TriangleList, TriangleSource, VertexKey};
use dapple::math::{Affine3A, DAffine3, DQuat, DVec3, MaterialId, MeshId, PrimId, Ray, Vec3};
use dapple::motion::{Link, Motion, MovingParts, Track};
use dapple::scene::{Instance, Material, Transform, Triangles};
use dapple::testing::Random;
use dapple::{AccelSpec, AnyHit, Batch, ClosestHit, Isa, Scene, VARIANTS, build};

/// The times of the rays, in turn; some beside those at which things jump.
const TIMES: [f32; 12] = [
    0.0,
    0.125,
    0.33,
    0.399_999_98,
    0.400_000_03,
    0.5_f32.next_down(),
    0.5,
    0.666,
    0.75,
    0.999,
    1.0_f32.next_down(),
    1.0,
];

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

fn turning(axis: DVec3, turns: f64, scale: [DVec3; 2], way: DVec3) -> Link {
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
fn scene() -> Scene {
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
fn crowd() -> Scene {
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

/// So many of: one triangle that spins, five that jump as well, twelve on a way of two links, and
/// three that are bent, last of all just before the shutter closes.
fn small(count: usize) -> Scene {
    let meshes = [soup(11, 1), soup(12, 5), soup(13, 12), soup(14, 3)];
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
    scene
}

/// Rays at what is there at their times, each with its time.
fn rays(triangles: &Triangles, count: u32) -> (Vec<Ray>, Vec<f32>) {
    let times: Vec<f32> = (0..count).map(|i| TIMES[i as usize % TIMES.len()]).collect();
    let ray = |i: u32| {
        let random = &mut Random::new(9, u64::from(i));
        let prim = PrimId(random.below(triangles.len()) as u32);
        let seen = triangles.of_at(triangles.locate(prim), times[i as usize]);
        let target = match i % 3 {
            0 => seen.a,
            1 => (seen.a + seen.b) * 0.5,
            _ => (seen.a + seen.b + seen.c) / 3.0,
        };
        let from = target + random.sphere() * if i.is_multiple_of(5) { 300.0 } else { 4.0 };
        let t_max = if i.is_multiple_of(4) { 1.5 } else { f32::INFINITY };
        Ray::new(from, target - from, 0.0, t_max)
    };
    ((0..count).map(ray).collect(), times)
}

/// What brute force finds of all triangles as they are at the rays' times.
fn oracle(triangles: &Triangles, rays: &[Ray], times: &[f32]) -> Vec<ClosestHit> {
    let mut found = vec![ClosestHit::MISS; rays.len()];
    for time in TIMES {
        let prims = (0..triangles.len() as u32).map(PrimId);
        let of_time: Vec<Triangle> =
            prims.map(|prim| triangles.of_at(triangles.locate(prim), time)).collect();
        let spec: AccelSpec = "brute".parse().expect("a row of the table");
        let brute = build(&spec, Arc::new(TriangleList(of_time)), Isa::Auto).expect("builds");
        let numbers: Vec<usize> = (0..rays.len()).filter(|&i| times[i] == time).collect();
        let of_time: Vec<Ray> = numbers.iter().map(|&i| rays[i]).collect();
        let mut hits = vec![ClosestHit::MISS; of_time.len()];
        brute.tracer().closest_hits(&Batch::new(&of_time), &mut hits);
        for (number, mut hit) in numbers.into_iter().zip(hits) {
            if hit.is_hit() {
                hit.triangle = triangles.locate(PrimId(hit.triangle.index));
            }
            found[number] = hit;
        }
    }
    found
}

fn compare(spec: &str, triangles: &Arc<Triangles>, (rays, times): (&[Ray], &[f32])) {
    let expected = oracle(triangles, rays, times);
    let spec: AccelSpec = spec.parse().expect("a row of the table");
    let accel = build(&spec, triangles.clone(), Isa::Auto).expect("builds");
    let batch = Batch::new(rays).with_times(Some(times));
    let mut hits = vec![ClosestHit::MISS; rays.len()];
    let mut any = vec![AnyHit(false); rays.len()];
    accel.tracer().closest_hits(&batch, &mut hits);
    accel.tracer().any_hits(&batch, &mut any);
    for (i, expected) in expected.iter().enumerate() {
        let (hit, time) = (hits[i], times[i]);
        assert!(hit.same_bits(expected), "{spec}, ray {i} at {time}: {hit:?}, not {expected:?}");
        assert_eq!(any[i].0, expected.is_hit(), "{spec}, ray {i} at {time}");
    }
}

#[test]
fn every_row_sees_what_moves_as_brute_force_does_at_each_rays_time() {
    let triangles = Arc::new(Triangles::new(Arc::new(scene())).expect("few"));
    let (rays, times) = rays(&triangles, 500);
    let expected = oracle(&triangles, &rays, &times);
    let moving = expected.iter().filter(|hit| hit.is_hit() && hit.triangle.instance.0 > 3).count();
    assert!(moving > 100, "{moving} rays hit what moves");
    for variant in VARIANTS {
        for instances in ["flat", "two-level"] {
            let spec = format!("{}:instances={instances}", variant.id);
            compare(&spec, &triangles, (&rays, &times));
        }
    }
}

#[test]
fn a_crowd_is_seen_as_brute_force_sees_it() {
    let triangles = Arc::new(Triangles::new(Arc::new(crowd())).expect("few"));
    let (rays, times) = rays(&triangles, 1000);
    for spec in ["auto", "mbvh8", "mbvh4", "bvh2"] {
        for instances in ["flat", "two-level"] {
            compare(&format!("{spec}:instances={instances}"), &triangles, (&rays, &times));
        }
    }
}

#[test]
fn small_things_are_seen_as_brute_force_sees_them() {
    for count in 1..=4 {
        let triangles = Arc::new(Triangles::new(Arc::new(small(count))).expect("few"));
        let (rays, times) = rays(&triangles, 1200);
        for row in ["auto", "mbvh8", "mbvh8:triangles=indexed", "mbvh8:triangles=cache", "bvh2"] {
            for instances in ["flat", "two-level"] {
                let options = if row.contains(':') { "," } else { ":" };
                compare(
                    &format!("{row}{options}instances={instances}"),
                    &triangles,
                    (&rays, &times),
                );
            }
        }
    }
}

/// Lets two thirds of all hits count, by ray and triangle.
struct SomeHits;

impl HitFilter for SomeHits {
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool {
        !(ray + hit.triangle.index as usize).is_multiple_of(3)
    }
}

#[test]
fn filters_are_asked_about_the_batchs_own_rays() {
    let triangles = Arc::new(Triangles::new(Arc::new(crowd())).expect("few"));
    let (mut rays, times) = rays(&triangles, 600);
    // A third passes by all that moves.
    for ray in rays.iter_mut().step_by(3) {
        *ray = Ray::new(Vec3::splat(900.0), Vec3::X, 0.0, f32::INFINITY);
    }
    let batch = Batch::new(&rays).with_times(Some(&times)).with_filter(Some(&SomeHits));
    let found = ["brute", "auto", "mbvh8", "bvh2"].map(|spec| {
        let spec: AccelSpec = format!("{spec}:instances=two-level").parse().expect("a row");
        let accel = build(&spec, triangles.clone(), Isa::Auto).expect("builds");
        let mut hits = vec![ClosestHit::MISS; rays.len()];
        accel.tracer().closest_hits(&batch, &mut hits);
        hits
    });
    assert!(found[0].iter().filter(|hit| hit.is_hit()).count() > 200);
    for other in &found[1..] {
        assert!(found[0].iter().zip(other).all(|(a, b)| a.same_bits(b)));
    }
}

#[test]
fn rays_without_times_see_the_scene_as_the_shutter_opens() {
    let triangles = Arc::new(Triangles::new(Arc::new(scene())).expect("few"));
    let (rays, _) = rays(&triangles, 100);
    let accel = build(&AccelSpec::default(), triangles.clone(), Isa::Auto).expect("builds");
    let mut hits = vec![ClosestHit::MISS; rays.len()];
    accel.tracer().closest_hits(&Batch::new(&rays), &mut hits);
    let expected = oracle(&triangles, &rays, &vec![0.0; rays.len()]);
    assert!(expected.iter().any(ClosestHit::is_hit));
    assert!(hits.iter().zip(&expected).all(|(hit, expected)| hit.same_bits(expected)));
}

#[test]
fn a_change_of_any_key_changes_the_digest() {
    let digest = scene().digest();
    assert_eq!(digest, scene().digest());
    let mut other = scene();
    let motion = Motion::new([turning(DVec3::X, 0.5, [DVec3::ONE; 2], DVec3::Z)]).expect("moves");
    other.motion_mut().move_placement(4, Arc::new(motion));
    assert_ne!(digest, other.digest());
    let mut other = scene();
    other.motion = None;
    assert_ne!(digest, other.digest());
}
