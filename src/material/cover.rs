//! What lies on the outside of glass.

use super::layer_columns::{Curve, look_up};
use super::thin_film::ThinFilm;
use crate::math::Vec3;

/// A film, and layers above it; either may be missing.
///
/// Layers throw a share of the light that leaves glass back into it. Where it leaves by a facet, it
/// comes back as if that facet had reflected it. So smooth glass loses nothing, and what one sees
/// through it stays sharp.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cover<'a> {
    pub film: Option<&'a ThinFilm>,
    /// The share of light that layers on a solid keep.
    pub kept: Option<&'a Curve>,
}

impl Cover<'_> {
    /// What light from a direction has to pass when it leaves the glass.
    #[inline]
    pub fn seen_from(self, wo: Vec3) -> Self {
        let kept = self.kept.filter(|_| wo.z < 0.0);
        Self { kept, ..self }
    }
}

/// The share that layers keep of light that leaves at a cosine; none where it does not leave.
#[inline]
pub fn kept_at(kept: &Curve, cos: f32) -> f32 {
    if cos > 0.0 { look_up([kept; 2], 0.0, cos) } else { 0.0 }
}
