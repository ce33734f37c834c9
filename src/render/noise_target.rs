//! How good a picture is to be, and how good it is.

/// How good a picture is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseTarget {
    /// The relative error of each tile: the root of the mean square error of its pixels over their
    /// mean.
    pub error: f32,
    /// Samples that each pixel takes whatever its noise.
    pub min_spp: u64,
}

/// How good a picture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseReached {
    /// The largest relative error of a tile.
    pub largest: f64,
    /// The share of tiles whose error, and that of their neighbours, is below the target.
    pub share: f64,
}
