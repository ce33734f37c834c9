//! Distances to splitting planes, and the one rule by which all walks choose between children.

use crate::math::{Aabb, Ray};

/// A ray, prepared for splitting planes.
#[derive(Clone, Copy, Debug)]
pub struct KdRay {
    /// Four, so that two bits of a node index it without a check; the last is never used.
    axes: [Axis; 4],
}

#[derive(Clone, Copy, Debug, Default)]
struct Axis {
    origin: f32,
    inverse: f32,
    direction: f32,
    /// 1 if the ray goes down, negative zero included, else 0.
    negative: u32,
}

impl KdRay {
    /// Keeps reciprocals finite: a component of zero becomes a huge slope of its sign. Not
    /// denormal, since to divide by those is slow.
    pub const SMALLEST: f32 = f32::MIN_POSITIVE;

    /// Prepares a ray.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let (o, d) = (ray.origin(), ray.direction());
        let axis = |i: usize| Axis {
            origin: o[i],
            inverse: 1.0 / d[i].abs().max(Self::SMALLEST).copysign(d[i]),
            direction: d[i],
            negative: u32::from(d[i].is_sign_negative()),
        };
        Self { axes: [axis(0), axis(1), axis(2), Axis::default()] }
    }

    /// Where it meets the plane, in multiples of its direction: the only function that says so.
    /// Monotone in `split`, never NaN for a split that is a number, infinite ones included.
    #[inline(always)]
    pub fn t_split(&self, axis: usize, split: f32) -> f32 {
        let a = &self.axes[axis & 3];
        (split - a.origin) * a.inverse
    }

    /// The child that is nearer to where it comes from: 0 below the plane, 1 above.
    #[inline(always)]
    pub fn near(&self, axis: usize) -> usize {
        self.axes[axis & 3].negative as usize
    }

    /// The origin's coordinate.
    #[inline(always)]
    pub fn origin(&self, axis: usize) -> f32 {
        self.axes[axis & 3].origin
    }

    /// The direction's reciprocal, made finite.
    #[inline(always)]
    pub fn inverse(&self, axis: usize) -> f32 {
        self.axes[axis & 3].inverse
    }

    /// The coordinate at `t`.
    #[inline(always)]
    pub fn at(&self, axis: usize, t: f32) -> f32 {
        let a = &self.axes[axis & 3];
        a.origin + t * a.direction
    }

    /// Where it leaves a cell, by the distances to its planes: `t` and the axis of the plane, the
    /// first of equals.
    #[inline(always)]
    pub fn exit(&self, cell: &Aabb) -> (f32, usize) {
        let t = |axis: usize| {
            let far = if self.near(axis) == 0 { cell.max[axis] } else { cell.min[axis] };
            self.t_split(axis, far)
        };
        let (mut exit, mut axis) = (t(0), 0);
        for other in 1..3 {
            let t = t(other);
            if t < exit {
                (exit, axis) = (t, other);
            }
        }
        (exit, axis)
    }
}

/// The part of a ray that is still to be walked: from `enter` to `exit`, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Where it starts.
    pub enter: f32,
    /// Where it ends.
    pub exit: f32,
}

/// Which children of a node a span crosses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// The nearer only.
    Near,
    /// The farther only.
    Far,
    /// The nearer up to the plane, then the farther.
    Both,
}

impl Crossing {
    /// The tie rule of all walks, that of push-down (algorithm 4 of the review).
    #[inline(always)]
    pub fn of(t_split: f32, span: Span) -> Self {
        if t_split <= span.enter {
            Self::Far
        } else if t_split >= span.exit {
            Self::Near
        } else {
            Self::Both
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    #[test]
    fn planes_along_the_ray_are_behind_or_endless_far_by_the_sign() {
        let ray = Ray::new(Vec3::ONE, Vec3::new(0.0, -0.0, 1.0), 0.0, f32::INFINITY);
        let ray = KdRay::new(&ray);
        assert_eq!((ray.near(0), ray.near(1), ray.near(2)), (0, 1, 0));
        assert!(ray.t_split(0, 2.0) > 1e37 && ray.t_split(0, 0.0) < -1e37);
        assert!(ray.t_split(1, 2.0) < -1e37 && ray.t_split(1, 0.0) > 1e37);
        // In the plane: at distance zero, which is never after the entry: the far side.
        assert_eq!(ray.t_split(0, 1.0), 0.0);
        assert_eq!(ray.t_split(2, f32::INFINITY), f32::INFINITY);
    }

    #[test]
    fn ties_go_to_one_side_and_far_comes_first() {
        let span = Span { enter: 1.0, exit: 2.0 };
        assert_eq!(Crossing::of(1.0, span), Crossing::Far);
        assert_eq!(Crossing::of(2.0, span), Crossing::Near);
        assert_eq!(Crossing::of(1.5, span), Crossing::Both);
        assert_eq!(Crossing::of(1.0, Span { enter: 1.0, exit: 1.0 }), Crossing::Far);
    }
}
