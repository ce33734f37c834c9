//! Errors in a request for a structure.

/// Why a structure could not be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// Ids would not fit.
    #[error("{count} triangles are more than a flat structure can number ({limit})")]
    TooManyTriangles {
        /// Their number.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// The tree is deeper than the traversal's stack.
    #[error("the tree is {depth} levels deep and the traversal's stack holds {limit}")]
    TooDeep {
        /// Levels of the tree.
        depth: usize,
        /// Levels that fit.
        limit: usize,
    },
    /// It would take more memory than was allowed.
    #[error("the structure would take {needed} bytes, more than the {limit} that are allowed")]
    TooLarge {
        /// An estimate.
        needed: u64,
        /// The limit.
        limit: u64,
    },
    /// The system has not as much memory.
    #[error("the structure takes {needed} bytes, which the system does not have")]
    NoMemory {
        /// How many.
        needed: u64,
    },
    /// The instruction set asked for is not there.
    #[error("this CPU has no {isa}; leave --isa out to use the best that it has")]
    NoSuchIsa {
        /// Its name.
        isa: &'static str,
    },
}

impl BuildError {
    /// Whether ids can number so many triangles.
    pub(super) fn check_count(count: usize) -> Result<(), Self> {
        let limit = (u32::MAX - 1) as usize;
        if count > limit { Err(Self::TooManyTriangles { count, limit }) } else { Ok(()) }
    }
}

/// Why the text of a structure and its options was not understood.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SpecError {
    /// No such id.
    #[error("unknown acceleration structure '{id}'{}; `dapple accels` lists them", hint(.near))]
    UnknownId {
        /// What was asked for.
        id: String,
        /// Ids like it.
        near: Vec<&'static str>,
    },
    /// No such option.
    #[error("'{id}' has no option '{option}'{}", have(.known))]
    UnknownOption {
        /// The structure.
        id: &'static str,
        /// What was asked for.
        option: String,
        /// What there is.
        known: Vec<&'static str>,
    },
    /// A value out of range.
    #[error("option '{option}' of '{id}' is '{value}', expected {expected}")]
    BadValue {
        /// The structure.
        id: &'static str,
        /// The option.
        option: &'static str,
        /// What was given.
        value: String,
        /// What would do.
        expected: String,
    },
    /// Not of the form `name=value`.
    #[error("'{text}' is not of the form option=value")]
    NotAnOption {
        /// What was given.
        text: String,
    },
}

fn hint(near: &[&'static str]) -> String {
    match near {
        [] => String::new(),
        near => format!(", did you mean {}?", near.join(" or ")),
    }
}

fn have(known: &[&'static str]) -> String {
    match known {
        [] => "; it has, as all have, instances and top".to_owned(),
        known => format!("; it has {}, and, as all have, instances and top", known.join(", ")),
    }
}
