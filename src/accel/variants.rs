//! The table of structures, and how one is named and built.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use super::{Accel, BuildError, BuildInput, Options, SpecError, Variant, brute, bvh, kd};
use crate::geom::TriangleSource;
use crate::names::near;
use crate::simd::Isa;

/// All structures; the only place where they are registered. The order is that of all listings.
///
/// A static, so that who uses it does not compile every structure anew.
pub static VARIANTS: &[Variant] = &[
    bvh::wide::AUTO,
    brute::VARIANT,
    bvh::binary::VARIANT,
    bvh::wide::MBVH4,
    bvh::wide::MBVH8,
    bvh::wide::MBVH16,
    bvh::packet::PACKET,
    bvh::packet::PARTITION,
    bvh::packet::ENTRY_POINT,
    bvh::packet::PATH_COMPRESSION,
    kd::SEQUENTIAL,
    kd::STACK_ORIGIN,
    kd::STACK_DIRECTION,
    kd::STACK_ROBUST,
    kd::BRANCHLESS,
    kd::ROPES,
    kd::ROPE_TREES,
    kd::RESTART,
    kd::BACKTRACK,
    kd::SPARSE_BOXES,
    kd::PUSH_DOWN,
    kd::SHORT_STACK,
    kd::SPILL,
    kd::PREFETCH,
    kd::PACKET,
    kd::PACKET_ROPES,
    kd::OMNIDIRECTIONAL,
    kd::OMNIDIRECTIONAL_ORIGIN,
    kd::LCTS,
    kd::RELEVANT_TRIANGLES,
    kd::ENTRY_POINT,
    kd::PATH_COMPRESSION,
    kd::WIDE,
];

/// A structure with its options, as in `bvh2:build=sweep`.
#[derive(Clone, Debug)]
pub struct AccelSpec {
    /// The row.
    pub variant: &'static Variant,
    /// The options.
    pub options: Options,
}

impl Default for AccelSpec {
    /// `auto`: the first of the table.
    fn default() -> Self {
        let variant = &VARIANTS[0];
        Self { variant, options: Options::defaults(variant.options) }
    }
}

impl FromStr for AccelSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let (id, options) = text.split_once(':').unwrap_or((text, ""));
        let variant = VARIANTS
            .iter()
            .find(|variant| variant.id == id)
            .ok_or_else(|| SpecError::UnknownId { id: id.to_owned(), near: near_ids(id) })?;
        Ok(Self { variant, options: Options::parse(variant.id, variant.options, options)? })
    }
}

impl fmt::Display for AccelSpec {
    /// The id and those options that are not at their defaults.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.variant.id)?;
        let chosen = self.options.iter().zip(self.variant.options);
        let chosen = chosen.filter(|((_, value), spec)| *value != spec.default);
        for (i, ((name, value), _)) in chosen.enumerate() {
            write!(f, "{}{name}={value}", if i == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}

/// Up to three ids like the one that was meant, the most similar first.
fn near_ids(id: &str) -> Vec<&'static str> {
    near(id, VARIANTS.iter().map(|variant| variant.id))
        .into_iter()
        .map(|number| VARIANTS[number].id)
        .collect()
}

/// Builds a structure over triangles, on the threads of the current pool.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use dapple::geom::{Triangle, TriangleList};
/// use dapple::math::Vec3;
/// use dapple::{AccelSpec, Isa};
///
/// let triangle = Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Y };
/// let spec: AccelSpec = "mbvh8:build=sweep".parse()?;
/// let accel = dapple::build(&spec, Arc::new(TriangleList(vec![triangle])), Isa::Auto)?;
/// assert_eq!(accel.report().triangles, 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Limits of the structure, or an instruction set that this CPU lacks.
pub fn build(
    spec: &AccelSpec,
    source: Arc<dyn TriangleSource>,
    isa: Isa,
) -> Result<Box<dyn Accel>, BuildError> {
    const LIMIT: usize = (u32::MAX - 1) as usize;
    if source.len() > LIMIT {
        return Err(BuildError::TooManyTriangles { count: source.len(), limit: LIMIT });
    }
    let level = isa.level().ok_or(BuildError::NoSuchIsa { isa: isa.name() })?;
    (spec.variant.build)(&BuildInput { source, options: &spec.options, level })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_unique_and_options_well_formed() {
        for (i, variant) in VARIANTS.iter().enumerate() {
            assert!(VARIANTS[..i].iter().all(|other| other.id != variant.id), "{}", variant.id);
            assert!(!variant.summary.ends_with('.') && !variant.summary.is_empty());
            // Every default can be written back and read again.
            for spec in variant.options {
                let text = format!("{}:{}={}", variant.id, spec.name, spec.default);
                let read: AccelSpec = text.parse().expect("a default is a legal value");
                assert_eq!(read.options, Options::defaults(variant.options), "{text}");
            }
        }
    }

    #[test]
    fn a_slip_of_the_pen_is_answered_with_the_near_id() {
        let error = "brutte".parse::<AccelSpec>().expect_err("there is no such structure");
        assert!(error.to_string().contains("did you mean brute?"), "{error}");
    }
}
