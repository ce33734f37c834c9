//! Takes textures of floats to the range of what materials use them for.

use std::path::Path;

use super::LoadError;
use crate::files::memory;
use crate::math::TextureId;
use crate::scene::{Material, Notice, Scene};
use crate::texture::{Depth, TextureRange, TextureStore};

/// Takes textures of floats to the range of what they are used for, and says of which ones that
/// changed any value.
///
/// # Errors
/// [`LoadError::Invalid`] where there is no room for one that is used in two ways.
pub(super) fn restrict(
    scene: &mut Scene,
    file: &Path,
    store: &TextureStore,
) -> Result<(), LoadError> {
    for index in 0..scene.textures.len() {
        let texture = scene.textures[index].clone();
        if texture.image().depth() != Depth::F32 {
            continue;
        }
        let id = TextureId::from_index(index);
        let ranges = ranges_in_use(scene, id);
        for &range in ranges.iter().filter(|range| !range.holds(&texture)) {
            let bytes = texture.image().texel_bytes();
            memory::claim(bytes).map_err(|reason| {
                LoadError::invalid(file, "", format!("{:?}: {reason}", texture.name()))
            })?;
            let message = format!("{:?} holds {}", texture.name(), range.describe_excess());
            scene.notices.push(Notice { place: file.display().to_string(), message });
            let restricted = range.clamp_texture(&texture, store);
            if ranges.len() == 1 {
                scene.textures[index] = restricted;
            } else {
                let other = TextureId::from_index(scene.textures.len());
                scene.textures.push(restricted);
                replace(scene, (id, range), other);
            }
        }
    }
    Ok(())
}

/// The ranges for which materials use a texture, in the order of [`TextureRange::ALL`].
fn ranges_in_use(scene: &mut Scene, id: TextureId) -> Vec<TextureRange> {
    let slots = scene.materials.iter_mut().flat_map(Material::ranged_slots_mut);
    let used: Vec<TextureRange> = slots
        .filter(|(slot, _)| slot.is_some_and(|slot| slot.texture == id))
        .map(|(_, range)| range)
        .collect();
    TextureRange::ALL.into_iter().filter(|range| used.contains(range)).collect()
}

/// Lets materials use `other` wherever they use the texture `id` for `range`.
fn replace(scene: &mut Scene, (id, range): (TextureId, TextureRange), other: TextureId) {
    for (slot, used) in scene.materials.iter_mut().flat_map(Material::ranged_slots_mut) {
        if let Some(slot) = slot.as_mut().filter(|slot| slot.texture == id && used == range) {
            slot.texture = other;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::TextureRef;
    use crate::texture::{ColorSpace, Filter, Image, Texture, Wrap};

    const TEXELS: [[f32; 4]; 2] = [[4.0, 0.5, -1.0, 2.0], [0.25, 0.5, 0.75, 1.0]];

    /// A scene of those materials, each of which may use the one texture there is.
    fn scene(materials: Vec<Material>) -> Scene {
        let image = Arc::new(Image::of(2, 1, TEXELS.to_vec()));
        let texture = Texture::new(image, ColorSpace::Srgb, [Wrap::Clamp; 2], Filter::Nearest);
        let textures = vec![texture.named("a.exr")];
        Scene { materials, textures, ..Scene::default() }
    }

    fn texels(scene: &Scene, slot: Option<TextureRef>) -> Vec<[f32; 4]> {
        let texture = &scene.textures[slot.expect("a texture").texture.index()];
        texture.image().rgba().expect("floats")
    }

    #[test]
    fn each_use_has_its_range() {
        let slot = Some(TextureRef::new(TextureId::from_index(0)));
        let [unit, light] = [[[1.0, 0.5, 0.0, 1.0], TEXELS[1]], [[4.0, 0.5, 0.0, 1.0], TEXELS[1]]];
        let file = Path::new("a.obj");

        let painted = Material { base_color_texture: slot, ..Material::default() };
        let mut one = scene(vec![painted.clone()]);
        restrict(&mut one, file, &TextureStore::default()).expect("there is room");
        assert_eq!((one.textures.len(), one.notices.len()), (1, 1));
        assert_eq!(texels(&one, one.materials[0].base_color_texture), unit);
        let message = &one.notices[0].message;
        assert!(message.starts_with("\"a.exr\" holds values below 0 or above 1"), "{message}");

        let glowing = Material { emissive_texture: slot, normal_texture: slot, ..painted };
        let unlit = Material { base_color_texture: slot, unlit: true, ..Material::default() };
        let mut all = scene(vec![glowing, unlit]);
        restrict(&mut all, file, &TextureStore::new(64)).expect("there is room");
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
        restrict(&mut scene, Path::new("a.obj"), &TextureStore::default()).expect("there is room");
        assert!(scene.notices.is_empty(), "it is not used");
        assert_eq!(texels(&scene, Some(TextureRef::new(TextureId::from_index(0)))), TEXELS);
    }
}
