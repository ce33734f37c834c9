//! A number that tells scenes apart, and whether two such numbers can be compared at all.

use std::collections::HashMap;
use std::fmt::Write;
use std::sync::Arc;

use super::{Instance, Material, NamedCamera, Scene, TextureRef, Transform};
use crate::camera::{Camera, ThinLens};
use crate::geom::Mesh;
use crate::light::{Environment, Punctual, PunctualKind};
use crate::math::{Affine3A, Digest, MaterialId, MeshId, TextureId, Vec3};
use crate::medium::Medium;
use crate::texture::{ColorSpace, Filter, Image, Texture, Wrap};

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

    /// The digest as files tell it, behind what tells how it was made: that of a little scene
    /// which always is the same. So a scene that has changed is not mistaken for one that was
    /// hashed in another way, by a program that knows of more kinds of materials, say.
    pub fn digest_text(&self) -> String {
        format!("{:04x}-{:016x}", example().digest() >> 48, self.digest())
    }
}

/// Whether two digests that files tell can be compared: both were made in the same way. Early
/// ones do not tell how.
pub fn are_comparable(a: &str, b: &str) -> bool {
    let kind = |text: &str| text.split_once('-').map(|(kind, _)| kind.to_owned());
    kind(a).is_some() && kind(a) == kind(b)
}

/// A scene with one of everything.
fn example() -> Scene {
    let image = Arc::new(Image::of(1, 1, vec![[1_u8, 2, 3]]));
    let texture = Texture::new(image, ColorSpace::Srgb, [Wrap::Repeat; 2], Filter::Bilinear);
    let base_color_texture = Some(TextureRef::new(TextureId::from_index(0)));
    let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
    let lens = Some(ThinLens { aperture_radius: 1.0, focus_distance: 2.0 });
    let camera = Camera { lens, ..Camera::look_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0) };
    Scene {
        meshes: vec![Arc::new(Mesh { positions, indices: vec![[0, 1, 2]], ..Mesh::default() })],
        instances: vec![Instance {
            mesh: MeshId::from_index(0),
            material: MaterialId::from_index(0),
            transform: Transform::new(Affine3A::IDENTITY),
        }],
        materials: vec![Material { base_color_texture, ..Material::default() }],
        textures: vec![texture],
        lights: vec![Punctual {
            kind: PunctualKind::Spot { inner: 0.25, outer: 0.5 },
            position: Vec3::ZERO,
            direction: Vec3::X,
            intensity: Vec3::ONE,
            range: Some(1.0),
        }],
        medium: Some(Medium::new(Vec3::ONE, Vec3::splat(0.5), 0.0)),
        environment: Some(Environment::image(1, 1, vec![[1.0; 3]], 1.0, 0.0)),
        cameras: vec![NamedCamera { name: String::new(), aspect: None, planes: None, camera }],
        ..Scene::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digests_that_were_made_otherwise_are_not_compared() {
        let (a, b) = (Scene::default().digest_text(), example().digest_text());
        assert!(a != b && are_comparable(&a, &b));
        assert!(!are_comparable(&a, &format!("{:016x}", example().digest())), "an early one");
        assert!(!are_comparable("0001-77", "0002-77") && !are_comparable("77", "78"));
        assert_eq!(b, example().digest_text(), "always the same");
    }

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
