//! Both ways of compressing make one tree, and it holds what it must.

use std::sync::Arc;

use super::PATH_COMPRESSION;
use super::packet_bvh::{PacketBvh, With};
use super::place::{Place, Places};
use crate::accel::narrowing::{Branches, Compression, Hierarchy, Start, Step, find_entry_point};
use crate::accel::{BuildInput, Counts, Event, Options, Steps};
use crate::geom::{Shaft, Triangle, TriangleList};
use crate::math::{Aabb, Vec3};
use crate::simd::{Isa, baseline};

/// Small triangles at the points of a lattice, somewhat shaken.
fn lattice(side: u32) -> Vec<Triangle> {
    let shaken = |i: u32| (i.wrapping_mul(0x9e37_79b9) >> 8) as f32 / 16777216.0 * 0.4;
    (0..side.pow(3))
        .map(|i| {
            let cell =
                Vec3::new((i % side) as f32, (i / side % side) as f32, (i / side / side) as f32);
            let a = cell + Vec3::new(shaken(i), shaken(i + 7), shaken(i + 13));
            Triangle { a, b: a + Vec3::X * 0.3, c: a + Vec3::new(0.0, 0.3, 0.1) }
        })
        .collect()
}

fn structure(side: u32) -> PacketBvh {
    let options = Options::defaults(PATH_COMPRESSION.options);
    let source = Arc::new(TriangleList(lattice(side)));
    let level = Isa::Portable.level().expect("always there");
    let start = Start::Compressed { recursive: false, per_packet: false };
    let (options, steps) = (&options, &Steps::untold());
    PacketBvh::build(&BuildInput { source, options, level, steps }, start, With::Packet)
        .expect("a small scene")
}

/// A tile's shaft from outside, a part of it, and one from within.
fn shafts() -> [Shaft; 3] {
    let eye = Vec3::new(4.1, 4.2, -9.0);
    let tile = |eye: Vec3, half: f32| {
        let corner = |x: f32, y: f32| Vec3::new(x * half, y * half + 0.1, 1.0);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        Shaft::pyramid(Aabb::of_points([eye]), corners).expect("a pyramid")
    };
    [tile(eye, 0.2), tile(eye, 0.03), tile(Vec3::splat(4.3), 0.1)]
}

/// Leaves and enclosed nodes that the walk of a tree comes to, and those that the shaft meets in
/// the hierarchy itself.
fn ends(
    places: Places<'_>,
    branches: Branches<'_, Place>,
    from: Step<Place>,
    shaft: &Shaft,
) -> [Vec<Place>; 2] {
    let (mut of_tree, mut all) = (Vec::new(), Vec::new());
    let mut waiting = vec![from];
    while let Some(step) = waiting.pop() {
        match branches.children(places, step) {
            Some(below) if step != Step::to(step.place) => waiting.extend(below),
            _ => of_tree.push(step.place),
        }
    }
    let mut waiting = vec![Place::ROOT];
    while let Some(place) = waiting.pop() {
        let bounds = places.bounds(place);
        if shaft.misses(baseline(), &bounds) {
            continue;
        }
        let link = places.link(place);
        if link.is_leaf() || shaft.encloses(baseline(), &bounds) {
            all.push(place);
        } else {
            waiting.extend(Place::children(link.place()));
        }
    }
    let key = |place: &Place| places.bounds(*place).min.to_array().map(f32::to_bits);
    of_tree.sort_by_key(key);
    all.sort_by_key(key);
    [of_tree, all]
}

#[test]
fn recursion_and_iteration_leave_the_same_branches() {
    let structure = structure(9);
    let places = structure.narrowing().expect("it has a root").tree;
    for shaft in &shafts() {
        let compress = |recursive: bool| {
            let (mut own, mut counts) = (Vec::new(), Counts::default());
            let mut compression = Compression { tree: places, branches: &mut own, shaft };
            let step = if recursive {
                compression.compress_recursively(Step::to(Place::ROOT), &mut counts)
            } else {
                compression.compress_iteratively(Step::to(Place::ROOT), &mut counts)
            };
            (own, step, counts)
        };
        let (own, step, counts) = compress(true);
        assert!(own.len() > 2);
        assert_eq!(compress(false), (own.clone(), step, counts));
        let branches = Branches(&own);
        let [of_tree, all] = ends(places, branches, step.expect("there is something"), shaft);
        assert_eq!(of_tree, all);
        assert_eq!(of_tree.len(), own.len() + 1, "every branch has two sides");
    }
}

#[test]
fn a_tree_narrowed_twice_is_that_of_the_narrow_shaft() {
    let structure = structure(9);
    let places = structure.narrowing().expect("it has a root").tree;
    let [wide, narrow, _] = &shafts();
    let (mut twice, mut counts) = (Vec::new(), Counts::default());
    let mut compression = Compression { tree: places, branches: &mut twice, shaft: wide };
    let first = compression
        .compress_iteratively(Step::to(Place::ROOT), &mut counts)
        .expect("there is something");
    let searched = counts[Event::Search];
    let mut compression = Compression { tree: places, branches: &mut twice, shaft: narrow };
    let second = compression.compress_iteratively(first, &mut counts).expect("there is something");
    let again = counts[Event::Search] - searched;
    let branches = Branches(&twice);
    let [of_tree, all] = ends(places, branches, second, narrow);
    assert_eq!(of_tree, all);
    let (mut alone, mut counts) = (Vec::new(), Counts::default());
    let mut compression = Compression { tree: places, branches: &mut alone, shaft: narrow };
    assert!(compression.compress_iteratively(Step::to(Place::ROOT), &mut counts).is_some());
    assert!(again <= counts[Event::Search], "a compressed tree has no more nodes to look at");
}

#[test]
fn an_entry_point_is_the_lowest_node_with_all_that_is_met() {
    let structure = structure(9);
    let places = structure.narrowing().expect("it has a root").tree;
    for shaft in &shafts() {
        let (mut own, mut counts) = (Vec::new(), Counts::default());
        let entry =
            find_entry_point(places, Place::ROOT, shaft, &mut counts).map(|(place, _)| place);
        let mut compression = Compression { tree: places, branches: &mut own, shaft };
        let root = compression.compress_recursively(Step::to(Place::ROOT), &mut counts);
        assert_eq!(entry, root.map(|step| step.place), "the root of the compressed tree");
    }
    let aside = Vec3::splat(-50.0);
    let nothing = Shaft::within(Aabb { min: aside - 1.0, max: aside }).expect("a box");
    let mut counts = Counts::default();
    assert_eq!(find_entry_point(places, Place::ROOT, &nothing, &mut counts), None);
}
