//! The numbers of an image: one to four channels, each of 8, 16 or 32 bits, as its file has them.

use bytemuck::Pod;

/// The values of an image, texel by texel, row by row from the top. The channels are grey; grey
/// and alpha; red, green and blue; or these and alpha, which nothing is multiplied by.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// What nearly all files hold: 0 to 255 stand for 0 to 1.
    U8(Vec<u8>),
    /// 16-bit PNG and TIFF: 0 to 65535 stand for 0 to 1.
    U16(Vec<u16>),
    /// Linear colours: Radiance HDR, OpenEXR, float TIFF.
    F32(Vec<f32>),
}

/// How many bits a value has, and of what kind it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// An integer of 8 bits.
    U8,
    /// An integer of 16 bits.
    U16,
    /// A float of 32 bits.
    F32,
}

impl Depth {
    /// Bits of a value.
    pub fn bits(self) -> u32 {
        match self {
            Self::U8 => 8,
            Self::U16 => 16,
            Self::F32 => 32,
        }
    }

    /// So many values, all zero.
    pub fn zeros(self, count: usize) -> Texels {
        match self {
            Self::U8 => Texels::U8(vec![0; count]),
            Self::U16 => Texels::U16(vec![0; count]),
            Self::F32 => Texels::F32(vec![0.0; count]),
        }
    }
}

/// A number of an image.
pub trait Value: Pod + PartialEq + PartialOrd + Into<f32> {
    /// What stands for one.
    const ONE: Self;

    /// Numbers of this type as texels.
    fn wrap(values: Vec<Self>) -> Texels;

    /// The numbers of texels, if they are of this type.
    fn unwrap(texels: &Texels) -> Option<&[Self]>;

    /// The linear value. `table` has one for each integer; floats are linear.
    fn linear(self, table: &[f32]) -> f32;
}

impl Value for u8 {
    const ONE: Self = Self::MAX;

    fn wrap(values: Vec<Self>) -> Texels {
        Texels::U8(values)
    }

    fn unwrap(texels: &Texels) -> Option<&[Self]> {
        if let Texels::U8(values) = texels { Some(values) } else { None }
    }

    #[inline]
    fn linear(self, table: &[f32]) -> f32 {
        table[usize::from(self)]
    }
}

impl Value for u16 {
    const ONE: Self = Self::MAX;

    fn wrap(values: Vec<Self>) -> Texels {
        Texels::U16(values)
    }

    fn unwrap(texels: &Texels) -> Option<&[Self]> {
        if let Texels::U16(values) = texels { Some(values) } else { None }
    }

    #[inline]
    fn linear(self, table: &[f32]) -> f32 {
        table[usize::from(self)]
    }
}

impl Value for f32 {
    const ONE: Self = 1.0;

    fn wrap(values: Vec<Self>) -> Texels {
        Texels::F32(values)
    }

    fn unwrap(texels: &Texels) -> Option<&[Self]> {
        if let Texels::F32(values) = texels { Some(values) } else { None }
    }

    #[inline]
    fn linear(self, _: &[f32]) -> f32 {
        self
    }
}

impl Texels {
    /// How many values there are.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(values) => values.len(),
            Self::U16(values) => values.len(),
            Self::F32(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Of what kind the values are.
    #[inline]
    pub fn depth(&self) -> Depth {
        match self {
            Self::U8(_) => Depth::U8,
            Self::U16(_) => Depth::U16,
            Self::F32(_) => Depth::F32,
        }
    }

    /// The values' bytes.
    pub fn as_bytes(&self) -> &[u8] {
        match self {
            Self::U8(values) => values,
            Self::U16(values) => bytemuck::cast_slice(values),
            Self::F32(values) => bytemuck::cast_slice(values),
        }
    }

    /// The same, to be written.
    pub fn as_bytes_mut(&mut self) -> &mut [u8] {
        match self {
            Self::U8(values) => values,
            Self::U16(values) => bytemuck::cast_slice_mut(values),
            Self::F32(values) => bytemuck::cast_slice_mut(values),
        }
    }
}

/// Red, green, blue and alpha of a texel of one to four channels; alpha is one where it has none.
#[inline]
pub fn spread<T: Value>(texel: &[T]) -> [T; 4] {
    match *texel {
        [grey] => [grey, grey, grey, T::ONE],
        [grey, alpha] => [grey, grey, grey, alpha],
        [r, g, b] => [r, g, b, T::ONE],
        [r, g, b, a] => [r, g, b, a],
        _ => [T::zeroed(); 4],
    }
}
