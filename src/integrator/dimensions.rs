//! Which dimensions of the sampler serve which decision of a path.
//!
//! The sampler's dimensions come in sets of four, which are stratified together; different sets are
//! independent. So a set holds decisions whose effects are joint: where a path goes on, and which
//! point of a light it asks for where it arrives.
//!
//! | set | lanes 0 and 1 | lanes 2 and 3 |
//! |---|---|---|
//! | 0 | place in the pixel | point of the lens |
//! | 1 | point of the light at the first vertex | time, none |
//! | 2 d | direction from vertex d | point of the light at vertex d + 1 |
//! | 2 d + 1 | lobe, Russian roulette | choice of the light, wavelength at vertex d |
//!
//! Sets from 2^22 on belong to media: set 2^22 + d holds, in lanes 0 and 1, the colour that draws
//! the distance along segment d, and that distance. Sets from 2^23 on belong to scatterings on
//! facets, see [`crate::material::Facets`]: two to each.

use crate::material::MOST_SCATTERINGS;

/// The dimensions of a vertex, and of the camera.
const VERTEX_DIMENSIONS: u32 = 8;

/// Beyond those of the deepest vertex.
const FIRST_FLIGHT_DIMENSION: u32 = 1 << 24;

/// Beyond those of the deepest flight.
const FIRST_FACET_DIMENSION: u32 = 1 << 25;

/// The place in the pixel: two dimensions.
pub const PIXEL_DIMENSION: u32 = 0;

/// The point of the lens: two dimensions.
pub const LENS_DIMENSION: u32 = 2;

/// The time of the sample, while the shutter is open: one dimension.
pub const TIME_DIMENSION: u32 = 6;

/// The direction that a path takes from the end of segment `depth`: two dimensions.
pub fn direction_dimension(depth: u32) -> u32 {
    VERTEX_DIMENSIONS * depth
}

/// The point of the light that is asked for at the end of segment `depth`: two dimensions, those
/// after [`direction_dimension`] of the vertex before, if there is one.
pub fn light_dimension(depth: u32) -> u32 {
    if depth == 1 { 4 } else { direction_dimension(depth - 1) + 2 }
}

/// The colour that draws how far segment number `depth` gets in a medium, and how far: two
/// dimensions.
pub fn flight_dimension(depth: u32) -> u32 {
    FIRST_FLIGHT_DIMENSION.wrapping_add(4 * depth)
}

/// Scattering number `scattering` on the facets at the end of segment `depth`: the direction, two
/// dimensions, and the lobe; from the fourth after on the choice of this scattering among all, for
/// a light, the choice of the facet that is seen, and whether the way gets out.
pub fn facet_dimension(depth: u32, scattering: u32) -> u32 {
    let before = depth.wrapping_mul(MOST_SCATTERINGS).wrapping_add(scattering);
    FIRST_FACET_DIMENSION.wrapping_add(before.wrapping_mul(VERTEX_DIMENSIONS))
}

/// The lobe, and after it Russian roulette, the choice of the light and the wavelength.
pub fn choice_dimension(depth: u32) -> u32 {
    direction_dimension(depth) + 4
}
