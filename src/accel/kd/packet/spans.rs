//! Where the rays of a packet are in a tree: of each the part that crosses the cell at hand.
//!
//! All rays of a packet that head the same way come to the children of a node in the same order. So
//! of a ray it is enough to know how far it has come, once, and for each level where it leaves the
//! cell: where it enters the next is where it left the last (Zlatuška and Havran 2010, for single
//! rays). It crosses a cell if it enters before it leaves. That is the tie rule of single rays
//! ([`super::super::ray::Crossing`]), but that rays are made a little longer at the start, since
//! there a ray of no length is still to be walked: leaves that a ray crosses by itself are crossed
//! by it in a packet, and tested.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x8, mask32x8};

use crate::accel::kd::ray::KdRay;
use crate::accel::kd::walk::todo::LEVELS;
use crate::accel::packet::{BUNDLES, PacketRays};
use crate::geom::RayBundle;
use crate::math::Aabb;

/// Rays of a bundle.
const LANES: usize = RayBundle::LANES;

/// Numbers, one for each ray of a bundle.
pub type PerRay = [f32; LANES];

/// A set of bundles, a bit each.
pub type Bundles = u64;

const _: () = assert!(BUNDLES <= Bundles::BITS as usize);

/// The numbers of a set's bundles.
#[inline(always)]
pub fn iter_bundles(mut set: Bundles) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bundle = set.trailing_zeros() as usize;
        (set != 0).then(|| {
            set &= set - 1;
            bundle
        })
    })
}

/// Rays of a bundle, prepared for planes: [`KdRay`], lane by lane.
#[derive(Clone, Copy)]
struct Planes {
    origin: [PerRay; 3],
    inverse: [PerRay; 3],
}

pub struct Spans {
    planes: Box<[Planes]>,
    /// Where each ray is; infinite if it has ended.
    pub enter: Box<[PerRay; BUNDLES]>,
    /// Of each level where it leaves.
    pub exit: Box<[[PerRay; BUNDLES]]>,
    /// Distances of the plane at hand.
    t: Box<[PerRay; BUNDLES]>,
    /// Of each bundle the rays that cross the leaf at hand.
    pub entered: [u8; BUNDLES],
}

impl Default for Spans {
    fn default() -> Self {
        let none = Planes { origin: [[0.0; LANES]; 3], inverse: [[0.0; LANES]; 3] };
        Self {
            planes: vec![none; BUNDLES].into_boxed_slice(),
            enter: Box::new([[0.0; LANES]; BUNDLES]),
            exit: vec![[[0.0; LANES]; BUNDLES]; LEVELS + 1].into_boxed_slice(),
            t: Box::new([[0.0; LANES]; BUNDLES]),
            entered: [0; BUNDLES],
        }
    }
}

/// Loads numbers as a vector.
#[inline(always)]
pub fn load<S: Simd>(simd: S, values: &PerRay) -> f32x8<S> {
    f32x8::load_array_ref(simd, values)
}

/// Whether any lane is set.
#[inline(always)]
pub fn any_lane<S: Simd>(mask: mask32x8<S>) -> bool {
    mask.to_bitmask() != 0
}

impl Spans {
    /// Takes rays, each with the part of it inside the root's box; returns the bundles that have
    /// any.
    #[inline(always)]
    pub fn begin<S: Simd>(&mut self, simd: S, rays: &PacketRays, bounds: &Aabb) -> Bundles {
        let mut live = 0;
        for number in 0..rays.count() {
            let bundle = rays.bundle(number);
            let [o, d] = bundle.rays(simd);
            let planes = &mut self.planes[number];
            for axis in 0..3 {
                let size = d[axis].abs().max(KdRay::SMALLEST).copysign(d[axis]);
                planes.origin[axis] = o[axis].to_array();
                planes.inverse[axis] = (f32x8::splat(simd, 1.0) / size).to_array();
            }
            let (enter, exit) = bundle.interval(simd, bounds, rays.heading(number).negative);
            let [t_min, t_max] = bundle.spans(simd);
            let (enter, exit) = (enter.max(t_min), exit.min(t_max));
            let crosses = enter.simd_le(exit);
            let longer = exit * (1.0 + 2.0 * f32::EPSILON) + f32::MIN_POSITIVE;
            let none = f32x8::splat(simd, f32::INFINITY);
            self.enter[number] = crosses.select(enter, none).to_array();
            self.exit[0][number] = crosses.select(longer, -none).to_array();
            live |= u64::from(any_lane(crosses)) << number;
        }
        live
    }

    /// Where the rays of a bundle meet a plane.
    #[inline(always)]
    pub fn t_split<S: Simd>(&self, simd: S, bundle: usize, axis: usize, split: f32) -> f32x8<S> {
        let Planes { origin, inverse } = &self.planes[bundle];
        (f32x8::splat(simd, split) - load(simd, &origin[axis])) * load(simd, &inverse[axis])
    }

    /// The coordinates of a bundle's origins.
    #[inline(always)]
    pub fn origin<S: Simd>(&self, simd: S, bundle: usize, axis: usize) -> f32x8<S> {
        load(simd, &self.planes[bundle].origin[axis])
    }

    /// Which bundles have rays that cross the nearer child of a node, and which the farther.
    #[inline(always)]
    pub fn split<S: Simd>(
        &mut self,
        simd: S,
        (axis, split): (usize, f32),
        bundles: Bundles,
        level: usize,
    ) -> (Bundles, Bundles) {
        let (mut near, mut far) = (0, 0);
        let exits = &self.exit[level];
        for number in iter_bundles(bundles) {
            let t = self.t_split(simd, number, axis, split);
            self.t[number] = t.to_array();
            let (enter, exit) = (load(simd, &self.enter[number]), load(simd, &exits[number]));
            near |= u64::from(any_lane(enter.simd_lt(t.min(exit)))) << number;
            far |= u64::from(any_lane(enter.max(t).simd_lt(exit))) << number;
        }
        (near, far)
    }

    /// One level down, on this side of the plane that was split at last.
    #[inline(always)]
    pub fn keep_near<S: Simd>(&mut self, simd: S, bundles: Bundles, level: usize) {
        let (above, below) = self.exit.split_at_mut(level + 1);
        let (above, below) = (&above[level], &mut below[0]);
        for number in iter_bundles(bundles) {
            let exit = load(simd, &above[number]).min(load(simd, &self.t[number]));
            below[number] = exit.to_array();
        }
    }

    /// One level down, with nothing cut off.
    #[inline(always)]
    pub fn keep_all(&mut self, bundles: Bundles, level: usize) {
        let (above, below) = self.exit.split_at_mut(level + 1);
        let (above, below) = (&above[level], &mut below[0]);
        for number in iter_bundles(bundles) {
            below[number] = above[number];
        }
    }

    /// Narrows the spans of a level to a cell; which bundles have rays that cross it.
    ///
    /// Each plane of the cell, but for the rim's, is one that the way down from the root splits at,
    /// and the one that narrows most of those of its side: so the span is that with which a walk
    /// from the root would have come here. The rim's planes are further from all triangles than
    /// distances are off by.
    #[inline(always)]
    pub fn clip<S: Simd>(
        &mut self,
        simd: S,
        (cell, negative): (&Aabb, [usize; 3]),
        bundles: Bundles,
        level: usize,
    ) -> Bundles {
        let mut left = 0;
        for number in iter_bundles(bundles) {
            let before = load(simd, &self.enter[number]);
            let (mut enter, mut exit) = (before, load(simd, &self.exit[level][number]));
            for axis in 0..3 {
                let sides = [cell.min[axis], cell.max[axis]];
                let near = negative[axis] & 1;
                enter = enter.max(self.t_split(simd, number, axis, sides[near]));
                exit = exit.min(self.t_split(simd, number, axis, sides[1 - near]));
            }
            let crosses = enter.simd_lt(exit);
            self.enter[number] = crosses.select(enter, before).to_array();
            let none = f32x8::splat(simd, f32::NEG_INFINITY);
            self.exit[level][number] = crosses.select(exit, none).to_array();
            left |= u64::from(any_lane(crosses)) << number;
        }
        left
    }

    /// Those bundles that have rays that cross the cell of a level; finds of each which.
    #[inline(always)]
    pub fn find_crossing<S: Simd>(&mut self, simd: S, bundles: Bundles, level: usize) -> Bundles {
        let mut left = 0;
        for number in iter_bundles(bundles) {
            let enter = load(simd, &self.enter[number]);
            let crosses = enter.simd_lt(load(simd, &self.exit[level][number])).to_bitmask();
            self.entered[number] = crosses as u8;
            left |= u64::from(crosses != 0) << number;
        }
        left
    }

    /// Leaves the cell of a level. Rays that were hit before that end, for what is left of
    /// them is strictly behind the hit.
    #[inline(always)]
    pub fn leave<S: Simd>(&mut self, simd: S, rays: &PacketRays, bundles: Bundles, level: usize) {
        for number in iter_bundles(bundles) {
            let enter = load(simd, &self.enter[number]);
            let come = enter.max(load(simd, &self.exit[level][number]));
            self.enter[number] = end_rays(simd, rays, number, come).to_array();
        }
    }
}

/// How far rays of a bundle have come, infinite for those that end before.
#[inline(always)]
pub fn end_rays<S: Simd>(simd: S, rays: &PacketRays, number: usize, come: f32x8<S>) -> f32x8<S> {
    let [_, t_max] = rays.bundle(number).spans(simd);
    t_max.simd_lt(come).select(f32x8::splat(simd, f32::INFINITY), come)
}
