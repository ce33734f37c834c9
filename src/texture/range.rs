//! Images of floats can hold what no surface can do: reflect more than it gets, or less than none.

use super::image::Image;
use super::store::TextureStore;
use super::texels::{Depth, Texels};
use super::texture::Texture;

/// What a texture's values may be where a material uses it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureRange {
    /// Shares of something: 0 to 1.
    Unit,
    /// Light: not below 0.
    Light,
    /// Directions and heights: any value.
    Any,
}

impl TextureRange {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Unit, Self::Light, Self::Any];

    /// A value clamped to the range; that of an alpha always to 0 to 1, unless all is free.
    fn clamp(self, value: f32, is_alpha: bool) -> f32 {
        match self {
            Self::Any => value,
            Self::Light if !is_alpha => value.max(0.0),
            Self::Unit | Self::Light => value.clamp(0.0, 1.0),
        }
    }

    /// Whether all texels are in the range. Images of integers always are.
    pub fn holds(self, texture: &Texture) -> bool {
        let image = texture.image();
        if image.depth() != Depth::F32 {
            return true;
        }
        let texels = image.texels();
        let Texels::F32(values) = &*texels else { return true };
        self.clamp_all(values, image.channels()).zip(values).all(|(to, &is)| to == is)
    }

    /// The texture with all texels clamped to the range; `store` keeps its image.
    #[must_use]
    pub fn clamp_texture(self, texture: &Texture, store: &TextureStore) -> Texture {
        let image = texture.image();
        let texels = image.texels();
        let Texels::F32(values) = &*texels else { return texture.clone() };
        let texels = Texels::F32(self.clamp_all(values, image.channels()).collect());
        let [width, height] = texture.size();
        let image = Image::new(width, height, image.channels(), texels);
        texture.with_image(store.keep(image))
    }

    /// Each of the values of so many channels, clamped.
    fn clamp_all(self, values: &[f32], channels: u8) -> impl Iterator<Item = f32> {
        let channels = usize::from(channels);
        let is_alpha = move |i: usize| channels % 2 == 0 && i % channels == channels - 1;
        values.iter().enumerate().map(move |(i, &value)| self.clamp(value, is_alpha(i)))
    }

    /// For notices: what an image holds that is not in the range, and what becomes of it.
    pub fn describe_excess(self) -> &'static str {
        match self {
            Self::Unit => "values below 0 or above 1 where a surface has shares: taken to 0 to 1",
            Self::Light | Self::Any => "values below 0 where there is light: taken as 0",
        }
    }
}
