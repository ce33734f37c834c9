//! Nothing that a ray enters is missed, and what lies aside is.

use proptest::prelude::*;

use super::Shaft;
use crate::geom::{Heading, RayBundle, SlabRay};
use crate::math::{Aabb, Ray, Vec3};
use crate::simd::baseline;

fn unit() -> impl Strategy<Value = Vec3> {
    let part = || prop_oneof![8 => -1.0_f32..1.0, 1 => Just(0.0_f32), 1 => -1e-6_f32..1e-6];
    [part(), part(), part()].prop_map(Vec3::from)
}

/// Bundles of up to 40 rays with spreads of origins and directions, at all scales.
fn bundle() -> impl Strategy<Value = Vec<Ray>> {
    let spreads = [Just(0.0_f32), Just(1e-6), Just(1e-2), Just(0.3)];
    let [a, b, c, d] = spreads;
    let spread = prop_oneof![a, b, c, d].boxed();
    let many = prop::collection::vec((unit(), unit(), 0.1_f32..30.0), 1..40);
    let length = prop_oneof![Just(f32::INFINITY), Just(1.0_f32)];
    let start = (unit(), unit(), -60_i32..60, -18_i32..18);
    (start, spread.clone(), spread, many, length).prop_map(
        |((o, d, scale, long), wide, open, many, length)| {
            let power = |exponent: i32| f32::from_bits(((exponent + 127) as u32) << 23);
            let ray = |&(shift, turn, t): &(Vec3, Vec3, f32)| {
                let origin = (o + shift * wide) * power(scale);
                Ray::new(origin, (d + turn * open) * power(long), 0.0, t * length)
            };
            many.iter().map(ray).collect()
        },
    )
}

/// Whether the slab test takes the box at a distance that the ray has.
fn enters(ray: &Ray, bounds: &Aabb) -> bool {
    let (enter, exit) = SlabRay::new(ray).interval(bounds);
    enter.max(ray.t_min()) <= exit.min(ray.t_max())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 20_000, max_global_rejects: 200_000, ..ProptestConfig::default()
    })]
    #[test]
    fn what_a_ray_enters_is_never_missed(
        rays in bundle(), width in 1_usize..9, which in 0_usize..40, t in 0.0_f32..40.0,
        corner in unit(), size in unit(), grow in -24_i32..3,
    ) {
        let shaft = Shaft::of_rays(baseline(), &rays, width);
        prop_assume!(shaft.is_some());
        let shaft = shaft.unwrap();
        // A box with a corner, an edge or its inside near a point of a ray: just touched, or
        // just passed by.
        let ray = &rays[which % rays.len()];
        let at = ray.at(t / ray.direction().length());
        let scale = f32::from_bits(((grow + 127) as u32) << 23) * at.abs().max_element();
        let bounds = Aabb::of_points([at + corner * scale * 1e-3, at + size * scale]);
        let missed = shaft.misses(baseline(), &bounds);
        for ray in &rays {
            prop_assert!(!(missed && enters(ray, &bounds)), "{ray:?} enters {bounds:?}");
        }
        prop_assert!(!(missed && shaft.encloses(baseline(), &bounds)));
    }

    #[test]
    fn a_bundle_is_held_by_its_own_shaft(rays in bundle(), width in 1_usize..9) {
        if let Some(shaft) = Shaft::of_rays(baseline(), &rays, width) {
            let endless = rays.iter().filter(|ray| ray.t_max() == f32::INFINITY);
            for ray in endless {
                prop_assert!(shaft.holds(ray), "{ray:?}");
            }
            if let Some(heading) = shaft.heading() {
                for ray in rays.iter().filter(|ray| ray.t_max() > ray.t_min()) {
                    prop_assert_eq!(Heading::of(ray.direction()).number(), heading.number());
                }
            }
        }
    }

    #[test]
    fn given_regions_lose_nothing_that_they_hold(
        corners in [unit(), unit(), unit(), unit()], box_ in [unit(), unit()],
        o in unit(), d in unit(), end in 0.1_f32..3.0, size in -20_i32..2,
    ) {
        let origins = Aabb::of_points([Vec3::ZERO, o * 0.1]);
        let up = corners.map(|c| c * 0.5 + Vec3::Z);
        let shafts = [Shaft::pyramid(origins, up), Shaft::within(Aabb::of_points(corners))];
        let half = f32::from_bits(((size + 127) as u32) << 23);
        let bounds = Aabb::of_points(box_.map(|p| p * half + up[0]));
        for (shaft, d) in shafts.iter().flatten().zip([d * 0.3 + Vec3::Z, d]) {
            for ray in [Ray::new(o * 0.1, d, 0.0, end), Ray::new(o * 0.05, d, 0.0, f32::INFINITY)] {
                let lost = shaft.holds(&ray)
                    && shaft.misses(baseline(), &bounds)
                    && enters(&ray, &bounds);
                prop_assert!(!lost);
                let mut bundle = RayBundle::EMPTY;
                bundle.put(0, &ray);
                prop_assert!(!shaft.holds_bundle(baseline(), &bundle) || shaft.holds(&ray));
            }
        }
    }
}

/// Rays of a camera at the origin through a raster of 16 by 16 on the plane z = 1.
fn tile(turn: f32) -> Vec<Ray> {
    let (sin, cos) = (libm::sinf(turn), libm::cosf(turn));
    (0..256)
        .map(|i| {
            let (x, y) = ((i % 16) as f32 / 15.0 - 0.5, (i / 16) as f32 / 15.0 - 0.5);
            let d = Vec3::new(cos * x - sin * y, sin * x + cos * y, 1.0);
            Ray::new(Vec3::ZERO, d, 0.0, f32::INFINITY)
        })
        .collect()
}

#[test]
fn the_heading_of_a_tile_within_an_octant_is_told() {
    let towards = |middle: Vec3| -> Option<usize> {
        let aside = |ray: Ray| Ray::new(Vec3::ONE, ray.direction() * 0.2 + middle, 0.0, 1.0);
        let rays: Vec<_> = tile(0.3).into_iter().map(aside).collect();
        Shaft::of_rays(baseline(), &rays, 16)?.heading().map(Heading::number)
    };
    for middle in [Vec3::new(1.0, -2.0, 4.0), Vec3::new(-3.0, 1.0, 1.0), Vec3::new(1.0, -4.0, -1.0)]
    {
        assert_eq!(towards(middle), Some(Heading::of(middle).number()), "{middle}");
    }
    // Across an axis, and where two components are the largest.
    for middle in [Vec3::new(0.0, 0.5, 1.0), Vec3::new(1.0, 1.0, 0.3)] {
        assert_eq!(towards(middle), None, "{middle}");
    }
}

fn cube(centre: [f32; 3], half: f32) -> Aabb {
    let centre = Vec3::from(centre);
    Aabb { min: centre - half, max: centre + half }
}

#[test]
fn a_tile_is_as_narrow_as_its_rays_however_it_is_turned() {
    let shaft = Shaft::of_rays(baseline(), &tile(0.0), 16).expect("they go the same way");
    let misses = |bounds| shaft.misses(baseline(), &bounds);
    assert!(!misses(cube([4.9, 0.0, 10.0], 0.01)), "inside");
    assert!(misses(cube([5.1, 0.0, 10.0], 0.01)), "to the right");
    assert!(misses(cube([0.0, -5.1, 10.0], 0.01)), "below");
    assert!(misses(cube([0.0, 0.0, -0.1], 0.05)), "behind");
    assert!(shaft.encloses(baseline(), &cube([0.0, 0.0, 10.0], 2.0)));
    assert!(!shaft.encloses(baseline(), &cube([0.0, 0.0, 10.0], 6.0)));
    // Turned by 45 degrees its sides pass through (7.07, 0, 10), not through (5, 5, 10).
    let shaft =
        Shaft::of_rays(baseline(), &tile(std::f32::consts::FRAC_PI_4), 16).expect("likewise");
    assert!(!shaft.misses(baseline(), &cube([7.0, 0.0, 10.0], 0.01)));
    assert!(shaft.misses(baseline(), &cube([3.7, 3.7, 10.0], 0.01)));
}

#[test]
fn a_region_ends_where_its_segments_do() {
    let segments: Vec<Ray> =
        tile(0.0).iter().map(|ray| Ray::new(ray.origin(), ray.direction(), 0.0, 2.0)).collect();
    let shaft = Shaft::of_rays(baseline(), &segments, 16).expect("they go the same way");
    assert!(!shaft.misses(baseline(), &cube([0.0, 0.0, 1.9], 0.01)));
    assert!(shaft.misses(baseline(), &cube([0.0, 0.0, 2.1], 0.01)));
}

#[test]
fn the_pyramid_of_a_tile_is_seen_to_hold_its_rays() {
    let rays = tile(0.3);
    let corners = [0, 15, 255, 240].map(|i: usize| rays[i].direction());
    let pyramid = Shaft::pyramid(Aabb::of_points([Vec3::ZERO]), corners).expect("a pyramid");
    let mut bundle = RayBundle::EMPTY;
    for rays in rays.chunks(RayBundle::LANES) {
        (0..).zip(rays).for_each(|(lane, ray)| bundle.put(lane, ray));
        assert!(pyramid.holds_bundle(baseline(), &bundle));
    }
    bundle.put(3, &Ray::new(Vec3::ZERO, Vec3::X, 0.0, 1.0));
    assert!(!pyramid.holds_bundle(baseline(), &bundle));
}

#[test]
fn a_tile_holds_a_part_of_it() {
    let rays = tile(0.3);
    let whole = Shaft::of_rays(baseline(), &rays, 16).expect("they go the same way");
    let part = Shaft::of_rays(baseline(), &rays[100..110], 10).expect("likewise");
    assert!(whole.contains(&part) && !part.contains(&whole));
    let shifted: Vec<Ray> =
        rays.iter().map(|ray| Ray::new(Vec3::X, ray.direction(), 0.0, 9.0)).collect();
    let shifted = Shaft::of_rays(baseline(), &shifted, 16).expect("likewise");
    assert!(!whole.contains(&shifted));
    assert!(part.spread() < whole.spread() && whole.spread() < 1.1);
}

#[test]
fn rays_that_go_different_ways_have_no_shaft() {
    let ray = |d: Vec3| Ray::new(Vec3::ZERO, d, 0.0, 1.0);
    assert!(Shaft::of_rays(baseline(), &[ray(Vec3::X), ray(-Vec3::X)], 2).is_none());
    assert!(
        Shaft::of_rays(baseline(), &[ray(Vec3::X), ray(Vec3::Y), ray(Vec3::NEG_Y)], 3).is_none()
    );
    assert!(Shaft::of_rays(baseline(), &[Ray::MISS], 1).is_none());
    assert!(Shaft::of_rays(baseline(), &[], 1).is_none());
    assert!(Shaft::pyramid(cube([0.0; 3], 0.0), [Vec3::X; 4]).is_none());
}
