//! The two facets that a triangle with a shading normal stands for.
//!
//! After Schüssler, Heitz, Hanika and Dachsbacher, "Microfacet-based Normal Mapping for Robust
//! Monte Carlo Path Tracing" (2017): seen from near, the triangle is a saw. Its one facet faces the
//! shading normal, its other one stands upright on the triangle and faces against the slope, so
//! that both together are as large, from any side, as the triangle. A viewer sees of each what its
//! projected area says, and light that leaves one of them may be in the way of the other, alike
//! anywhere on it.

use crate::math::{Frame, Vec3};

/// A shading normal that is as near to the triangle's as this, by the sine, is the triangle's.
const LEAST_SLOPE: f32 = 1e-4;

/// A shading normal that is steeper counts as this steep: the deeper the saw, the longer light
/// scatters in it.
const MOST_SLOPE: f32 = 5.0;

/// Two facets, as many times as a triangle is large.
#[derive(Clone, Copy, Debug)]
pub struct Facets {
    /// The triangle's unit normal.
    normal: Vec3,
    /// Of the facet that faces the shading normal, and of the upright one. Seen from the
    /// triangle's front both face outwards.
    pub(super) frames: [Frame; 2],
    /// How large each is, over the triangle.
    areas: [f32; 2],
}

impl Facets {
    /// The facets of a triangle of unit normal `geometric`, whose shading frame's normal is on the
    /// same side; `None` if both normals are the same.
    pub fn new(geometric: Vec3, shading: &Frame) -> Option<Self> {
        let cosine = shading.normal.dot(geometric).max(0.0);
        let along = shading.normal - geometric * cosine;
        let sine = along.length();
        // Not so if a normal is NaN.
        if !(sine > LEAST_SLOPE && cosine < 1.0) {
            return None;
        }
        let downhill = along / sine;
        let mut slope = sine / cosine;
        let mut frame = *shading;
        if slope > MOST_SLOPE {
            slope = MOST_SLOPE;
            let bent = (geometric + downhill * slope).normalize();
            frame = Frame::from_normal_tangent(bent, shading.tangent);
        }
        let upright = Frame::from_normal_tangent(-downhill, shading.tangent);
        let areas = [(1.0 + slope * slope).sqrt(), slope];
        Some(Self { normal: geometric, frames: [frame, upright], areas })
    }

    /// Whether a direction leads to the triangle's front.
    pub fn is_in_front(&self, direction: Vec3) -> bool {
        self.normal.dot(direction) > 0.0
    }

    /// How large the facets look from a unit `direction`, each alone, to who is on the triangle's
    /// front or back; over the triangle's area.
    pub(super) fn shown(&self, front: bool, direction: Vec3) -> [f32; 2] {
        let side = side(front);
        [0, 1].map(|i| (self.frames[i].normal.dot(direction) * side).max(0.0) * self.areas[i])
    }

    /// The share of the facets which face a unit `direction` that sees out in it, on the triangle's
    /// front or back. The rest of them have the other facet before them.
    pub(super) fn unblocked(&self, front: bool, direction: Vec3) -> f32 {
        let upright = self.normal.dot(direction) * side(front);
        let [first, second] = self.shown(front, direction);
        let shown = first + second;
        // Where both face it, both together are as large as the triangle.
        if upright <= 0.0 {
            0.0
        } else if first > 0.0 && second > 0.0 || shown <= upright {
            1.0
        } else {
            upright / shown
        }
    }
}

/// The sign of the direction outwards.
fn side(front: bool) -> f32 {
    if front { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Sampler, warp};

    /// Random facets, by their normals, and a direction.
    fn any(i: u64) -> Option<(Facets, Vec3, Vec3)> {
        let mut sampler = Sampler::new(i, 0, 8);
        let [geometric, shading, direction] = [(); 3].map(|()| warp::sphere(sampler.next_2d()));
        let shading = if shading.dot(geometric) < 0.0 { -shading } else { shading };
        let facets = Facets::new(geometric, &Frame::from_normal(shading))?;
        Some((facets, geometric, direction))
    }

    #[test]
    fn they_are_as_large_from_any_side_as_the_triangle() {
        for i in 0..5000 {
            let Some((facets, geometric, direction)) = any(i) else { continue };
            let [p, t] = [0, 1].map(|i| facets.frames[i].normal * facets.areas[i]);
            assert!((p + t).distance(geometric) < 1e-5, "{facets:?}");
            // What is seen of both is the triangle, whichever side it is seen from.
            let front = facets.is_in_front(direction);
            let seen: f32 = facets.shown(front, direction).iter().sum();
            let seen = seen * facets.unblocked(front, direction);
            let upright = geometric.dot(direction).abs();
            assert!((seen - upright).abs() < 1e-5, "{seen} {upright}");
            // From behind, nothing is.
            assert_eq!(facets.unblocked(!front, direction), 0.0);
        }
    }

    #[test]
    fn what_is_in_the_way_faces_the_light() {
        let mut blocked = 0;
        for i in 0..5000 {
            let Some((facets, _, direction)) = any(i) else { continue };
            for (front, from) in [(false, 0), (false, 1), (true, 0), (true, 1)] {
                let faces = facets.shown(front, direction)[from] > 0.0;
                if faces && facets.unblocked(front, direction) < 1.0 - 1e-5 {
                    assert!(facets.shown(front, -direction)[1 - from] > 0.0);
                    blocked += 1;
                }
            }
        }
        assert!(blocked > 2000, "{blocked}");
    }

    /// As much light goes from one facet to the other in any direction as comes back in it.
    #[test]
    fn the_exchange_between_them_is_reciprocal() {
        for i in 0..5000 {
            let Some((facets, _, direction)) = any(i) else { continue };
            let exchanged = |from: usize, direction: Vec3| {
                let blocked = 1.0 - facets.unblocked(true, direction);
                facets.shown(true, direction)[from] * blocked
            };
            let (there, back) = (exchanged(0, direction), exchanged(1, -direction));
            assert!((there - back).abs() < 1e-5, "{there} {back}");
        }
    }

    #[test]
    fn equal_normals_make_none_and_steep_ones_are_bent() {
        assert!(Facets::new(Vec3::Z, &Frame::from_normal(Vec3::Z)).is_none());
        assert!(Facets::new(Vec3::Z, &Frame::from_normal(Vec3::NAN)).is_none());
        let steep = Facets::new(Vec3::Z, &Frame::from_normal(Vec3::X)).expect("not flat");
        let [p, t] = steep.frames.map(|frame| frame.normal);
        assert!((p.x / p.z - MOST_SLOPE).abs() < 1e-5 && t == Vec3::NEG_X, "{p} {t}");
    }
}
