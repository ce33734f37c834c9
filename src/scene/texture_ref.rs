//! How a material uses a texture.

use crate::math::{TextureId, Vec2};

/// A texture as a material uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// The texture.
    pub texture: TextureId,
    /// Which of the mesh's sets of coordinates.
    pub uv_set: u32,
    /// Applied to the coordinates before the look-up, see [`TextureRef::transform`].
    pub scale: Vec2,
    /// Cosine and sine of the angle by which the coordinates turn.
    pub rotation: Vec2,
    /// What is added last.
    pub offset: Vec2,
}

impl TextureRef {
    /// The texture by the first set of coordinates, as they are.
    pub fn new(texture: TextureId) -> Self {
        Self { texture, uv_set: 0, scale: Vec2::ONE, rotation: Vec2::X, offset: Vec2::ZERO }
    }

    /// Where to look, of the mesh's coordinates: scaled, then turned, then moved, all about the
    /// origin (KHR_texture_transform; there v points down and the angle is counter-clockwise).
    #[inline]
    pub fn transform(&self, uv: Vec2) -> Vec2 {
        let (Vec2 { x: cos, y: sin }, uv) = (self.rotation, uv * self.scale);
        Vec2::new(cos * uv.x + sin * uv.y, cos * uv.y - sin * uv.x) + self.offset
    }
}
