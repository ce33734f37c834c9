//! Shading normals that lose no light.
//!
//! A shading normal sees directions that the triangle does not, and the other way round. Plainly
//! taken, light in such directions is lost: a smooth ball of few triangles is dark at its edge.
//! Here the triangle stands for a surface that is finer than itself, whose facets face the shading
//! normal:
//!
//! - A viewer whom the shading normal turns away from sees facets that face him: the normal is bent
//!   to him, in the plane of both, as far on his side as it was on the other, but not farther than
//!   the triangle itself.
//! - Light that scatters below the triangle is not lost. It leaves from the curved surface that the
//!   normals of the vertices tell (Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II,
//!   2021), beyond the triangle's edge perhaps. If it meets the triangle, it scatters again there,
//!   as between facets (Schüssler et al., "Microfacet-based Normal Mapping for Robust Monte Carlo
//!   Path Tracing", 2017, follow such light in closed form). Only the side that it leaves from is
//!   told by the BSDF, so that it never gets through.
//!
//! Whatever is above the shading normal so counts alike both ways and is the BSDF's own, and its
//! density is the BSDF's own: what plain shading normals show, these do too.

use super::surface::{GAMMA_7, Surface, offset_origin};
use crate::math::Vec3;
use crate::names::choices;

/// What becomes of light about which shading normal and triangle disagree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShadingNormals {
    /// It scatters on: a white surface in a white world is invisible, whatever its normals.
    #[default]
    Robust,
    /// It is lost.
    Plain,
    /// It scatters on facets that the triangle stands for, see [`crate::material::Facets`]: nothing
    /// is lost, and light counts alike both ways.
    Microfacet,
}

choices!(ShadingNormals, "kind of shading normals", [
    Robust => "robust",
    Plain => "plain",
    Microfacet => "microfacet",
]);

/// A shading normal that shows a viewer less than this cosine is bent, unless the triangle shows
/// even less.
pub(super) const LEAST_VIEW_COSINE: f32 = 0.01;

/// The unit normal `shading`, bent if it does not face a viewer in the unit direction `viewer`,
/// who is in front of the triangle of normal `geometric` or behind it.
#[inline(always)]
pub(super) fn bent_to_viewer(shading: Vec3, geometric: Vec3, viewer: Vec3, front: bool) -> Vec3 {
    let side = if front { 1.0 } else { -1.0 };
    let (along, upright) = (shading.dot(viewer) * side, geometric.dot(viewer) * side);
    if along < upright.min(LEAST_VIEW_COSINE) {
        let shown = upright.min(2.0 * LEAST_VIEW_COSINE - along);
        (shading + viewer * ((shown - along) * side)).normalize_or(geometric)
    } else {
        shading
    }
}

impl Surface {
    /// The geometric normal on the viewer's side.
    #[inline(always)]
    pub fn facing(&self) -> Vec3 {
        if self.front { self.normal } else { -self.normal }
    }

    /// Where light leaves from that goes on at the `side` of the surface which a unit normal tells,
    /// from `bulge` metres beyond it.
    #[inline(always)]
    pub fn origin_beyond(&self, side: Vec3, bulge: f32) -> Vec3 {
        let moved = self.position + side * bulge;
        offset_origin(moved, self.position_error + moved.abs() * GAMMA_7, self.normal, side)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Sampler, warp};

    #[test]
    fn bent_normals_face_the_viewer_and_stay_on_their_side() {
        let mut bent_count = 0;
        for i in 0..2000 {
            let mut sampler = Sampler::new(i, 0, 5);
            let [geometric, shading, viewer] = [(); 3].map(|()| warp::sphere(sampler.next_2d()));
            let shading = if shading.dot(geometric) < 0.0 { -shading } else { shading };
            let front = geometric.dot(viewer) > 0.0;
            let side = if front { 1.0 } else { -1.0 };
            let bent = bent_to_viewer(shading, geometric, viewer, front);
            assert!((bent.length() - 1.0).abs() < 1e-5 && bent.dot(geometric) > -1e-6);
            let (shown, upright) = (bent.dot(viewer) * side, geometric.dot(viewer) * side);
            assert!(shown >= upright.min(LEAST_VIEW_COSINE) - 1e-5, "{shown} {upright}");
            if shading.dot(viewer) * side >= LEAST_VIEW_COSINE {
                assert_eq!(bent, shading);
            } else {
                bent_count += 1;
            }
        }
        assert!(bent_count > 200, "{bent_count}");
    }

    #[test]
    fn a_normal_that_is_the_triangles_stays_to_the_bit() {
        for i in 0..500 {
            let mut sampler = Sampler::new(i, 0, 6);
            let [normal, viewer] = [(); 2].map(|()| warp::sphere(sampler.next_2d()));
            for front in [false, true] {
                assert_eq!(bent_to_viewer(normal, normal, viewer, front), normal);
            }
        }
    }
}
