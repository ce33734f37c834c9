//! What a tile remembers of its noise.

/// The pixels of a tile when it had half of its samples, and the error that was told then.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Earlier {
    /// The relative error at the last decision; infinite before the first.
    pub error: f64,
    /// The samples that each pixel had.
    pub samples: u64,
    /// The mean radiance of each pixel then.
    pub means: Vec<[f32; 3]>,
}

impl Default for Earlier {
    /// Nothing is known.
    fn default() -> Self {
        Self { error: f64::INFINITY, samples: 0, means: Vec::new() }
    }
}
