//! Options of structures: what they may be, and what was chosen.

use std::fmt;

use super::SpecError;
use crate::names::parse_bytes;

/// An option that a structure has.
#[derive(Clone, Copy, Debug)]
pub struct OptionSpec {
    /// As written before `=`.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// What it may be.
    pub values: Values,
    /// What it is unless said.
    pub default: Value,
}

/// The values that an option may take.
#[derive(Clone, Copy, Debug)]
pub enum Values {
    /// One of some words.
    Choice(&'static [&'static str]),
    /// A whole number, both ends included.
    Integer(u64, u64),
    /// A number, both ends included.
    Number(f64, f64),
    /// A size in bytes, at least; units are those of `parse_bytes`.
    Bytes(u64),
}

/// The value of an option.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A word.
    Choice(&'static str),
    /// A whole number.
    Integer(u64),
    /// A number.
    Number(f64),
    /// Bytes.
    Bytes(u64),
}

impl Values {
    fn parse(self, text: &str) -> Option<Value> {
        match self {
            Self::Choice(words) => {
                words.iter().find(|&&word| word == text).map(|w| Value::Choice(w))
            }
            Self::Integer(low, high) => {
                text.parse().ok().filter(|n| (low..=high).contains(n)).map(Value::Integer)
            }
            Self::Number(low, high) => {
                text.parse().ok().filter(|n| (low..=high).contains(n)).map(Value::Number)
            }
            Self::Bytes(low) => parse_bytes(text).filter(|&n| n >= low).map(Value::Bytes),
        }
    }
}

impl fmt::Display for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Choice(words) => f.write_str(&words.join("|")),
            Self::Integer(low, high) => write!(f, "a whole number from {low} to {high}"),
            Self::Number(low, high) => write!(f, "a number from {low} to {high}"),
            Self::Bytes(low) => write!(f, "a size of at least {low} bytes, for instance 100MB"),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Choice(word) => f.write_str(word),
            Self::Integer(n) | Self::Bytes(n) => write!(f, "{n}"),
            Self::Number(n) => write!(f, "{n}"),
        }
    }
}

/// The options of a structure, each with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    values: Vec<(&'static str, Value)>,
}

impl Options {
    /// All at their defaults.
    pub fn defaults(specs: &'static [OptionSpec]) -> Self {
        Self { values: specs.iter().map(|spec| (spec.name, spec.default)).collect() }
    }

    /// Reads `name=value,name=value`; `id` is for messages.
    pub fn parse(
        id: &'static str,
        specs: &'static [OptionSpec],
        text: &str,
    ) -> Result<Self, SpecError> {
        let mut options = Self::defaults(specs);
        for part in text.split(',').filter(|part| !part.is_empty()) {
            let (name, value) = part
                .split_once('=')
                .ok_or_else(|| SpecError::NotAnOption { text: part.to_owned() })?;
            let at = specs.iter().position(|spec| spec.name == name).ok_or_else(|| {
                SpecError::UnknownOption {
                    id,
                    option: name.to_owned(),
                    known: specs.iter().map(|spec| spec.name).collect(),
                }
            })?;
            options.values[at].1 =
                specs[at].values.parse(value).ok_or_else(|| SpecError::BadValue {
                    id,
                    option: specs[at].name,
                    value: value.to_owned(),
                    expected: specs[at].values.to_string(),
                })?;
        }
        Ok(options)
    }

    fn value(&self, name: &str) -> Value {
        let found = self.values.iter().find(|(known, _)| *known == name);
        found.expect("the structure's row declares the option").1
    }

    /// The word chosen for an option that the structure's row declares as a choice.
    pub fn choice(&self, name: &str) -> &'static str {
        match self.value(name) {
            Value::Choice(word) => word,
            other => panic!("option {name} is declared as {other:?}"),
        }
    }

    /// The value of an option that is declared as a whole number or as bytes.
    pub fn integer(&self, name: &str) -> u64 {
        match self.value(name) {
            Value::Integer(n) | Value::Bytes(n) => n,
            other => panic!("option {name} is declared as {other:?}"),
        }
    }

    /// The value of an option that is declared as a number.
    pub fn number(&self, name: &str) -> f64 {
        match self.value(name) {
            Value::Number(n) => n,
            other => panic!("option {name} is declared as {other:?}"),
        }
    }

    /// The value of an option that is declared as a size.
    pub fn bytes(&self, name: &str) -> u64 {
        match self.value(name) {
            Value::Bytes(n) => n,
            other => panic!("option {name} is declared as {other:?}"),
        }
    }

    /// Names and values in the order of the structure's row.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, Value)> + '_ {
        self.values.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPECS: &[OptionSpec] = &[
        OptionSpec {
            name: "build",
            summary: "how",
            values: Values::Choice(&["binned", "sweep"]),
            default: Value::Choice("binned"),
        },
        OptionSpec {
            name: "cache",
            summary: "how much",
            values: Values::Bytes(64),
            default: Value::Bytes(64),
        },
    ];

    #[test]
    fn options_are_read_and_ranges_held() {
        let options = Options::parse("x", SPECS, "cache=2MB,build=sweep").expect("both are known");
        assert_eq!(options.choice("build"), "sweep");
        assert_eq!(options.integer("cache"), 2_000_000);
        for bad in ["cache=63", "build=fast", "depth=1", "build"] {
            assert!(Options::parse("x", SPECS, bad).is_err(), "{bad}");
        }
        assert_eq!(Options::parse("x", SPECS, ""), Ok(Options::defaults(SPECS)));
    }
}
