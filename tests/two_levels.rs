//! Structures in two levels answer as brute force does, to the bit: copies mirrored, sheared,
//! tiny, huge, far from the origin, touching, coincident.

use std::sync::Arc;

use dapple::geom::{Mesh, TriangleSource};
use dapple::math::{Affine3A, MaterialId, MeshId, Quat, Ray, Vec3};
use dapple::scene::{Instance, Material, Transform, Triangles};
use dapple::{AccelSpec, AnyHit, Batch, ClosestHit, Isa, Scene, VARIANTS, build};

/// A number in [0, 1) for each `(seed, place)`.
fn unit(seed: u32, place: u32) -> f32 {
    let mut x = seed.wrapping_mul(0x9e37_79b9) ^ place.wrapping_mul(0x85eb_ca6b);
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    ((x ^ (x >> 16)) >> 8) as f32 / 16_777_216.0
}

fn direction(seed: u32) -> Vec3 {
    Vec3::new(unit(seed, 1) - 0.5, unit(seed, 2) - 0.5, unit(seed, 3) - 0.5).normalize_or(Vec3::X)
}

/// A closed mesh: a sphere of so many rings, a little dented.
fn ball(rings: u32) -> Mesh {
    let sides = 2 * rings;
    let mut mesh = Mesh::default();
    for ring in 0..=rings {
        let polar = std::f32::consts::PI * ring as f32 / rings as f32;
        for side in 0..sides {
            let turn = std::f32::consts::TAU * side as f32 / sides as f32;
            let radius = if ring % rings == 0 { 1.0 } else { 1.0 + 0.1 * unit(ring, side) };
            let (sine, cosine) = libm::sincosf(polar);
            mesh.positions
                .push(Vec3::new(sine * libm::cosf(turn), cosine, sine * libm::sinf(turn)) * radius);
        }
    }
    for ring in 0..rings {
        for side in 0..sides {
            let at = |ring: u32, side: u32| ring * sides + side % sides;
            let (a, b) = (at(ring, side), at(ring, side + 1));
            let (c, d) = (at(ring + 1, side), at(ring + 1, side + 1));
            mesh.indices.extend([[a, b, c], [b, d, c]]);
        }
    }
    mesh
}

/// Placements of one ball.
fn placed(transforms: Vec<Affine3A>) -> Arc<dyn TriangleSource> {
    placed_beside(transforms, Vec::new())
}

/// Placements of one ball beside others, each of its own.
fn placed_beside(transforms: Vec<Affine3A>, others: Vec<Affine3A>) -> Arc<dyn TriangleSource> {
    let place = |mesh: u32, to_world: Affine3A| Instance {
        mesh: MeshId(mesh),
        material: MaterialId(0),
        transform: Transform::new(to_world),
    };
    let own = (1..).zip(others).map(|(mesh, to_world)| place(mesh, to_world));
    let mut instances: Vec<Instance> = own.collect();
    let meshes = (0..=instances.len()).map(|mesh| Arc::new(ball(6 + mesh as u32 % 3)));
    let meshes = meshes.collect();
    instances.extend(transforms.into_iter().map(|to_world| place(0, to_world)));
    let materials = vec![Material::default()];
    let scene = Scene { meshes, materials, instances, ..Scene::default() };
    Arc::new(Triangles::new(Arc::new(scene)).expect("few"))
}

/// Turned, scaled, sheared, mirrored if odd, and moved.
fn transform(seed: u32, scale: f32, shear: f32, at: Vec3) -> Affine3A {
    let turn = Affine3A::from_quat(Quat::from_axis_angle(direction(seed), 6.0 * unit(seed, 4)));
    let mirror = if seed % 2 == 1 { -1.0 } else { 1.0 };
    let mut sheared = Affine3A::from_scale(Vec3::new(mirror, 1.0, 1.0));
    sheared.matrix3.y_axis.x = shear * (unit(seed, 5) - 0.5);
    Affine3A::from_translation(at) * turn * Affine3A::from_scale(Vec3::splat(scale)) * sheared
}

fn scattered(count: u32, scale: f32, shear: f32, offset: Vec3) -> Vec<Affine3A> {
    let at = |i: u32| direction(i + 77) * (4.0 * scale * unit(i, 9).sqrt());
    (0..count).map(|i| transform(i, scale, shear, offset + at(i))).collect()
}

/// Every kind of copies, by its name.
fn scenes() -> Vec<(&'static str, Arc<dyn TriangleSource>)> {
    let grid = |i: u32| Vec3::new((i % 3) as f32, (i / 3 % 3) as f32, (i / 9) as f32) * 2.0;
    let touching = (0..27).map(|i| Affine3A::from_translation(grid(i))).collect();
    let mixed = (0..40).map(|i| {
        let scale = libm::powf(10.0, 6.0 * unit(i, 11) - 3.0);
        transform(i, scale, 0.5, direction(i) * 30.0 * unit(i, 12))
    });
    let mut coincident = scattered(8, 1.0, 0.5, Vec3::ZERO);
    coincident.extend(coincident.clone());
    vec![
        ("sheared and mirrored", placed(scattered(30, 1.0, 3.0, Vec3::ZERO))),
        ("tiny", placed(scattered(30, 1e-6, 0.5, Vec3::ZERO))),
        ("huge", placed(scattered(30, 1e6, 0.5, Vec3::ZERO))),
        ("far", placed(scattered(30, 1.0, 0.5, Vec3::new(1e4, -3e4, 2e4)))),
        ("so far that vertices are rounded", placed(scattered(9, 1.0, 0.5, Vec3::splat(3e6)))),
        (
            "flattened",
            placed((0..9).map(|i| Affine3A::from_scale(Vec3::new(1.0, 0.0, i as f32))).collect()),
        ),
        ("of all sizes", placed(mixed.collect())),
        ("touching", placed(touching)),
        ("coincident", placed(coincident)),
        (
            "among meshes placed once",
            placed_beside(
                scattered(20, 1.0, 0.5, Vec3::ZERO),
                (20..30).map(|i| transform(i, 1.5, 0.5, direction(i) * 3.0)).collect(),
            ),
        ),
    ]
}

/// Rays at vertices, edges and insides of triangles, from near and far, and along axes.
fn rays(source: &dyn TriangleSource, count: u32) -> Vec<Ray> {
    let triangle = |i: u32| {
        let at = (unit(i, 20) * source.len() as f32) as u32;
        source.triangle(dapple::math::PrimId(at.min(source.len() as u32 - 1)))
    };
    let middle = triangle(0).a;
    let size = (0..64).map(|i| triangle(i).a.distance(middle)).fold(1e-30, f32::max);
    (0..count)
        .map(|i| {
            let corners = triangle(i).corners();
            let weights = match i % 4 {
                0 => Vec3::X,
                1 => Vec3::new(0.5, 0.5, 0.0),
                _ => Vec3::new(0.2, 0.3, 0.5),
            };
            let target = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
            let far = if i % 5 == 0 { 1e3 } else { 2.0 };
            let from = if i % 7 == 0 {
                target + Vec3::AXES[i as usize % 3] * size * far
            } else {
                middle + direction(i + 5) * size * far
            };
            let t_max = if i % 3 == 0 { 0.75 + 0.5 * unit(i, 21) } else { f32::INFINITY };
            Ray::new(from, target - from, 0.0, t_max)
        })
        .collect()
}

fn answers(
    spec: &str,
    source: &Arc<dyn TriangleSource>,
    rays: &[Ray],
) -> (Vec<ClosestHit>, Vec<AnyHit>) {
    let spec: AccelSpec = spec.parse().expect("a row of the table");
    let accel = build(&spec, Arc::clone(source), Isa::Auto).expect("builds");
    let mut closest = vec![ClosestHit::MISS; rays.len()];
    let mut any = vec![AnyHit(false); rays.len()];
    let mut tracer = accel.tracer();
    tracer.closest_hits(&Batch::new(rays), &mut closest);
    tracer.any_hits(&Batch::new(rays), &mut any);
    (closest, any)
}

#[track_caller]
fn compare(
    name: &str,
    spec: &str,
    source: &Arc<dyn TriangleSource>,
    rays: &[Ray],
    expected: &[ClosestHit],
) {
    let (closest, any) = answers(spec, source, rays);
    for (i, expected) in expected.iter().enumerate() {
        let (hit, any) = (closest[i], any[i].0);
        assert!(hit.same_bits(expected), "{name}, {spec}, ray {i}: {hit:?}, not {expected:?}");
        assert_eq!(any, expected.is_hit(), "{name}, {spec}, ray {i}");
    }
}

#[test]
fn every_row_in_two_levels_answers_as_brute_force_does() {
    for (name, source) in scenes() {
        let rays = rays(&*source, 400);
        let (expected, _) = answers("brute:instances=flat", &source, &rays);
        let hits = expected.iter().filter(|hit| hit.is_hit()).count();
        assert!(hits > 30 || name == "flattened", "{name}: {hits} hits");
        for variant in VARIANTS {
            compare(
                name,
                &format!("{}:instances=two-level", variant.id),
                &source,
                &rays,
                &expected,
            );
        }
    }
}

#[test]
fn any_row_may_be_on_top_of_any() {
    let (name, source) = scenes().swap_remove(6);
    let rays = rays(&*source, 100);
    let (expected, _) = answers("brute:instances=flat", &source, &rays);
    for below in ["brute", "mbvh4", "bvh-packet", "kd-ropes", "kd-packet"] {
        for above in VARIANTS {
            let spec = format!("{below}:instances=two-level,top={}", above.id);
            compare(name, &spec, &source, &rays, &expected);
        }
    }
}

#[test]
fn copies_that_are_too_many_to_be_opened_or_kept_change_no_hit() {
    for count in [20_000, 270_000] {
        let at = |i: u32| direction(i + 77) * (40.0 * unit(i, 9).sqrt());
        let source = placed((0..count).map(|i| transform(i, 0.3, 0.5, at(i))).collect());
        let rays = rays(&*source, 400);
        let (expected, _) = answers("bvh2:instances=two-level", &source, &rays);
        assert!(expected.iter().filter(|hit| hit.is_hit()).count() > 200, "{count}");
        for row in ["mbvh8", "auto"] {
            let (name, spec) = (format!("{count} copies"), format!("{row}:instances=two-level"));
            compare(&name, &spec, &source, &rays, &expected);
            let accel = build(&spec.parse().expect("a row"), Arc::clone(&source), Isa::Auto);
            let bytes = accel.expect("builds").memory().total();
            // A flat tree takes fifty times as much.
            assert!(bytes < 300 * count as usize, "{name}: {bytes}");
        }
    }
}

#[test]
fn hits_name_placement_and_triangle_whatever_the_structure() {
    let (_, source) = scenes().swap_remove(7);
    let rays = rays(&*source, 100);
    let (hits, _) = answers("auto:instances=two-level", &source, &rays);
    let placements: std::collections::BTreeSet<u32> =
        hits.iter().filter(|hit| hit.is_hit()).map(|hit| hit.triangle.instance.0).collect();
    assert!(placements.len() > 10, "{placements:?}");
    for hit in hits.iter().filter(|hit| hit.is_hit()) {
        let number = source.number(hit.triangle);
        assert_eq!(source.locate(dapple::math::PrimId(number as u32)), hit.triangle);
    }
}
