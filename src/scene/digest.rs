//! A number that tells scenes apart.

use std::fmt::Write;

use super::Scene;

/// A running hash over bytes, eight at a time; good enough to tell scenes apart, not to guard
/// against someone who wants two to look alike.
struct Digest(u64);

impl Digest {
    fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.0 ^= self.0 >> 29;
    }

    fn bytes(&mut self, bytes: &[u8]) {
        self.word(bytes.len() as u64);
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.word(u64::from_le_bytes(word));
        }
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}

impl Scene {
    /// A hash of shapes, places, materials and lights; of textures and the environment the sizes
    /// and means only.
    pub fn digest(&self) -> u64 {
        let mut digest = Digest(0);
        for mesh in &self.meshes {
            digest.bytes(bytemuck::cast_slice(&mesh.positions));
            digest.bytes(bytemuck::cast_slice(&mesh.normals));
            digest.bytes(bytemuck::cast_slice(&mesh.tangents));
            mesh.uvs.iter().for_each(|set| digest.bytes(bytemuck::cast_slice(set)));
            digest.bytes(bytemuck::cast_slice(&mesh.indices));
        }
        let mut described = String::new();
        for instance in &self.instances {
            described.clear();
            let (mesh, material) = (instance.mesh.0, instance.material.0);
            let _ = write!(described, "{mesh} {material} {:?}", instance.transform.to_world);
            digest.bytes(described.as_bytes());
        }
        let sizes: Vec<[u32; 2]> = self.textures.iter().map(super::Texture::size).collect();
        let sky = self.environment.as_ref().map(crate::light::Environment::mean);
        // Writing to a digest cannot fail.
        let _ = write!(digest, "{:?} {sizes:?} {:?} {sky:?}", self.materials, self.lights);
        digest.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::scene::Material;

    #[test]
    fn a_change_of_any_material_changes_the_digest() {
        let mut scene = Scene { materials: vec![Material::default()], ..Scene::default() };
        let before = scene.digest();
        assert_eq!(before, scene.digest());
        scene.materials[0].emissive = Vec3::X;
        assert_ne!(before, scene.digest());
    }
}
