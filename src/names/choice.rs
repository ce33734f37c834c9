//! Enums whose variants users choose by name.

use std::fmt;

use super::near::near;

/// A name that none of the choices has. Its message lists them, and the near ones first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownName {
    /// What was to be chosen: `filter`, `sampler`.
    what: &'static str,
    /// What was written.
    name: String,
    /// All names.
    known: Vec<&'static str>,
}

impl UnknownName {
    /// An error for `name`, where `what` is to be one of `known`.
    pub fn new(what: &'static str, name: &str, known: &[&'static str]) -> Self {
        Self { what, name: name.to_owned(), known: known.to_vec() }
    }
}

impl fmt::Display for UnknownName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, name, known } = self;
        write!(f, "no {what} `{name}`; ")?;
        let near: Vec<&str> =
            near(name, known.iter().copied()).into_iter().map(|number| known[number]).collect();
        if !near.is_empty() {
            write!(f, "did you mean {}? ", near.join(" or "))?;
        }
        let there_are = if near.is_empty() { "there are" } else { "There are" };
        match &known[..] {
            [first @ .., last] if !first.is_empty() => {
                write!(f, "{there_are} {} and {last}", first.join(", "))
            }
            one => write!(f, "{there_are} {}", one.join("")),
        }
    }
}

impl std::error::Error for UnknownName {}

/// Gives an enum without fields the names of its variants: `ALL`, `name`, `Display` and `FromStr`,
/// whose error is [`UnknownName`]. The order is that of help and documentation.
macro_rules! choices {
    ($type:ident, $what:literal, [$($variant:ident => $name:literal),+ $(,)?]) => {
        impl $type {
            /// All of them, in the order of the documentation.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$variant),+];

            /// The name by which users choose it.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::names::UnknownName;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                let found = Self::ALL.into_iter().find(|choice| choice.name() == name);
                found.ok_or_else(|| $crate::names::UnknownName::new($what, name, &[$($name),+]))
            }
        }
    };
}

pub(crate) use choices;

#[cfg(test)]
mod tests {
    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Tree {
        Beech,
        Maple,
        Larch,
    }

    choices!(Tree, "tree", [Beech => "beech", Maple => "field-maple", Larch => "larch"]);

    #[test]
    fn names_are_read_back() {
        for tree in Tree::ALL {
            assert_eq!(tree.to_string().parse(), Ok(tree));
        }
    }

    #[test]
    fn who_slips_is_told_all_names_and_the_near_ones_first() {
        let error = |name: &str| name.parse::<Tree>().expect_err("there is none").to_string();
        let all = "There are beech, field-maple and larch";
        assert_eq!(error("larhc"), format!("no tree `larhc`; did you mean larch? {all}"));
        assert_eq!(error("oak"), "no tree `oak`; there are beech, field-maple and larch");
    }
}
