//! Elements of an accessor one by one, from where they lie.

/// Vectors of `N` numbers, decoded when they are asked for: millions of copies take no memory
/// beside the buffer's.
#[derive(Debug)]
pub enum Rows<'s, const N: usize> {
    /// All alike.
    Constant([f32; N]),
    /// In a buffer view.
    Stored(Stored<'s>),
    /// Put together beforehand, as sparse ones are.
    Decoded(Vec<[f32; N]>),
}

/// Elements in a buffer view.
#[derive(Debug)]
pub struct Stored<'s> {
    /// From the first element on.
    pub bytes: &'s [u8],
    /// From one element to the next.
    pub stride: usize,
    /// Bytes of a number.
    pub size: usize,
    /// Of a number's bytes its value.
    pub decode: fn(&[u8]) -> f32,
}

impl<const N: usize> Rows<'_, N> {
    /// An element that the accessor has.
    pub fn get(&self, index: usize) -> [f32; N] {
        match self {
            Self::Constant(row) => *row,
            Self::Decoded(rows) => rows[index],
            Self::Stored(stored) => {
                let bytes = &stored.bytes[index * stored.stride..];
                std::array::from_fn(|i| {
                    (stored.decode)(&bytes[i * stored.size..(i + 1) * stored.size])
                })
            }
        }
    }
}
