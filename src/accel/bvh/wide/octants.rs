//! The order of a node's children for each octant of directions, made ahead and packed.
//!
//! M. Ernst and G. Greiner, "Multi bounding volume hierarchies", 2008, section 3.1. A list is a
//! nibble a lane, the farthest first, so that the lists of eight octants are as many bits as a
//! stripe of the tree, whatever its width. The paper takes the order from the axes along which the
//! binary tree was split (algorithm 1); ours sorts by the middles of the boxes along the octant's
//! diagonal, which needs no binary tree and holds for any way to choose the children.

use crate::geom::SlabRay;
use crate::math::Aabb;

const OCTANTS: usize = 8;

/// The octant of a ray's direction: a bit for each axis that it goes down along.
#[inline(always)]
pub fn find_octant(slab: &SlabRay) -> usize {
    let [x, y, z] = slab.negative;
    (x | y << 1 | z << 2) % OCTANTS
}

/// The lists for all octants, in a stripe. A lane without a child has an empty box.
pub fn pack<const W: usize>(children: &[Aabb; W]) -> [u32; W] {
    let mut stripe = [0; W];
    for octant in 0..OCTANTS {
        for (place, lane) in sort_farthest_first(children, octant).into_iter().enumerate() {
            let bit = 4 * (octant * W + place);
            stripe[bit / 32] |= lane << (bit % 32);
        }
    }
    stripe
}

/// The list of an octant: in its lowest nibble the lane that comes first.
#[inline(always)]
pub fn read_list<const W: usize>(stripe: &[u32; W], octant: usize) -> u64 {
    let word = |place: usize| u64::from(stripe[place % W]);
    match W {
        4 => word(octant / 2) >> (16 * (octant % 2)) & 0xffff,
        8 => word(octant),
        _ => word(2 * octant) | word(2 * octant + 1) << 32,
    }
}

/// Lanes by how far their boxes are along an octant's diagonal; those without a child last.
fn sort_farthest_first<const W: usize>(children: &[Aabb; W], octant: usize) -> [u32; W] {
    let along = |lane: usize| {
        let bounds = &children[lane];
        if bounds.is_empty() {
            return f32::NEG_INFINITY;
        }
        // Halved first: the sum must not overflow.
        let middle = bounds.min * 0.5 + bounds.max * 0.5;
        let sign = |axis: usize| if octant >> axis & 1 == 1 { -1.0 } else { 1.0 };
        (0..3).map(|axis| middle[axis] / 4.0 * sign(axis)).sum()
    };
    let mut lanes: [u32; W] = std::array::from_fn(|lane| lane as u32);
    lanes.sort_by(|&a, &b| along(b as usize).total_cmp(&along(a as usize)));
    lanes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    fn check<const W: usize>() {
        // A stripe of boxes along x, the first one lowest, and no child in the last lane.
        let at = |i: usize| Aabb::of_points([Vec3::X * i as f32, Vec3::X * i as f32 + Vec3::ONE]);
        let children = std::array::from_fn(|i| if i == W - 1 { Aabb::EMPTY } else { at(i) });
        let stripe = pack::<W>(&children);
        for octant in 0..OCTANTS {
            let list = read_list(&stripe, octant);
            for place in 0..W {
                let lane = (list >> (4 * place) & 15) as usize;
                let expected = match (place == W - 1, octant & 1 == 1) {
                    (true, _) => W - 1,
                    (_, true) => place,
                    (_, false) => W - 2 - place,
                };
                assert_eq!(lane, expected, "width {W}, octant {octant}, place {place}");
            }
        }
    }

    #[test]
    fn going_up_the_highest_box_is_the_farthest_and_going_down_the_lowest() {
        check::<4>();
        check::<8>();
        check::<16>();
    }
}
