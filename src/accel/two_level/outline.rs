//! What rays must meet to be asked about among placements, where anything moves.

use fearless_simd::Simd;
use rayon::prelude::*;

use super::slab::Slab;
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::arena::NodeStripes;
use crate::accel::bvh::wide::node;
use crate::geom::SlabRay;
use crate::math::{Aabb, Ray, larger, smaller};

/// Boxes side by side.
const W: usize = 8;

/// For each part of the time, a few boxes that hold all placements.
pub struct Outline {
    parts: Vec<[[f32; W]; 6]>,
    /// What holds them over all of the time, with room for rounding.
    whole: Aabb,
    /// Likewise, if that is known; without room.
    slab: Option<Slab>,
}

/// Rays side by side.
pub const LANES: usize = 16;
/// 2^-18: more than the slab test of the boxes within, and this one, are rounded by.
const ROUNDING: f32 = 1.0 / 262_144.0;

impl Outline {
    /// Of `parts` of the time, by the boxes of placements over each.
    pub fn new(parts: usize, boxes: impl Fn(usize) -> Vec<Aabb> + Sync) -> Self {
        let planes = |part| {
            let (mut node, mut lane, mut all) = (NodeStripes::<W>::EMPTY, 0, Aabb::EMPTY);
            group(&mut boxes(part), W, &mut |held| {
                node.set(lane, &held, Link(0));
                lane += 1;
                all = all.union(held);
            });
            let [a, b, c, d, e, f, ..] = node.0;
            ([a, b, c, d, e, f], all)
        };
        let found = (0..parts).into_par_iter().map(planes);
        let (parts, all): (Vec<_>, Vec<_>) = found.unzip();
        let Aabb { min, max } = all.into_iter().fold(Aabb::EMPTY, Aabb::union);
        let room = (min.abs().max(max.abs())) * ROUNDING;
        Self { parts, whole: Aabb { min: min - room, max: max + room }, slab: None }
    }

    /// The same of what lies in a slab at all times.
    #[must_use]
    pub fn within(self, slab: Option<Slab>) -> Self {
        Self { slab, ..self }
    }

    /// Which of up to [`LANES`] rays may meet any at any time before their `t_max`, by bits. It
    /// takes a fifth of the time that [`Self::may_meet`] does.
    #[inline(always)]
    pub fn may_ever_meet(&self, rays: &[Ray], t_max: &[f32; LANES]) -> u32 {
        let (mut origin, mut direction) = ([[0.0_f32; LANES]; 3], [[1.0_f32; LANES]; 3]);
        for (lane, ray) in rays.iter().enumerate().take(LANES) {
            for axis in 0..3 {
                origin[axis][lane] = ray.origin()[axis];
                direction[axis][lane] = ray.direction()[axis];
            }
        }
        let (mut enter, mut exit) = ([0.0_f32; LANES], *t_max);
        for axis in 0..3 {
            let (low, high) = (self.whole.min[axis], self.whole.max[axis]);
            for lane in 0..LANES {
                let along = direction[axis][lane];
                let inverse = 1.0 / larger(along.abs(), f32::MIN_POSITIVE).copysign(along);
                let a = (low - origin[axis][lane]) * inverse;
                let b = (high - origin[axis][lane]) * inverse;
                enter[lane] = larger(enter[lane], smaller(a, b));
                exit[lane] = smaller(exit[lane], larger(a, b));
            }
        }
        let mut meets = [false; LANES];
        for lane in 0..LANES {
            meets[lane] = enter[lane] <= exit[lane] * (1.0 + ROUNDING);
        }
        if let Some(slab) = &self.slab {
            let Slab { normal: n, low, high } = *slab;
            for lane in 0..LANES {
                let [o, d] = [&origin, &direction];
                let from = n.x * o[0][lane] + n.y * o[1][lane] + n.z * o[2][lane];
                let along = n.x * d[0][lane] + n.y * d[1][lane] + n.z * d[2][lane];
                let (a, b) = (from + along * enter[lane], from + along * exit[lane]);
                let far = o[0][lane].abs() + o[1][lane].abs() + o[2][lane].abs();
                let way = d[0][lane].abs() + d[1][lane].abs() + d[2][lane].abs();
                let room = (far + way * exit[lane]) * ROUNDING;
                let (low, high) = (low - room, high + room);
                // Where there is no number, it may meet.
                let passes_by = smaller(a, b) > high || larger(a, b) < low;
                meets[lane] &= !passes_by;
            }
        }
        let mut meet = 0;
        for lane in 0..LANES {
            meet |= u32::from(meets[lane]) << lane;
        }
        meet & ((1_u64 << rays.len().min(LANES)) - 1) as u32
    }

    /// Whether a ray meets any over a part of the time, before `t_max`.
    #[inline(always)]
    pub fn may_meet<S: Simd>(
        &self,
        simd: S,
        part: usize,
        ray: (&SlabRay, f32),
        t_max: f32,
    ) -> bool {
        let Some(planes) = self.parts.get(part) else { return true };
        node::intersect_children::<S, W>(simd, planes, ray, t_max).1 != 0
    }
}

/// Hands out what holds each of at most `most` groups of boxes that are near each other, by halves.
fn group(boxes: &mut [Aabb], most: usize, hand_out: &mut impl FnMut(Aabb)) {
    if boxes.is_empty() {
        return;
    }
    let all = boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
    if most == 1 || boxes.len() == 1 {
        return hand_out(all);
    }
    let extent = all.extent();
    let axis = usize::from(extent.y > extent.x);
    let axis = if extent.z > extent[axis] { 2 } else { axis };
    let centre = |held: &Aabb| held.min[axis] + held.max[axis];
    let half = boxes.len() / 2;
    boxes.select_nth_unstable_by(half, |a, b| centre(a).total_cmp(&centre(b)));
    let (low, high) = boxes.split_at_mut(half);
    group(low, most / 2, hand_out);
    group(high, most / 2, hand_out);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Ray, Vec3};
    use crate::simd::baseline;
    use crate::testing::Random;

    #[test]
    fn eight_boxes_stand_for_themselves_and_more_for_their_neighbours() {
        let at =
            |x: usize| Aabb { min: Vec3::X * x as f32, max: Vec3::new(x as f32 + 0.5, 1.0, 1.0) };
        for (count, hole) in [(8, true), (3, true), (11, false)] {
            let outline =
                Outline::new(
                    2,
                    |part| if part == 0 { (0..count).map(at).collect() } else { Vec::new() },
                );
            let meets = |part, x| {
                let ray = Ray::new(Vec3::new(x, 0.5, -1.0), Vec3::Z, 0.0, f32::INFINITY);
                outline.may_meet(baseline(), part, (&SlabRay::new(&ray), 0.0), 5.0)
            };
            assert!((0..count).all(|x| meets(0, x as f32 + 0.25)));
            assert_eq!((0..count - 1).all(|x| !meets(0, x as f32 + 0.75)), hole, "{count}");
            assert!(!meets(0, -0.5) && !meets(1, 0.25) && meets(2, 0.25));
            let at = |x: f32, z: f32| {
                let direction = Vec3::new(0.0, 0.0, z);
                Ray::new(Vec3::new(x, 0.5, -1.0), direction, 0.0, f32::INFINITY)
            };
            let end = count as f32 - 0.5;
            let rays = [at(0.25, 1.0), at(0.25, -1.0), at(-0.5, 1.0), at(end, 1.0), at(0.25, 1.0)];
            let mut t_max = [f32::INFINITY; LANES];
            (t_max[3], t_max[4]) = (1.0, 0.9);
            assert_eq!(outline.may_ever_meet(&rays, &t_max), 0b01001);
        }
    }

    #[test]
    fn rays_that_meet_the_box_and_not_the_slab_pass_by() {
        let whole = Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE };
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let slab = Slab { normal, low: -0.1, high: 0.2 };
        let outline = Outline::new(1, |_| vec![whole]).within(Some(slab));
        let mut seen = [0; 2];
        for number in 0..4_000 {
            let random = &mut Random::new(6, number);
            let from = (random.cube() - 0.5) * 6.0;
            let to = (random.cube() - 0.5) * 2.0;
            // Along the ray, where it is in both.
            let is_in = |step: i32| {
                let at = from + (to - from) * (step as f32 / 500.0);
                let along = normal.dot(at);
                at.abs().max_element() <= 1.0 && (-0.1..=0.2).contains(&along)
            };
            let ray = Ray::new(from, to - from, 0.0, 2.0);
            let t_max = [2.0; LANES];
            let may = outline.may_ever_meet(&[ray], &t_max) == 1;
            assert!(may || !(0..=1000).any(is_in), "{ray:?}");
            seen[usize::from(may)] += 1;
        }
        assert!(seen[0] > 500 && seen[1] > 500, "{seen:?}");
    }
}
