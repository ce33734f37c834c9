//! Which dimensions of the sampler a path uses: four for the camera, then two sets of four for each
//! vertex.

const CAMERA_DIMENSIONS: u32 = 4;
const VERTEX_DIMENSIONS: u32 = 8;

/// The first dimension of the vertex at the end of segment `depth`.
pub fn first_dimension(depth: u32) -> u32 {
    CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * (depth - 1)
}

/// The vertex's last dimension, which draws the wavelength of a path that disperses there.
pub fn wavelength_dimension(depth: u32) -> u32 {
    first_dimension(depth) + VERTEX_DIMENSIONS - 1
}
