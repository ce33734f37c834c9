//! Elements of accessors: how numbers are stored, and how many make one (glTF 2.0, 3.6.2).

/// How one number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Component {
    /// Signed byte.
    I8,
    /// Byte.
    U8,
    /// Signed, two bytes.
    I16,
    /// Two bytes.
    U16,
    /// Four bytes.
    U32,
    /// IEEE 754 binary32.
    F32,
}

impl Component {
    /// The one that a document means by `code`.
    pub fn of(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// Bytes per number.
    pub fn size(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// How many numbers make an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One.
    Scalar,
    /// Two to four.
    Vector(u64),
    /// A square matrix of two to four columns, each aligned to four bytes.
    Matrix(u64),
}

impl Shape {
    /// The one that a document means by `name`.
    pub fn of(name: &str) -> Option<Self> {
        Some(match name {
            "SCALAR" => Self::Scalar,
            "VEC2" => Self::Vector(2),
            "VEC3" => Self::Vector(3),
            "VEC4" => Self::Vector(4),
            "MAT2" => Self::Matrix(2),
            "MAT3" => Self::Matrix(3),
            "MAT4" => Self::Matrix(4),
            _ => return None,
        })
    }

    /// Bytes per element, without those after it.
    pub fn size(self, component: Component) -> u64 {
        match self {
            Self::Scalar => component.size(),
            Self::Vector(count) => count * component.size(),
            Self::Matrix(columns) => {
                let column = columns * component.size();
                (columns - 1) * column.next_multiple_of(4) + column
            }
        }
    }

    /// Bytes from one element to the next where they are packed tightly.
    pub fn packed_stride(self, component: Component) -> u64 {
        match self {
            Self::Scalar | Self::Vector(_) => self.size(component),
            Self::Matrix(_) => self.size(component).next_multiple_of(4),
        }
    }
}
