//! The numbers after the header, one after the other, in either encoding.

use std::path::Path;

use super::header::{Element, Kind, Scalar};
use crate::files::{Front, Meter};
use crate::formats::LoadError;

/// A number that is not there, or is none: what to say of it.
pub(super) type Problem = String;

/// A file's numbers, in their order.
pub(super) trait Values {
    /// The next one, which is of type `kind`.
    fn number(&mut self, kind: Scalar) -> Result<f64, Problem>;

    /// Passes over the next `count` of type `kind`.
    fn skip(&mut self, kind: Scalar, count: u64) -> Result<(), Problem>;

    /// Ends a row of an element. Where each row has a line of its own, what is left of the line is
    /// passed over.
    fn end_row(&mut self);

    /// How many rows had more numbers than their properties, and the line of the first.
    fn excess(&self) -> Option<(u64, usize)>;

    /// The fewest bytes that a number of type `kind` takes.
    fn least_bytes(&self, kind: Scalar) -> u64;

    /// Bytes that follow.
    fn remaining_bytes(&self) -> u64;

    /// Whether anything but white space follows.
    fn has_more(&self) -> bool;

    /// What is wrong with row `row` of an element, and where that is.
    fn error(&self, file: &Path, element: &str, row: u64, problem: &str) -> LoadError;
}

/// How many numbers a list has.
pub(super) fn list_length(values: &mut impl Values, kind: Scalar) -> Result<u64, Problem> {
    let length = values.number(kind)?;
    if length < 0.0 { Err(format!("a list's length is {length}")) } else { Ok(length as u64) }
}

/// Passes over a property.
pub(super) fn skip(values: &mut impl Values, kind: Kind) -> Result<(), Problem> {
    match kind {
        Kind::One(kind) => values.skip(kind, 1),
        Kind::List(count, item) => {
            let length = list_length(values, count)?;
            values.skip(item, length)
        }
    }
}

/// Passes over an element.
pub(super) fn skip_rows(
    values: &mut impl Values,
    element: &Element,
    file: &Path,
) -> Result<(), LoadError> {
    // Without properties they take no room, however many there are.
    let rows = if element.properties.is_empty() { 0 } else { element.count };
    for row in 0..rows {
        let mut kinds = element.properties.iter().map(|property| property.kind);
        kinds
            .try_for_each(|kind| skip(values, kind))
            .map_err(|problem| values.error(file, &element.name, row, &problem))?;
        values.end_row();
    }
    Ok(())
}

/// How many rows there can be at most of those that an element declares, if their lists have at
/// least `items` numbers: what follows in the file limits them. No more memory than that is set
/// aside.
pub(super) fn possible_rows(values: &impl Values, element: &Element, items: u64) -> usize {
    let least = element.properties.iter().map(|property| match property.kind {
        Kind::One(kind) => values.least_bytes(kind),
        Kind::List(count, item) => values.least_bytes(count) + items * values.least_bytes(item),
    });
    let row: u64 = least.sum();
    element.count.min(values.remaining_bytes() / row.max(1)) as usize
}

/// Decimal numbers between white space.
///
/// Rows have lines of their own, by the format; readers that count numbers alone have let files
/// come about that do otherwise. Only where there are as many lines as rows do lines tell where
/// rows end. So a face with a number too many does not shift all faces after it.
pub(super) struct Ascii<'a> {
    bytes: &'a [u8],
    line: usize,
    /// Whether lines tell where rows end.
    by_lines: bool,
    /// Whether a row has begun.
    in_row: bool,
    /// Rows with more numbers than properties, and the line of the first.
    excess: Option<(u64, usize)>,
    front: Option<Front<'a>>,
}

impl<'a> Ascii<'a> {
    /// What follows the header's `lines`; it declares so many `rows` in all.
    pub fn new(bytes: &'a [u8], lines: usize, rows: u64) -> Self {
        let filled =
            bytes.split(|&byte| byte == b'\n').filter(|line| !line.trim_ascii().is_empty());
        let by_lines = filled.count() as u64 == rows;
        let line = lines + 1;
        Self { bytes, line, by_lines, in_row: false, excess: None, front: None }
    }

    /// The same; a meter is told how far it is.
    pub fn metered(self, meter: &'a Meter) -> Self {
        Self { front: Some(Front::new(meter, self.bytes.len() as u64)), ..self }
    }

    fn word(&mut self) -> Result<&'a [u8], Problem> {
        let blank = self.bytes.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let (before, rest) = self.bytes.split_at(blank);
        if self.by_lines && self.in_row && !rest.is_empty() && before.contains(&b'\n') {
            return Err(LINE_ENDS.to_owned());
        }
        before.iter().filter(|&&byte| byte == b'\n').for_each(|_| self.line += 1);
        let length = rest.iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        let (word, rest) = rest.split_at(length);
        self.bytes = rest;
        self.in_row = true;
        if word.is_empty() { Err(ENDS.to_owned()) } else { Ok(word) }
    }
}

const ENDS: &str = "the file ends before it does";
const LINE_ENDS: &str = "the line ends before it does";

impl Values for Ascii<'_> {
    fn number(&mut self, kind: Scalar) -> Result<f64, Problem> {
        let word = self.word()?;
        let number = str::from_utf8(word).ok().and_then(|word| word.parse::<f64>().ok());
        let fits = |number: &f64| {
            kind.range()
                .is_none_or(|(low, high)| number.fract() == 0.0 && (low..=high).contains(number))
        };
        number.filter(fits).ok_or_else(|| {
            let word = String::from_utf8_lossy(&word[..word.len().min(30)]);
            let what = if number.is_some() { "of its type" } else { "at all" };
            format!("'{}' is no number {what}", word.escape_debug())
        })
    }

    fn skip(&mut self, _: Scalar, count: u64) -> Result<(), Problem> {
        (0..count).try_for_each(|_| self.word().map(|_| ()))
    }

    fn end_row(&mut self) {
        self.in_row = false;
        if let Some(front) = &mut self.front {
            front.move_to(self.bytes.len() as u64);
        }
        if !self.by_lines {
            return;
        }
        let end = self.bytes.iter().position(|&byte| byte == b'\n').unwrap_or(self.bytes.len());
        let (rest, after) = self.bytes.split_at(end);
        if !rest.trim_ascii().is_empty() {
            self.excess.get_or_insert((0, self.line)).0 += 1;
        }
        self.bytes = after;
    }

    fn excess(&self) -> Option<(u64, usize)> {
        self.excess
    }

    fn least_bytes(&self, _: Scalar) -> u64 {
        2 // a digit and a space
    }

    fn remaining_bytes(&self) -> u64 {
        self.bytes.len() as u64 + 1 // nothing need follow the last
    }

    fn has_more(&self) -> bool {
        !self.bytes.trim_ascii().is_empty()
    }

    fn error(&self, file: &Path, element: &str, row: u64, problem: &str) -> LoadError {
        LoadError::line(file, self.line, format!("{element} {row}: {problem}"))
    }
}

/// Numbers of fixed size, without anything between them.
pub(super) struct Binary<'a> {
    bytes: &'a [u8],
    big_endian: bool,
    front: Option<Front<'a>>,
}

impl<'a> Binary<'a> {
    /// What follows the header.
    pub fn new(bytes: &'a [u8], big_endian: bool) -> Self {
        Self { bytes, big_endian, front: None }
    }

    /// The same; a meter is told how far it is.
    pub fn metered(self, meter: &'a Meter) -> Self {
        Self { front: Some(Front::new(meter, self.bytes.len() as u64)), ..self }
    }

    /// The next bytes, the lowest first.
    #[inline]
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Problem> {
        let (bytes, rest) = self.bytes.split_first_chunk::<N>().ok_or_else(|| ENDS.to_owned())?;
        self.bytes = rest;
        let mut bytes = *bytes;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl Values for Binary<'_> {
    #[inline]
    fn number(&mut self, kind: Scalar) -> Result<f64, Problem> {
        Ok(match kind {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn skip(&mut self, kind: Scalar, count: u64) -> Result<(), Problem> {
        let length = kind.size().checked_mul(count).and_then(|bytes| usize::try_from(bytes).ok());
        let rest = length.and_then(|length| self.bytes.get(length..));
        self.bytes = rest.ok_or_else(|| ENDS.to_owned())?;
        Ok(())
    }

    #[inline]
    fn end_row(&mut self) {
        if let Some(front) = &mut self.front {
            front.move_to(self.bytes.len() as u64);
        }
    }

    fn excess(&self) -> Option<(u64, usize)> {
        None
    }

    fn least_bytes(&self, kind: Scalar) -> u64 {
        kind.size()
    }

    fn remaining_bytes(&self) -> u64 {
        self.bytes.len() as u64
    }

    fn has_more(&self) -> bool {
        !self.bytes.is_empty()
    }

    fn error(&self, file: &Path, element: &str, row: u64, problem: &str) -> LoadError {
        LoadError::invalid(file, format!("{element} {row}"), problem)
    }
}

#[cfg(test)]
mod tests {
    use super::super::header::Property;
    use super::*;

    const ALL: [Scalar; 8] = [
        Scalar::I8,
        Scalar::U8,
        Scalar::I16,
        Scalar::U16,
        Scalar::I32,
        Scalar::U32,
        Scalar::F32,
        Scalar::F64,
    ];

    #[test]
    fn all_types_in_all_encodings() {
        let mut bytes = vec![0xff, 0xff];
        bytes.extend((-2_i16).to_le_bytes());
        bytes.extend(65534_u16.to_le_bytes());
        bytes.extend((-3_i32).to_le_bytes());
        bytes.extend(4294967293_u32.to_le_bytes());
        bytes.extend(0.5_f32.to_le_bytes());
        bytes.extend(1e300_f64.to_le_bytes());
        let expected = [-1.0, 255.0, -2.0, 65534.0, -3.0, 4294967293.0, 0.5, 1e300];
        let read = |values: &mut dyn FnMut(Scalar) -> f64| ALL.map(values);
        let mut little = Binary::new(&bytes, false);
        assert_eq!(read(&mut |kind| little.number(kind).expect("is there")), expected);
        assert!(little.number(Scalar::U8).is_err() && !little.has_more());

        // Each number's bytes turned round.
        let mut rest = &bytes[..];
        let mut turned = Vec::new();
        for kind in ALL {
            let (number, after) = rest.split_at(kind.size() as usize);
            turned.extend(number.iter().rev());
            rest = after;
        }
        let mut big = Binary::new(&turned, true);
        assert_eq!(read(&mut |kind| big.number(kind).expect("is there")), expected);

        let text = b" -1 255\r\n-2 65534\t-3 4294967293 .5 1e300 \n";
        let mut ascii = Ascii::new(text, 0, 0);
        assert_eq!(read(&mut |kind| ascii.number(kind).expect("is there")), expected);
        assert!(ascii.number(Scalar::U8).is_err() && !ascii.has_more());
    }

    #[test]
    fn what_is_no_number_is_quoted() {
        let problem = |text: &'static str, kind| {
            Ascii::new(text.as_bytes(), 0, 0).number(kind).expect_err(text)
        };
        assert_eq!(problem("x1", Scalar::F32), "'x1' is no number at all");
        assert_eq!(problem("256", Scalar::U8), "'256' is no number of its type");
        assert_eq!(problem("1.5", Scalar::I32), "'1.5' is no number of its type");
        assert_eq!(problem("nan", Scalar::I32), "'nan' is no number of its type");
        assert_eq!(problem("", Scalar::I32), ENDS);
    }

    #[test]
    fn rows_are_no_more_than_the_file_can_hold() {
        let property = |kind| Property { name: String::new(), kind };
        let properties =
            vec![property(Kind::One(Scalar::F32)), property(Kind::List(Scalar::U8, Scalar::I32))];
        let element =
            |count| Element { name: String::new(), count, properties: properties.clone() };
        let values = Binary::new(&[0; 170], false);
        assert_eq!(possible_rows(&values, &element(u64::MAX), 3), 10);
        assert_eq!(possible_rows(&values, &element(u64::MAX), 0), 34);
        assert_eq!(possible_rows(&values, &element(7), 3), 7);
        assert_eq!(possible_rows(&Ascii::new(b"1 3 0 1 2", 0, 0), &element(u64::MAX), 3), 1);
    }

    #[test]
    fn no_list_is_longer_than_the_file() {
        let mut bytes = u32::MAX.to_le_bytes().to_vec();
        bytes.push(0);
        let list = Kind::List(Scalar::U32, Scalar::F64);
        assert_eq!(skip(&mut Binary::new(&bytes, false), list), Err(ENDS.to_owned()));
        assert_eq!(skip(&mut Ascii::new(b"4000000000 1 2", 0, 0), list), Err(ENDS.to_owned()));
        let minus = Kind::List(Scalar::I8, Scalar::U8);
        assert!(skip(&mut Ascii::new(b"-1", 0, 0), minus).is_err());
    }
}
