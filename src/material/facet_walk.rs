//! Light that scatters on two facets until it gets out.
//!
//! Each facet scatters by the surface's own BSDF. What meets the other facet goes on there, so that
//! nothing is lost; as much light goes from one to the other as comes back the same way, so that
//! all is as reciprocal as the BSDF. Light that a facet transmits goes on among the same facets
//! seen from behind.
//!
//! What comes from a light by way of one scattering after another is found as along a path: at
//! each, the light is asked for directly, and weighed by the density of the one step that would
//! have gone there.

use super::bsdf::Bsdf;
use super::facets::Facets;
use crate::math::{Vec2, Vec3};

/// Light that has not got out after so many scatterings is lost: on white facets of the steepest
/// slope some 1e-12.
pub const MOST_SCATTERINGS: u32 = 256;

/// A scattering on one of the facets.
#[derive(Clone, Copy, Debug)]
pub struct OnFacet<'a> {
    facets: &'a Facets,
    bsdf: &'a Bsdf,
    /// Which of the two it is.
    facet: usize,
    /// Whether it is seen from the triangle's front.
    front: bool,
    /// Towards the viewer, or to where on the other facet the way came from; local.
    wo: Vec3,
    /// What the way up to here has left of the light, over the probability of having come.
    throughput: Vec3,
}

/// A direction in which light gets out, towards the light.
#[derive(Clone, Copy, Debug)]
pub struct FacetSample {
    /// Unit, world space.
    pub direction: Vec3,
    /// Whether it leads away from the triangle's front.
    pub front: bool,
    /// What all scatterings have left, over their probability.
    pub weight: Vec3,
    /// Density per solid angle with which the last scattering would have drawn it and got out.
    pub pdf: f32,
    /// Whether the last scattering was by a delta lobe.
    pub delta: bool,
    /// The product of the ratios of indices, see [`super::BsdfSample::eta`].
    pub eta: f32,
}

/// The numbers that draw a scattering.
#[derive(Clone, Copy, Debug)]
pub struct FacetNumbers {
    /// The direction.
    pub direction: Vec2,
    /// The lobe.
    pub lobe: f32,
    /// Whether the other facet is in the way.
    pub escape: f32,
}

impl OnFacet<'_> {
    /// The share of light from a unit `direction` that goes back the way from here and gets to the
    /// viewer, times the cosine; and the density with which the way would have gone on there.
    pub fn eval(&self, direction: Vec3) -> (Vec3, f32) {
        let wi = self.facets.frames[self.facet].to_local(direction);
        let front = self.front == ((wi.z > 0.0) == (self.wo.z > 0.0));
        let unblocked = self.facets.unblocked(front, direction);
        if unblocked == 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let (value, pdf) = self.bsdf.eval(self.wo, wi);
        (self.throughput * value * unblocked, pdf * unblocked)
    }
}

impl Facets {
    /// Follows a way from a viewer in the unit direction `viewer` until it gets out. `numbers`
    /// draw the scattering of that number, `u_facet` the facet that is seen; `visit` is called at
    /// each. `None` where all is absorbed.
    pub fn walk(
        &self,
        bsdf: &Bsdf,
        viewer: Vec3,
        u_facet: f32,
        mut numbers: impl FnMut(u32) -> FacetNumbers,
        mut visit: impl FnMut(u32, &OnFacet),
    ) -> Option<FacetSample> {
        let mut front = self.is_in_front(viewer);
        let shown = self.shown(front, viewer);
        let mut facet = usize::from(u_facet * (shown[0] + shown[1]) >= shown[0]);
        if shown[facet] <= 0.0 {
            return None;
        }
        let (mut back, mut throughput, mut eta) = (viewer, Vec3::ONE, 1.0);
        for scattering in 0..MOST_SCATTERINGS {
            let frame = &self.frames[facet];
            let wo = frame.to_local(back);
            if (wo.z > 0.0) != front {
                return None; // seen edge on, but for rounding
            }
            visit(scattering, &OnFacet { facets: self, bsdf, facet, front, wo, throughput });
            let FacetNumbers { direction, lobe, escape } = numbers(scattering);
            let scattered = bsdf.sample(wo, lobe, direction)?;
            throughput *= scattered.weight;
            eta *= scattered.eta;
            if throughput == Vec3::ZERO {
                return None;
            }
            front ^= (scattered.wi.z > 0.0) != (wo.z > 0.0);
            let direction = frame.to_world(scattered.wi);
            let unblocked = self.unblocked(front, direction);
            if escape < unblocked {
                let (pdf, delta) = (scattered.pdf * unblocked, scattered.delta);
                return Some(FacetSample { direction, front, weight: throughput, pdf, delta, eta });
            }
            (back, facet) = (-direction, 1 - facet);
        }
        None
    }
}
