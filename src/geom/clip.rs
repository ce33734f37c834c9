//! The part of a triangle inside a box.

use super::Triangle;
use crate::math::{Aabb, DVec3, Vec3};

/// Corners of a triangle cut by six planes, at most.
const CORNERS: usize = 9;

/// The box of the part of a triangle inside `cell`; `None` if there is none.
///
/// Sutherland and Hodgman's clipping in double precision: off by some 2^-50 of the coordinates,
/// and by half an ulp where the result is rounded.
pub fn clip_bounds(triangle: &Triangle, cell: &Aabb) -> Option<Aabb> {
    let bounds = triangle.bounds();
    if cell.contains(bounds) {
        return Some(bounds);
    }
    let mut corners = [DVec3::ZERO; CORNERS];
    corners[0] = triangle.a.as_dvec3();
    corners[1] = triangle.b.as_dvec3();
    corners[2] = triangle.c.as_dvec3();
    let mut count = 3;
    for axis in 0..3 {
        for (plane, inside) in [(cell.min[axis], 1.0), (cell.max[axis], -1.0)] {
            if inside > 0.0 && bounds.min[axis] >= plane
                || inside < 0.0 && bounds.max[axis] <= plane
            {
                continue;
            }
            let plane = f64::from(plane);
            let (before, before_count) = (corners, count);
            count = 0;
            for i in 0..before_count {
                let (p, q) = (before[i], before[(i + 1) % before_count]);
                let (dp, dq) = ((p[axis] - plane) * inside, (q[axis] - plane) * inside);
                if dp >= 0.0 {
                    corners[count] = p;
                    count += 1;
                }
                if (dp < 0.0) != (dq < 0.0) && count < CORNERS {
                    let mut cut = p + (q - p) * (dp / (dp - dq));
                    cut[axis] = plane;
                    corners[count] = cut;
                    count += 1;
                }
            }
            if count == 0 {
                return None;
            }
        }
    }
    let corners = &corners[..count];
    let low = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = corners.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let (min, max): (Vec3, Vec3) = (low.as_vec3(), high.as_vec3());
    Some(Aabb { min, max })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF: Triangle =
        Triangle { a: Vec3::ZERO, b: Vec3::new(4.0, 0.0, 0.0), c: Vec3::new(0.0, 4.0, 0.0) };

    fn clip(min: [f32; 3], max: [f32; 3]) -> Option<Aabb> {
        clip_bounds(&HALF, &Aabb { min: min.into(), max: max.into() })
    }

    #[test]
    fn what_sticks_out_is_cut_off() {
        let part = clip([1.0, 1.0, -1.0], [9.0, 9.0, 1.0]).expect("they overlap");
        assert_eq!((part.min, part.max), (Vec3::new(1.0, 1.0, 0.0), Vec3::new(3.0, 3.0, 0.0)));
        let part = clip([3.0, -1.0, -1.0], [3.5, 9.0, 1.0]).expect("they overlap");
        assert_eq!((part.min, part.max), (Vec3::new(3.0, 0.0, 0.0), Vec3::new(3.5, 1.0, 0.0)));
    }

    #[test]
    fn a_box_beyond_the_long_side_is_empty_though_the_boxes_overlap() {
        assert_eq!(clip([2.5, 2.5, -1.0], [3.5, 3.5, 1.0]), None);
        assert!(clip([2.0, 2.0, -1.0], [3.5, 3.5, 1.0]).is_some());
    }

    #[test]
    fn a_triangle_inside_is_left_alone() {
        assert_eq!(clip([-1.0; 3], [9.0; 3]), Some(HALF.bounds()));
    }
}
