//! Tables of a TOML file, read so that every complaint comes with its line, and every key that
//! nothing asks for is a mistake.

use std::cell::RefCell;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::formats::LoadError;
use crate::names::near;

/// So many numbers, or else so many others.
type OneOf<const N: usize, const M: usize> = Result<[f64; N], [f64; M]>;

/// Three numbers, or else a table.
type PointOrTable<'d> = Result<[f64; 3], Table<'d>>;

/// The text of a file, and where its lines begin.
pub struct Source<'d> {
    path: &'d Path,
    /// Byte offsets of the lines after the first.
    breaks: Vec<usize>,
}

impl<'d> Source<'d> {
    /// A file's text; `path` is for messages.
    pub fn new(path: &'d Path, text: &str) -> Self {
        let newlines = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n');
        Self { path, breaks: newlines.map(|(at, _)| at + 1).collect() }
    }

    fn line(&self, offset: usize) -> usize {
        1 + self.breaks.partition_point(|&start| start <= offset)
    }

    /// What is wrong at a byte of the text.
    pub fn fault(&self, offset: usize, message: impl Into<String>) -> LoadError {
        LoadError::line(self.path, self.line(offset), message)
    }
}

/// A table, which takes note of what it is asked for.
pub struct Table<'d> {
    source: &'d Source<'d>,
    entries: &'d DeTable<'d>,
    /// As a message calls it: `[camera]`.
    name: String,
    /// Where it begins.
    offset: usize,
    asked: RefCell<Vec<&'d str>>,
}

impl<'d> Table<'d> {
    /// A table that begins at `offset`.
    pub fn new(
        source: &'d Source<'d>,
        entries: &'d DeTable<'d>,
        name: impl Into<String>,
        offset: usize,
    ) -> Self {
        Self { source, entries, name: name.into(), offset, asked: RefCell::new(Vec::new()) }
    }

    /// What is wrong with the table as a whole.
    pub fn fault(&self, message: impl std::fmt::Display) -> LoadError {
        self.source.fault(self.offset, format!("{}: {message}", self.name))
    }

    /// What is wrong with a value, or with the table where it has no such key.
    pub fn fault_at(&self, key: &str, message: impl std::fmt::Display) -> LoadError {
        match self.entries.get(key) {
            Some(value) => self.source.fault(value.span().start, format!("{key}: {message}")),
            None => self.fault(message),
        }
    }

    /// The file, and the line that it begins at.
    pub fn place(&self) -> String {
        format!("{}:{}", self.source.path.display(), self.line())
    }

    /// What is wrong in a line of the file.
    pub fn fault_on(&self, line: usize, message: impl Into<String>) -> LoadError {
        LoadError::line(self.source.path, line, message)
    }

    /// The line that it begins at.
    pub fn line(&self) -> usize {
        self.source.line(self.offset)
    }

    /// Whether a key is there.
    pub fn has(&self, key: &'d str) -> bool {
        self.value(key).is_some()
    }

    fn value(&self, key: &'d str) -> Option<&'d Spanned<DeValue<'d>>> {
        self.asked.borrow_mut().push(key);
        self.entries.get(key)
    }

    /// A key's value by what makes sense of it, which is otherwise not what was `expected`.
    fn read<T>(
        &self,
        key: &'d str,
        expected: &str,
        sense: impl Fn(&'d DeValue<'d>) -> Option<T>,
    ) -> Result<Option<T>, LoadError> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match sense(value.get_ref()) {
            Some(value) => Ok(Some(value)),
            None => Err(self.fault_at(key, format!("must be {expected}"))),
        }
    }

    /// A finite number.
    pub fn number(&self, key: &'d str) -> Result<Option<f64>, LoadError> {
        self.read(key, "a finite number", number)
    }

    /// A number, in a range.
    pub fn number_in(
        &self,
        key: &'d str,
        range: std::ops::RangeInclusive<f32>,
    ) -> Result<Option<f32>, LoadError> {
        let Some(value) = self.number(key)?.map(|value| value as f32) else { return Ok(None) };
        if !range.contains(&value) {
            let message = match (*range.start(), *range.end()) {
                (least, f32::MAX) => format!("must be {least} or more"),
                (least, most) => format!("must be from {least} to {most}"),
            };
            return Err(self.fault_at(key, message));
        }
        Ok(Some(value))
    }

    /// A number above zero.
    pub fn positive(&self, key: &'d str) -> Result<Option<f32>, LoadError> {
        match self.number_in(key, -f32::MAX..=f32::MAX)? {
            Some(value) if value <= 0.0 => Err(self.fault_at(key, "must be above 0")),
            value => Ok(value),
        }
    }

    /// As many finite numbers.
    pub fn numbers<const N: usize>(&self, key: &'d str) -> Result<Option<[f64; N]>, LoadError> {
        self.read(key, &format!("[…] of {N} finite numbers"), numbers)
    }

    /// Either so many finite numbers, or so many.
    pub fn one_of_numbers<const N: usize, const M: usize>(
        &self,
        key: &'d str,
    ) -> Result<Option<OneOf<N, M>>, LoadError> {
        self.read(key, &format!("[…] of {N} or {M} finite numbers"), |value| {
            numbers(value).map(Ok).or_else(|| numbers(value).map(Err))
        })
    }

    /// A number, or three.
    pub fn scale(&self, key: &'d str) -> Result<Option<[f64; 3]>, LoadError> {
        self.read(key, "a finite number, or […] of 3", |value| {
            number(value).map(|all| [all; 3]).or_else(|| numbers(value))
        })
    }

    /// Text.
    pub fn text(&self, key: &'d str) -> Result<Option<&'d str>, LoadError> {
        self.read(key, "text in quotes", |value| match value {
            DeValue::String(text) => Some(text.as_ref()),
            _ => None,
        })
    }

    /// Whether a value is text.
    pub fn is_text(&self, key: &'d str) -> bool {
        matches!(self.value(key).map(Spanned::get_ref), Some(DeValue::String(_)))
    }

    /// The values of an array, each three finite numbers or else a table.
    pub fn points_or_tables(&self, key: &'d str) -> Result<Vec<PointOrTable<'d>>, LoadError> {
        let Some(array) = self.read(key, "a file's name, or […]", as_array)? else {
            return Ok(Vec::new());
        };
        let one = |(number, value): (usize, &'d Spanned<DeValue<'d>>)| {
            if let Some(point) = numbers(value.get_ref()) {
                return Ok(Ok(point));
            }
            let (name, start) = (format!("{key} {number}"), value.span().start);
            let entries = as_table(value.get_ref()).ok_or_else(|| {
                let message = format!("{name}: must be […] of 3 finite numbers, or a table");
                self.source.fault(start, message)
            })?;
            Ok(Err(Self::new(self.source, entries, name, start)))
        };
        array.iter().enumerate().map(one).collect()
    }

    /// Text that must be there.
    pub fn required_text(&self, key: &'d str) -> Result<&'d str, LoadError> {
        self.text(key)?.ok_or_else(|| self.fault(format!("has no {key}")))
    }

    /// `true` or `false`.
    pub fn switch(&self, key: &'d str) -> Result<Option<bool>, LoadError> {
        self.read(key, "true or false", |value| match value {
            DeValue::Boolean(value) => Some(*value),
            _ => None,
        })
    }

    /// A table in it.
    pub fn table(&self, key: &'d str) -> Result<Option<Table<'d>>, LoadError> {
        let entries = self.read(key, "a table", as_table)?;
        Ok(entries.map(|entries| self.below(key, key.to_owned(), entries)))
    }

    /// The tables in an array of tables, or one alone.
    pub fn tables(&self, key: &'d str) -> Result<Vec<Table<'d>>, LoadError> {
        let Some(value) = self.value(key) else { return Ok(Vec::new()) };
        let named = |value: &'d Spanned<DeValue<'d>>, name: String| {
            let entries = as_table(value.get_ref())?;
            Some(Self::new(self.source, entries, name, value.span().start))
        };
        let all = match value.get_ref() {
            DeValue::Array(array) => {
                array.iter().map(|one| named(one, format!("[[{key}]]"))).collect()
            }
            _ => named(value, format!("[{key}]")).map(|table| vec![table]),
        };
        all.ok_or_else(|| self.fault_at(key, "must be a table, or several as [[…]]"))
    }

    /// All tables in it, by their keys.
    pub fn all_tables(&self) -> Result<Vec<(&'d str, Table<'d>)>, LoadError> {
        let table = |(key, value): (&'d Spanned<_>, &'d Spanned<DeValue<'d>>)| {
            let key: &'d std::borrow::Cow<'d, str> = key.get_ref();
            let key: &'d str = key.as_ref();
            match as_table(value.get_ref()) {
                Some(entries) => Ok((key, self.below(key, format!("{key:?}"), entries))),
                None => Err(self.fault_at(key, "must be a table")),
            }
        };
        self.entries.iter().map(table).collect()
    }

    fn below(&self, key: &str, shown: String, entries: &'d DeTable<'d>) -> Self {
        let offset = self.entries.get(key).map_or(self.offset, |value| value.span().start);
        let outer = self.name.trim_matches(['[', ']']);
        let name = if outer.is_empty() { shown } else { format!("{outer}.{shown}") };
        Self::new(self.source, entries, format!("[{name}]"), offset)
    }

    /// All keys and values, each with its line.
    pub fn entries(&self) -> impl Iterator<Item = (&'d str, usize, &'d DeValue<'d>)> {
        let source = self.source;
        self.entries.iter().map(move |(key, value)| {
            let key_text: &'d str = key.get_ref().as_ref();
            (key_text, source.line(key.span().start), value.get_ref())
        })
    }

    /// Refuses the first key that nothing has asked for.
    pub fn finish(&self) -> Result<(), LoadError> {
        let asked = self.asked.borrow();
        let unknown = self.entries.keys().filter(|key| !asked.contains(&key.get_ref().as_ref()));
        match unknown.min_by_key(|key| key.span().start) {
            None => Ok(()),
            Some(key) => {
                let message = unknown_key(&self.name, key.get_ref(), &asked);
                Err(self.source.fault(key.span().start, message))
            }
        }
    }
}

/// What to say of a key that is not one of those known.
pub fn unknown_key(table: &str, key: &str, known: &[&str]) -> String {
    let mut known = known.to_vec();
    known.sort_unstable();
    known.dedup();
    let near: Vec<&str> =
        near(key, known.iter().copied()).into_iter().map(|number| known[number]).collect();
    let advice = if near.is_empty() {
        format!("it may have {}", known.join(", "))
    } else {
        format!("did you mean {}?", near.join(", "))
    };
    let table = if table.is_empty() { String::new() } else { format!("{table}: ") };
    format!("{table}unknown key {key:?}; {advice}")
}

fn as_array<'d>(value: &'d DeValue<'d>) -> Option<&'d [Spanned<DeValue<'d>>]> {
    match value {
        DeValue::Array(array) => Some(array),
        _ => None,
    }
}

fn as_table<'d>(value: &'d DeValue<'d>) -> Option<&'d DeTable<'d>> {
    match value {
        DeValue::Table(table) => Some(table),
        _ => None,
    }
}

fn number(value: &DeValue) -> Option<f64> {
    let number = match value {
        DeValue::Integer(whole) => i64::from_str_radix(whole.as_str(), whole.radix()).ok()? as f64,
        DeValue::Float(float) => float.as_str().parse().ok()?,
        _ => return None,
    };
    // What is beyond an f32 is of no use to anybody.
    (number as f32).is_finite().then_some(number)
}

fn numbers<const N: usize>(value: &DeValue) -> Option<[f64; N]> {
    let DeValue::Array(array) = value else { return None };
    if array.len() != N {
        return None;
    }
    let all: Option<Vec<f64>> = array.iter().map(|value| number(value.get_ref())).collect();
    all?.try_into().ok()
}
