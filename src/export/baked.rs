//! Images that are made for what glTF has no texture for.

use std::sync::Arc;

use super::image::Images;
use crate::scene::{Material, TextureRef};
use crate::texture::{ColorSpace, Image, Texture};

/// Puts a separate texture of alpha into that of the colours, if both are looked up alike and the
/// latter has no alpha of its own, or is not there.
pub fn with_alpha(material: &mut Material, images: &mut Images<'_>) -> bool {
    let Some(alpha) = material.alpha_texture else { return true };
    let shape = images.of(alpha.texture).clone();
    let Some(alphas) = shape.image().rgba::<u8>() else { return false };
    let colors = match material.base_color_texture {
        None => vec![[u8::MAX; 4]; alphas.len()],
        Some(color) => {
            let texture = images.of(color.texture);
            let alike = TextureRef { texture: alpha.texture, ..color } == alpha
                && texture.size() == shape.size()
                && (texture.wrap(), texture.filter()) == (shape.wrap(), shape.filter())
                && texture.image().is_opaque()
                && texture.color_space() == ColorSpace::Srgb;
            match texture.image().rgba::<u8>() {
                Some(colors) if alike => colors,
                _ => return false,
            }
        }
    };
    let both = colors.iter().zip(&alphas).map(|(c, a)| [c[0], c[1], c[2], a[0]]);
    let texture = like(&shape, both.collect(), ColorSpace::Srgb);
    let texture = images.add(texture, ColorSpace::Srgb);
    material.base_color_texture = Some(TextureRef { texture, ..alpha });
    material.alpha_texture = None;
    true
}

/// Makes roughness of glossiness: one minus it, in the green channel of the texture that glTF has
/// for that.
pub fn without_glossiness(material: &mut Material, images: &mut Images<'_>) -> bool {
    let Some(glossiness) = material.glossiness_texture else { return true };
    let shape = images.of(glossiness.texture).clone();
    let Some(texels) = shape.image().rgba::<u8>() else { return false };
    if material.metallic_roughness_texture.is_some() {
        return false;
    }
    let factor = 1.0 - material.roughness;
    let roughness = |[.., glossy]: &[u8; 4]| {
        let roughness = 255.0 - factor * f32::from(*glossy);
        [0, (roughness + 0.5) as u8, u8::MAX, u8::MAX]
    };
    let texture = like(&shape, texels.iter().map(roughness).collect(), ColorSpace::Linear);
    let texture = images.add(texture, ColorSpace::Linear);
    material.metallic_roughness_texture = Some(TextureRef { texture, ..glossiness });
    (material.roughness, material.glossiness_texture) = (1.0, None);
    true
}

/// Other texels that are looked up as those of a texture are.
fn like(texture: &Texture, texels: Vec<[u8; 4]>, space: ColorSpace) -> Texture {
    let [width, height] = texture.size();
    let image = Arc::new(Image::of(width, height, texels));
    Texture::new(image, space, texture.wrap(), texture.filter()).named(texture.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::TextureId;
    use crate::scene::Scene;
    use crate::texture::{Filter, Wrap};

    fn texture(texels: Vec<[u8; 4]>, space: ColorSpace) -> Texture {
        let image = Arc::new(Image::of(2, 1, texels));
        Texture::new(image, space, [Wrap::Repeat; 2], Filter::Bilinear)
    }

    fn reference(index: usize) -> TextureRef {
        TextureRef::new(TextureId::from_index(index))
    }

    #[test]
    fn alpha_goes_into_the_colours() {
        let colors = texture(vec![[1, 2, 3, 255], [4, 5, 6, 255]], ColorSpace::Srgb);
        let alphas = texture(vec![[0, 0, 0, 255], [128, 0, 0, 255]], ColorSpace::Linear);
        let scene = Scene { textures: vec![colors, alphas], ..Scene::default() };
        let mut material = Material {
            base_color_texture: Some(reference(0)),
            alpha_texture: Some(reference(1)),
            ..Material::default()
        };
        let mut images = Images::new(&scene);
        assert!(with_alpha(&mut material, &mut images) && material.alpha_texture.is_none());
        let made = images.of(material.base_color_texture.expect("has one").texture);
        assert_eq!(made.image().rgba::<u8>(), Some(vec![[1, 2, 3, 0], [4, 5, 6, 128]]));
        // A texture that is turned is not looked up alike.
        let turned = TextureRef { rotation: crate::math::Vec2::Y, ..reference(1) };
        let mut material = Material {
            base_color_texture: Some(reference(0)),
            alpha_texture: Some(turned),
            ..Material::default()
        };
        assert!(!with_alpha(&mut material, &mut images) && material.alpha_texture.is_some());
    }

    #[test]
    fn glossiness_becomes_roughness() {
        let glossy = texture(vec![[0, 0, 0, 255], [0, 0, 0, 102]], ColorSpace::Srgb);
        let scene = Scene { textures: vec![glossy], ..Scene::default() };
        let mut material = Material {
            roughness: 0.5,
            metallic: 0.0,
            glossiness_texture: Some(reference(0)),
            ..Material::default()
        };
        let mut images = Images::new(&scene);
        assert!(without_glossiness(&mut material, &mut images));
        let made = images.of(material.metallic_roughness_texture.expect("has one").texture);
        let green: Vec<u8> =
            made.image().rgba::<u8>().expect("bytes").iter().map(|texel| texel[1]).collect();
        // 1 - .5 and 1 - .5 x .4, in 255ths.
        assert_eq!((green, material.roughness), (vec![128, 204], 1.0));
    }
}
