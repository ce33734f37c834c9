//! The header of a PLY file: which elements follow, and how each is stored.

use std::collections::HashSet;
use std::path::Path;

use crate::formats::LoadError;

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Decimal, between spaces.
    Ascii,
    /// Binary, the lowest byte first.
    Little,
    /// Binary, the highest byte first.
    Big,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// By either of the names in use.
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes in a binary file.
    pub fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The smallest and the largest whole number of the type; none for those with fractions.
    pub fn range(self) -> Option<(f64, f64)> {
        Some(match self {
            Self::I8 => (-128.0, 127.0),
            Self::U8 => (0.0, 255.0),
            Self::I16 => (-32768.0, 32767.0),
            Self::U16 => (0.0, 65535.0),
            Self::I32 => (-2147483648.0, 2147483647.0),
            Self::U32 => (0.0, 4294967295.0),
            Self::F32 | Self::F64 => return None,
        })
    }
}

/// What a property holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// One number.
    One(Scalar),
    /// A number of numbers: the type of that number and theirs.
    List(Scalar, Scalar),
}

/// A column of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

/// A table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub name: String,
    /// Rows.
    pub count: u64,
    pub properties: Vec<Property>,
}

/// All that the header tells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Pictures that comments name, as MeshLab writes them, and their lines.
    pub textures: Vec<(String, usize)>,
    /// Bytes up to the first element.
    pub length: usize,
    /// Lines up to there.
    pub lines: usize,
}

/// More than any program writes; each row has to look at all of them.
const MAX_PROPERTIES: usize = 1000;

/// Whether a file says that it is PLY.
pub fn is_ply(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

/// Reads a header.
///
/// # Errors
/// [`LoadError::Line`] at the first line that is wrong.
pub(super) fn read(bytes: &[u8], file: &Path) -> Result<Header, LoadError> {
    if !is_ply(bytes) {
        return Err(LoadError::line(
            file,
            1,
            "is no PLY file: it does not begin with a line `ply`",
        ));
    }
    // Lines end in \n, \r\n, or on very old machines in \r.
    let end = if bytes[3] == b'\r' && bytes.get(4) != Some(&b'\n') { b'\r' } else { b'\n' };
    let mut builder = Builder::default();
    let (mut at, mut number) = (0, 0);
    loop {
        let Some(length) = bytes[at..].iter().position(|&byte| byte == end) else {
            return Err(LoadError::line(file, number + 1, "the header has no line `end_header`"));
        };
        let line = String::from_utf8_lossy(&bytes[at..at + length]);
        (at, number) = (at + length + 1, number + 1);
        let done = builder
            .line(line.trim(), number)
            .map_err(|message| LoadError::line(file, number, message))?;
        if done {
            break;
        }
    }
    let Builder { encoding, elements, textures, .. } = builder;
    let encoding =
        encoding.ok_or_else(|| LoadError::line(file, number, "the header has no line `format`"))?;
    Ok(Header { encoding, elements, textures, length: at, lines: number })
}

#[derive(Default)]
struct Builder {
    encoding: Option<Encoding>,
    elements: Vec<Element>,
    textures: Vec<(String, usize)>,
    /// Names of elements, and of the properties of the last.
    known: [HashSet<String>; 2],
}

impl Builder {
    /// Takes a line; whether it is the last.
    fn line(&mut self, line: &str, number: usize) -> Result<bool, String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["ply"] if number == 1 => {}
            ["format", name, "1.0"] => self.encoding = Some(encoding(name)?),
            ["format", _, version] => {
                return Err(format!("version {version} of PLY is unknown, only 1.0"));
            }
            ["comment", "TextureFile", ..] => {
                let name = line.split_once("TextureFile").map_or("", |(_, name)| name.trim());
                self.textures.push((name.to_owned(), number));
            }
            [] | ["comment" | "obj_info", ..] => {}
            ["element", name, count] => self.element(name, count)?,
            ["property", "list", count, item, name] => {
                let count = scalar(count)?;
                if count.range().is_none() {
                    return Err("a list's length must be a whole number".to_owned());
                }
                self.property(name, Kind::List(count, scalar(item)?))?;
            }
            ["property", kind, name] => self.property(name, Kind::One(scalar(kind)?))?,
            ["end_header"] => return Ok(true),
            _ => {
                let start: String = line.chars().take(40).collect();
                return Err(format!("'{}' is no line of a PLY header", start.escape_debug()));
            }
        }
        Ok(false)
    }

    fn element(&mut self, name: &str, count: &str) -> Result<(), String> {
        let count = count.parse().map_err(|_| format!("'{count}' is not a number of elements"))?;
        if !self.known[0].insert(name.to_owned()) {
            return Err(format!("element {name} is declared twice"));
        }
        self.known[1].clear();
        self.elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
        Ok(())
    }

    fn property(&mut self, name: &str, kind: Kind) -> Result<(), String> {
        let element = self.elements.last_mut().ok_or("a property before any element")?;
        if !self.known[1].insert(name.to_owned()) {
            return Err(format!("property {name} is declared twice"));
        }
        if element.properties.len() == MAX_PROPERTIES {
            return Err(format!("an element has more than {MAX_PROPERTIES} properties"));
        }
        element.properties.push(Property { name: name.to_owned(), kind });
        Ok(())
    }
}

fn encoding(name: &str) -> Result<Encoding, String> {
    Ok(match name {
        "ascii" => Encoding::Ascii,
        "binary_little_endian" => Encoding::Little,
        "binary_big_endian" => Encoding::Big,
        other => return Err(format!("'{other}' is no format of PLY")),
    })
}

fn scalar(name: &str) -> Result<Scalar, String> {
    Scalar::of(name).ok_or_else(|| format!("'{name}' is no type of PLY"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(text: &str) -> Result<Header, String> {
        read(text.as_bytes(), Path::new("a.ply")).map_err(|error| error.to_string())
    }

    #[test]
    fn lines_may_end_in_any_way() {
        for end in ["\n", "\r\n", "\r"] {
            let lines = [
                "ply",
                "format binary_big_endian 1.0",
                "comment TextureFile my skin.png",
                "element vertex 7",
                "property float x",
                "property list uchar int32 y",
                "end_header",
                "",
            ];
            let text = lines.join(end);
            let header = header(&text).expect("valid");
            assert_eq!((header.encoding, header.lines), (Encoding::Big, 7));
            assert_eq!(header.length, text.len());
            assert_eq!(header.textures, [("my skin.png".to_owned(), 3)]);
            let [vertex] = &header.elements[..] else { panic!("one element") };
            assert_eq!((vertex.name.as_str(), vertex.count), ("vertex", 7));
            assert_eq!(vertex.properties[0].kind, Kind::One(Scalar::F32));
            assert_eq!(vertex.properties[1].kind, Kind::List(Scalar::U8, Scalar::I32));
        }
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (lines, message) in [
            ("plx\n", "a.ply:1: is no PLY file: it does not begin with a line `ply`"),
            ("ply\nend_header\n", "a.ply:2: the header has no line `format`"),
            ("ply\nformat ascii 1.0\n", "a.ply:3: the header has no line `end_header`"),
            ("ply\nformat ascii 2.0\n", "a.ply:2: version 2.0 of PLY is unknown, only 1.0"),
            ("ply\nformat morse 1.0\n", "a.ply:2: 'morse' is no format of PLY"),
            ("ply\nproperty int x\n", "a.ply:2: a property before any element"),
            ("ply\nelement a -1\n", "a.ply:2: '-1' is not a number of elements"),
            ("ply\nelement a 1\nelement a 1\n", "a.ply:3: element a is declared twice"),
            ("ply\nelement a 1\nproperty half x\n", "a.ply:3: 'half' is no type of PLY"),
            (
                "ply\nelement a 1\nproperty int x\nproperty int x\n",
                "a.ply:4: property x is declared twice",
            ),
            (
                "ply\nelement a 1\nproperty list float int x\n",
                "a.ply:3: a list's length must be a whole number",
            ),
            ("ply\nvertices 3\n", "a.ply:2: 'vertices 3' is no line of a PLY header"),
        ] {
            assert_eq!(header(lines).expect_err(lines), message);
        }
        let many: Vec<_> = (0..1001).map(|i| format!("property int p{i}\n")).collect();
        let many = many.concat();
        assert!(header(&format!("ply\nelement a 1\n{many}")).expect_err("many").contains("1000"));
    }
}
