//! The table of structures, and how one is named and built.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use super::located::Located;
use super::two_level::{Placed, TwoLevel};
use super::{
    Accel, BuildError, BuildInput, Instances, Options, SpecError, Steps, Variant, brute, bvh, kd,
};
use crate::files::Meter;
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
    /// What becomes of copies of a mesh.
    pub instances: Instances,
    /// The row of the structure over copies, if it is another than that of their meshes.
    pub top: Option<&'static Variant>,
}

impl AccelSpec {
    /// A row with its options at their defaults.
    pub fn of(variant: &'static Variant) -> Self {
        let options = Options::defaults(variant.options);
        Self { variant, options, instances: Instances::default(), top: None }
    }
}

impl Default for AccelSpec {
    /// `auto`: the first of the table.
    fn default() -> Self {
        Self::of(&VARIANTS[0])
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
        let (instances, top, own) = take_options(variant.id, options)?;
        let options = Options::parse(variant.id, variant.options, &own)?;
        Ok(Self { variant, options, instances, top })
    }
}

impl fmt::Display for AccelSpec {
    /// The id and those options that are not at their defaults.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.variant.id)?;
        let own = self.options.iter().zip(self.variant.options);
        let own = own.filter(|((_, value), spec)| *value != spec.default);
        let mut chosen: Vec<String> =
            own.map(|((name, value), _)| format!("{name}={value}")).collect();
        if self.instances != Instances::default() {
            chosen.push(format!("instances={}", self.instances));
        }
        chosen.extend(self.top.map(|row| format!("top={}", row.id)));
        if chosen.is_empty() { Ok(()) } else { write!(f, ":{}", chosen.join(",")) }
    }
}

/// What is said of copies among the options of a structure: `instances=…` and `top=ID`, the row
/// that the structure over placements is of; and the text without them.
fn take_options(
    id: &'static str,
    text: &str,
) -> Result<(Instances, Option<&'static Variant>, String), SpecError> {
    let (mut instances, mut top, mut rest) = (Instances::default(), None, Vec::new());
    for part in text.split(',') {
        let bad = |option, value: &str, expected: &str| SpecError::BadValue {
            id,
            option,
            value: value.to_owned(),
            expected: expected.to_owned(),
        };
        match part.split_once('=') {
            Some(("instances", value)) => {
                let choice = value.parse();
                instances = choice.map_err(|_| bad("instances", value, "auto|flat|two-level"))?;
            }
            Some(("top", value)) => {
                let row = VARIANTS.iter().find(|variant| variant.id == value);
                top = Some(row.ok_or_else(|| bad("top", value, "the id of a structure"))?);
            }
            _ => rest.push(part),
        }
    }
    Ok((instances, top, rest.join(",")))
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
    build_metered(spec, source, isa, &Meter::default())
}

/// [`build`], while a meter tells how much of it is done.
///
/// # Errors
/// As [`build`].
pub fn build_metered(
    spec: &AccelSpec,
    source: Arc<dyn TriangleSource>,
    isa: Isa,
    meter: &Meter,
) -> Result<Box<dyn Accel>, BuildError> {
    let level = isa.level().ok_or(BuildError::NoSuchIsa { isa: isa.name() })?;
    let placed = Placed::new(Arc::clone(&source));
    // With one placement numbers are what hits name already.
    let are_placed = placed.as_ref().is_some_and(|placed| placed.get().len() > 1);
    if let Some(placed) = placed {
        let copies = spec.instances.choose(&placed);
        if copies || placed.get().motions().is_some() {
            let defaults;
            let below = (spec.variant, &spec.options);
            let above = match spec.top {
                None => below,
                Some(row) => {
                    defaults = Options::defaults(row.options);
                    (row, &defaults)
                }
            };
            return TwoLevel::build((placed, copies), (below, above), (level, meter));
        }
    }
    BuildError::check_count(source.len())?;
    Steps::expect(meter, source.len());
    let (options, steps) = (&spec.options, &Steps::new(meter, source.len()));
    let input = BuildInput { source: Arc::clone(&source), options, level, steps };
    let accel = (spec.variant.build)(&input)?;
    Ok(if are_placed { Box::new(Located { accel, source }) } else { accel })
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
