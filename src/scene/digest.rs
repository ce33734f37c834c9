//! A number that tells scenes apart.

use std::collections::HashMap;
use std::fmt::Write;
use std::sync::Arc;

use super::Scene;
use crate::math::Digest;

impl Scene {
    /// A hash of shapes, places, materials, lights, cameras, texels, the environment's pixels, and
    /// of how all of that moves while the shutter is open.
    pub fn digest(&self) -> u64 {
        let mut digest = Digest::default();
        for mesh in &self.meshes {
            digest.bytes(bytemuck::cast_slice(&mesh.positions));
            digest.bytes(bytemuck::cast_slice(&mesh.normals));
            digest.bytes(bytemuck::cast_slice(&mesh.tangents));
            mesh.uv_sets().for_each(|set| digest.bytes(bytemuck::cast_slice(set)));
            digest.bytes(bytemuck::cast_slice(&mesh.indices));
            if !mesh.colors.is_empty() {
                digest.bytes(bytemuck::cast_slice(&mesh.colors));
            }
        }
        for instance in &self.instances {
            digest.bytes(bytemuck::bytes_of(&[instance.mesh.0, instance.material.0]));
            let to_world = instance.transform.to_world().to_cols_array();
            digest.bytes(bytemuck::bytes_of(&to_world));
        }
        // Textures share images: each is hashed once.
        let mut images = HashMap::new();
        for texture in &self.textures {
            let image = texture.image();
            let next = images.len();
            let number = *images.entry(Arc::as_ptr(image)).or_insert_with(|| {
                digest.word(image.digest());
                next
            });
            // It tells its image's size only. Writing to a digest cannot fail.
            let _ = write!(digest, "{number} {texture:?}");
        }
        if let Some(environment) = &self.environment {
            let pixels: Vec<[f32; 3]> = environment.pixels().collect();
            digest.bytes(bytemuck::cast_slice(&pixels));
            let _ = write!(digest, "{:?}", environment.mean());
            if let Some(sun) = environment.sun() {
                let _ = write!(digest, "{sun:?}");
            }
        }
        if let Some(medium) = &self.medium {
            let _ = write!(digest, "{medium:?}");
        }
        let _ = write!(digest, "{:?} {:?} {:?}", self.materials, self.lights, self.cameras);
        if let Some(motion) = &self.motion {
            motion.add_to(&mut digest);
        }
        digest.value()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Material;
    use super::*;
    use crate::light::Environment;
    use crate::math::Vec3;
    use crate::texture::{ColorSpace, Filter, Image, Texture, Wrap};

    #[test]
    fn a_change_of_any_material_changes_the_digest() {
        let mut scene = Scene { materials: vec![Material::default()], ..Scene::default() };
        let before = scene.digest();
        assert_eq!(before, scene.digest());
        scene.materials[0].emissive = Vec3::X;
        assert_ne!(before, scene.digest());
    }

    #[test]
    fn a_change_of_any_texel_or_pixel_changes_the_digest() {
        let digest = |texel: u8, pixel: f32, repeat: Wrap| {
            let image = Arc::new(Image::of(2, 1, vec![[0, 0, 0], [0, texel, 0]]));
            let texture =
                |filter| Texture::new(image.clone(), ColorSpace::Srgb, [repeat; 2], filter);
            let pixels = vec![[1.0; 3], [pixel, 2.0 - pixel, 1.0]];
            let scene = Scene {
                textures: vec![texture(Filter::Nearest), texture(Filter::Bilinear)],
                environment: Some(Environment::image(2, 1, pixels, 1.0, 0.0)),
                ..Scene::default()
            };
            scene.digest()
        };
        let one = digest(7, 0.5, Wrap::Repeat);
        assert_eq!(one, digest(7, 0.5, Wrap::Repeat));
        for other in [
            digest(8, 0.5, Wrap::Repeat),
            digest(7, 0.25, Wrap::Repeat),
            digest(7, 0.5, Wrap::Clamp),
        ] {
            assert_ne!(one, other);
        }
    }
}
