//! The media of a scene: what fills its solids and the space around them.

use crate::math::{Vec2, Vec3};
use crate::medium::Medium;
use crate::scene::{AlphaMode, Material, Scene, TextureRef};

/// What fills solids and space.
#[derive(Debug, Default)]
pub(super) struct Media {
    /// By material: the inside, if it scatters.
    pub solids: Vec<Option<Medium>>,
    /// Outside of all solids.
    pub space: Option<Medium>,
    /// By material: whether its border only tints light, where it does not bend it.
    pub clear: Vec<bool>,
    /// Whether light may pass borders that it neither sees bent nor scattered.
    pub has_passable_borders: bool,
    /// Whether there is any medium that scatters, or that fills space.
    pub any: bool,
}

impl Media {
    /// Those of a scene.
    pub fn new(scene: &Scene) -> Self {
        let solids: Vec<Option<Medium>> =
            scene.materials.iter().map(|material| inside(scene, material)).collect();
        let mut used = vec![false; scene.materials.len()];
        for instance in &scene.instances {
            used[instance.material.index()] = true;
        }
        let is_used = |index: usize| used[index];
        let scatters = (0..solids.len()).any(|index| is_used(index) && solids[index].is_some());
        let space = scene.medium;
        let clear: Vec<bool> = scene.materials.iter().map(is_clear).collect();
        let of_index = |index: usize| scene.materials[index].ior;
        let borders: Vec<usize> = (0..clear.len()).filter(|&i| is_used(i) && clear[i]).collect();
        let matched = |&index: &usize| {
            let ior = of_index(index);
            let others = (0..clear.len()).filter(|&other| {
                other != index && is_used(other) && scene.materials[other].is_solid()
            });
            ior == 1.0 || others.into_iter().any(|other| of_index(other) == ior)
        };
        let any = scatters || space.is_some();
        let has_passable_borders = any && borders.iter().any(matched);
        Self { solids, space, clear, has_passable_borders, any }
    }
}

/// What scatters light inside of a material's solids.
fn inside(scene: &Scene, material: &Material) -> Option<Medium> {
    let (volume, scattering) = (material.volume.as_ref()?, material.scattering.as_ref()?);
    let texture = scattering.color_texture.as_ref().map_or(Vec3::ONE, |it| mean(scene, it));
    let medium = scattering.medium(volume, texture);
    (material.is_solid() && medium.scatters()).then_some(medium)
}

/// The mean of a texture, by points of a grid.
fn mean(scene: &Scene, texture: &TextureRef) -> Vec3 {
    const SIDE: usize = 64;
    let texture = &scene.textures[texture.texture.index()];
    let place = |i: usize| (i as f32 + 0.5) / SIDE as f32;
    let mut sum = Vec3::ZERO;
    for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
        sum += texture.sample(Vec2::new(place(i), place(j))).truncate();
    }
    sum / (SIDE * SIDE) as f32
}

/// Whether the border of a material's solids does nothing to light but tint it, where the index of
/// refraction is the same on both sides.
fn is_clear(material: &Material) -> bool {
    material.is_solid()
        && material.transmission >= 1.0
        && material.transmission_texture.is_none()
        && material.metallic <= 0.0
        && material.layers.is_none()
        && material.dispersion <= 0.0
        && !material.unlit
        && !material.is_emissive()
        && material.alpha_mode == AlphaMode::Opaque
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ScatterColor, Scattering, Volume};

    fn fog(ior: f32) -> Material {
        let color = ScatterColor::One(Vec3::splat(0.5));
        Material {
            metallic: 0.0,
            transmission: 1.0,
            ior,
            volume: Some(Volume { attenuation_color: Vec3::splat(0.5), attenuation_distance: 1.0 }),
            scattering: Some(Scattering { color, ..Scattering::NONE }),
            ..Material::default()
        }
    }

    #[test]
    fn only_what_is_used_counts() {
        let scene = Scene { materials: vec![fog(1.0)], ..Scene::default() };
        let media = Media::new(&scene);
        assert!(!media.any && !media.has_passable_borders && media.solids[0].is_some());
        let space = Medium::new(Vec3::ONE, Vec3::ZERO, 0.0);
        let media = Media::new(&Scene { medium: Some(space), ..Scene::default() });
        assert!(media.any && !media.has_passable_borders);
    }

    #[test]
    fn a_border_is_clear_if_it_does_nothing_but_tint() {
        assert!(is_clear(&fog(1.0)) && is_clear(&fog(1.33)));
        assert!(!is_clear(&Material { transmission: 0.5, ..fog(1.0) }));
        assert!(!is_clear(&Material { volume: None, ..fog(1.0) }));
        assert!(!is_clear(&Material { emissive: Vec3::X, ..fog(1.0) }));
    }
}
