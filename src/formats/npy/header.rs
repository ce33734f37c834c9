//! The header of a `.npy` file: magic bytes, version, length and a Python dictionary.

use std::io::{self, Read};

pub(super) const MAGIC: &[u8; 6] = b"\x93NUMPY";
/// No array of ours needs more than some 100 bytes; NumPy itself warns above 10,000.
const MAX_HEADER: usize = 1 << 16;

/// A version 1 header, padded so that the numbers start at a multiple of 64 bytes.
pub(super) fn header_bytes(descr: &str, shape: &str) -> Vec<u8> {
    let mut text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    while (10 + text.len() + 1) % 64 != 0 {
        text.push(' ');
    }
    text.push('\n');
    let length = (text.len() as u16).to_le_bytes();
    [&MAGIC[..], &[1, 0], &length, text.as_bytes()].concat()
}

/// The array's description and the bytes in front of it.
pub(super) struct Header {
    pub(super) array: Array,
    pub(super) bytes: u64,
}

pub(super) enum HeaderError {
    Io(io::Error),
    Problem(String),
}

impl From<io::Error> for HeaderError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Header {
    pub(super) fn read(input: &mut impl Read) -> Result<Self, HeaderError> {
        let problem = |text: &str| HeaderError::Problem(text.into());
        let mut start = [0; 8];
        input.read_exact(&mut start)?;
        if &start[..6] != MAGIC {
            return Err(problem("it does not start with the magic bytes \\x93NUMPY"));
        }
        let (length, before) = match start[6] {
            1 => {
                let mut length = [0; 2];
                input.read_exact(&mut length)?;
                (usize::from(u16::from_le_bytes(length)), 10)
            }
            2 | 3 => {
                let mut length = [0; 4];
                input.read_exact(&mut length)?;
                (u32::from_le_bytes(length) as usize, 12)
            }
            other => return Err(problem(&format!("version {other} is unknown"))),
        };
        if length > MAX_HEADER {
            return Err(problem(&format!("a header of {length} bytes is too long")));
        }
        let mut text = vec![0; length];
        input.read_exact(&mut text)?;
        let array = Array::parse(&text).map_err(|text| problem(&text))?;
        Ok(Self { array, bytes: before + length as u64 })
    }
}

/// What the header's dictionary says.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Array {
    pub(super) descr: String,
    pub(super) fortran_order: bool,
    pub(super) shape: Vec<u64>,
}

impl std::fmt::Display for Array {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let sizes: Vec<String> = self.shape.iter().map(u64::to_string).collect();
        let comma = if sizes.len() == 1 { "," } else { "" };
        let kind = match self.descr.as_bytes() {
            [b'<' | b'=' | b'|' | b'>', kind, bytes @ ..] => {
                let bits = str::from_utf8(bytes).ok().and_then(|text| text.parse::<u16>().ok());
                match (kind, bits.and_then(|bytes| bytes.checked_mul(8))) {
                    (b'f', Some(bits)) => format!("float{bits}"),
                    (b'i', Some(bits)) => format!("int{bits}"),
                    (b'u', Some(bits)) => format!("uint{bits}"),
                    _ => self.descr.clone(),
                }
            }
            _ => self.descr.clone(),
        };
        write!(f, "({}{comma}) of {kind}", sizes.join(", "))?;
        if self.descr.starts_with('>') {
            write!(f, ", big-endian")?;
        }
        if self.fortran_order {
            write!(f, ", in Fortran order")?;
        }
        Ok(())
    }
}

impl Array {
    /// Reads the dictionary literal; keys in any order, no others allowed.
    fn parse(text: &[u8]) -> Result<Self, String> {
        let text = str::from_utf8(text).map_err(|_| "its header is not text")?;
        let mut rest = Literal(text.trim_matches(|c| c == ' ' || c == '\n' || c == '\0'));
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        rest.expect('{')?;
        while !rest.take('}') {
            let key = rest.string()?;
            rest.expect(':')?;
            match key {
                "descr" => descr = Some(rest.string()?.to_owned()),
                "fortran_order" => fortran_order = Some(rest.boolean()?),
                "shape" => shape = Some(rest.shape()?),
                other => return Err(format!("its header has the unknown key '{other}'")),
            }
            if !rest.take(',') {
                rest.expect('}')?;
                break;
            }
        }
        if !rest.0.is_empty() {
            return Err(format!("after its header's dictionary stands '{}'", rest.start()));
        }
        let missing = |key: &str| format!("its header lacks '{key}'");
        Ok(Self {
            descr: descr.ok_or_else(|| missing("descr"))?,
            fortran_order: fortran_order.ok_or_else(|| missing("fortran_order"))?,
            shape: shape.ok_or_else(|| missing("shape"))?,
        })
    }
}

/// What is left of a Python literal.
struct Literal<'a>(&'a str);

impl<'a> Literal<'a> {
    /// A few characters of it, for messages.
    fn start(&self) -> String {
        self.0.trim_start().chars().take(20).collect()
    }

    fn take(&mut self, token: char) -> bool {
        let rest = self.0.trim_start().strip_prefix(token);
        self.0 = rest.unwrap_or(self.0);
        rest.is_some()
    }

    fn expect(&mut self, token: char) -> Result<(), String> {
        if self.take(token) {
            return Ok(());
        }
        Err(format!("its header has '{}' where '{token}' should stand", self.start()))
    }

    fn string(&mut self) -> Result<&'a str, String> {
        let quote = if self.take('"') { '"' } else { '\'' };
        if quote == '\'' && !self.take('\'') {
            let start = self.start();
            return Err(format!("its header has '{start}' where a string should stand"));
        }
        let (string, rest) =
            self.0.split_once(quote).ok_or("its header has a string without an end")?;
        self.0 = rest;
        Ok(string)
    }

    fn boolean(&mut self) -> Result<bool, String> {
        let text = self.0.trim_start();
        for (word, value) in [("True", true), ("False", false)] {
            if let Some(rest) = text.strip_prefix(word) {
                self.0 = rest;
                return Ok(value);
            }
        }
        Err(format!("its header has '{}' where True or False should stand", self.start()))
    }

    fn shape(&mut self) -> Result<Vec<u64>, String> {
        let mut sizes = Vec::new();
        self.expect('(')?;
        while !self.take(')') {
            let text = self.0.trim_start();
            let digits = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
            let size = text[..digits].parse();
            sizes.push(size.map_err(|_| format!("its shape has the size '{}'", self.start()))?);
            // Python 2 wrote long integers with an L.
            self.0 = text[digits..].strip_prefix('L').unwrap_or(&text[digits..]);
            if !self.take(',') {
                self.expect(')')?;
                break;
            }
        }
        Ok(sizes)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn keys_come_in_any_order_and_sizes_as_python_2_wrote_them() {
        let array = Array::parse(b"{\"shape\": (3L,), 'fortran_order':True,'descr':'|u1'}\n");
        let expected = Array { descr: "|u1".into(), fortran_order: true, shape: vec![3] };
        assert_eq!(array, Ok(expected));
    }

    #[test]
    fn what_is_wrong_is_quoted() {
        let problem = |text: &str| Array::parse(text.as_bytes()).expect_err("it is broken");
        assert_eq!(problem("{}"), "its header lacks 'descr'");
        assert_eq!(problem("{'shape': (-1,)}"), "its shape has the size '-1,)}'");
        assert_eq!(problem("{'a': 1}"), "its header has the unknown key 'a'");
        assert_eq!(
            problem("{'descr': [('x', '<f4')]}"),
            "its header has '[('x', '<f4')]}' where a string should stand"
        );
    }

    proptest! {
        #[test]
        fn no_header_makes_the_parser_panic(text in "[{}'a-z:,()0-9 <|\n]{0,60}") {
            let _ = Array::parse(text.as_bytes());
        }
    }
}
