//! A row of the table of structures.

use std::fmt;
use std::sync::Arc;

use fearless_simd::Level;

use super::{Accel, BuildError, OptionSpec, Options, Steps};
use crate::geom::TriangleSource;

/// A row of the table: all that the rest of the program knows about a structure.
pub struct Variant {
    /// As `--accel` takes it.
    pub id: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Where it comes from.
    pub paper: &'static str,
    /// Its options.
    pub options: &'static [OptionSpec],
    /// Builds the structure over the triangles, on the threads of the current pool.
    pub build: fn(&BuildInput<'_>) -> Result<Box<dyn Accel>, BuildError>,
}

/// What a structure is built from.
pub struct BuildInput<'a> {
    /// The triangles.
    pub source: Arc<dyn TriangleSource>,
    /// The options of its row.
    pub options: &'a Options,
    /// The instruction set to walk with.
    pub level: Level,
    /// Who is told how far the build is.
    pub steps: &'a Steps<'a>,
}

impl fmt::Debug for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id)
    }
}
