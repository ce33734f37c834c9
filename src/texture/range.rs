//! Images of floats can hold what no surface can do: reflect more than it gets, or less than none.

use std::sync::Arc;

use super::{Image, Texels, Texture};

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

    /// A texel with its values clamped to the range, and alpha to 0 to 1.
    fn clamp(self, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
        let unit = |value: f32| value.clamp(0.0, 1.0);
        match self {
            Self::Unit => [r, g, b, a].map(unit),
            Self::Light => [r.max(0.0), g.max(0.0), b.max(0.0), unit(a)],
            Self::Any => [r, g, b, a],
        }
    }

    /// Whether all texels are in the range. Images of integers always are.
    pub fn holds(self, texture: &Texture) -> bool {
        match texture.image().texels() {
            Texels::Rgba32F(texels) => texels.iter().all(|&texel| self.clamp(texel) == texel),
            Texels::Rgba8(_) | Texels::Rgba16(_) => true,
        }
    }

    /// The texture with all texels clamped to the range.
    #[must_use]
    pub fn clamp_texture(self, texture: &Texture) -> Texture {
        let Texels::Rgba32F(texels) = texture.image().texels() else { return texture.clone() };
        let texels = texels.iter().map(|&texel| self.clamp(texel)).collect();
        let [width, height] = texture.size();
        texture.with_image(Arc::new(Image::new(width, height, Texels::Rgba32F(texels))))
    }

    /// For notices: what an image holds that is not in the range, and what becomes of it.
    pub fn describe_excess(self) -> &'static str {
        match self {
            Self::Unit => "values below 0 or above 1 where a surface has shares: taken to 0 to 1",
            Self::Light | Self::Any => "values below 0 where there is light: taken as 0",
        }
    }
}
