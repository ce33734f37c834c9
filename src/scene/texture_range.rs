//! Images of floats can hold what no surface can do: reflect more than it gets, or less than none.

use std::path::Path;
use std::sync::Arc;

use super::{Image, LoadError, Material, Notice, Scene, Texels, Texture};
use crate::files::memory;
use crate::math::TextureId;

/// What a texture's values may be where a material uses it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Range {
    /// Shares of something: 0 to 1.
    Unit,
    /// Light: not below 0.
    Light,
    /// Directions and heights.
    Any,
}

impl Range {
    const ALL: [Self; 3] = [Self::Unit, Self::Light, Self::Any];

    /// A texel with its values in the range, alpha in 0 to 1.
    fn of(self, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
        let unit = |value: f32| value.clamp(0.0, 1.0);
        match self {
            Self::Unit => [r, g, b, a].map(unit),
            Self::Light => [r.max(0.0), g.max(0.0), b.max(0.0), unit(a)],
            Self::Any => [r, g, b, a],
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Unit => "values below 0 or above 1 where a surface has shares: taken to 0 to 1",
            _ => "values below 0 where there is light: taken as 0",
        }
    }
}

/// Takes textures of floats to the range of what they are used for, and says of which ones that
/// changed any value.
///
/// # Errors
/// [`LoadError::Invalid`] where there is no room for one that is used in two ways.
pub(super) fn restrict(scene: &mut Scene, file: &Path) -> Result<(), LoadError> {
    for index in 0..scene.textures.len() {
        let texture = scene.textures[index].clone();
        let Texels::Rgba32F(texels) = texture.image().texels() else { continue };
        let id = TextureId::from_index(index);
        let slots = scene.materials.iter_mut().flat_map(Material::ranged_slots_mut);
        let used: Vec<Range> = slots
            .filter(|(slot, _)| slot.is_some_and(|slot| slot.texture == id))
            .map(|(_, range)| range)
            .collect();
        let ranges: Vec<Range> = Range::ALL.into_iter().filter(|it| used.contains(it)).collect();
        for &range in &ranges {
            if texels.iter().all(|&texel| range.of(texel) == texel) {
                continue;
            }
            let bytes = texture.image().heap_bytes() as u64;
            memory::claim(bytes).map_err(|reason| {
                LoadError::invalid(file, "", format!("{:?}: {reason}", texture.name()))
            })?;
            let restricted = within(&texture, texels, range);
            let message = format!("{:?} holds {}", texture.name(), range.words());
            scene.notices.push(Notice { place: file.display().to_string(), message });
            if ranges.len() == 1 {
                scene.textures[index] = restricted;
                continue;
            }
            let other = TextureId::from_index(scene.textures.len());
            scene.textures.push(restricted);
            for (slot, used) in scene.materials.iter_mut().flat_map(Material::ranged_slots_mut) {
                if let Some(slot) = slot.as_mut().filter(|slot| slot.texture == id && used == range)
                {
                    slot.texture = other;
                }
            }
        }
    }
    Ok(())
}

fn within(texture: &Texture, texels: &[[f32; 4]], range: Range) -> Texture {
    let texels = texels.iter().map(|&texel| range.of(texel)).collect();
    let [width, height] = texture.size();
    texture.with_image(Arc::new(Image::new(width, height, Texels::Rgba32F(texels))))
}

#[cfg(test)]
mod tests {
    use super::super::{ColorSpace, Filter, TextureRef, Wrap};
    use super::*;

    const TEXELS: [[f32; 4]; 2] = [[4.0, 0.5, -1.0, 2.0], [0.25, 0.5, 0.75, 1.0]];

    /// A scene of those materials, each of which may use the one texture there is.
    fn scene(materials: Vec<Material>) -> Scene {
        let image = Arc::new(Image::new(2, 1, Texels::Rgba32F(TEXELS.to_vec())));
        let texture = Texture::new(image, ColorSpace::Srgb, [Wrap::Clamp; 2], Filter::Nearest);
        let textures = vec![texture.named("a.exr")];
        Scene { materials, textures, ..Scene::default() }
    }

    fn texels(scene: &Scene, slot: Option<TextureRef>) -> Vec<[f32; 4]> {
        let texture = &scene.textures[slot.expect("a texture").texture.index()];
        let Texels::Rgba32F(texels) = texture.image().texels() else { panic!("floats") };
        texels.clone()
    }

    #[test]
    fn each_use_has_its_range() {
        let slot = Some(TextureRef::new(TextureId::from_index(0)));
        let [unit, light] = [[[1.0, 0.5, 0.0, 1.0], TEXELS[1]], [[4.0, 0.5, 0.0, 1.0], TEXELS[1]]];
        let file = Path::new("a.obj");

        let painted = Material { base_color_texture: slot, ..Material::default() };
        let mut one = scene(vec![painted.clone()]);
        restrict(&mut one, file).expect("there is room");
        assert_eq!((one.textures.len(), one.notices.len()), (1, 1));
        assert_eq!(texels(&one, one.materials[0].base_color_texture), unit);
        let message = &one.notices[0].message;
        assert!(message.starts_with("\"a.exr\" holds values below 0 or above 1"), "{message}");

        let glowing = Material { emissive_texture: slot, normal_texture: slot, ..painted };
        let unlit = Material { base_color_texture: slot, unlit: true, ..Material::default() };
        let mut all = scene(vec![glowing, unlit]);
        restrict(&mut all, file).expect("there is room");
        assert_eq!((all.textures.len(), all.notices.len()), (3, 2));
        let [glowing, unlit] = &all.materials[..] else { panic!("two") };
        assert_eq!(texels(&all, glowing.base_color_texture), unit);
        assert_eq!(texels(&all, glowing.emissive_texture), light);
        assert_eq!(texels(&all, glowing.normal_texture), TEXELS);
        assert_eq!(texels(&all, unlit.base_color_texture), light);
    }

    #[test]
    fn what_is_within_stays_and_nothing_is_said() {
        let mut scene = scene(vec![Material::default()]);
        restrict(&mut scene, Path::new("a.obj")).expect("there is room");
        assert!(scene.notices.is_empty(), "it is not used");
        assert_eq!(texels(&scene, Some(TextureRef::new(TextureId::from_index(0)))), TEXELS);
    }
}
