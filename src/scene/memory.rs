//! What a scene takes of memory, by its parts, before a structure is built.

use std::collections::HashSet;
use std::sync::Arc;

use super::Scene;
use crate::accel::{Footprint, MeshUse};
use crate::geom::Mesh;
use crate::texture::Texture;

/// Bytes of a scene's parts, and about how many its structure will take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneMemory {
    /// Triangles of all meshes, each mesh once.
    pub unique_triangles: u64,
    /// Triangles of all placed meshes.
    pub placed_triangles: u64,
    /// Placed meshes.
    pub placements: u64,
    /// Bytes of meshes, each once, and of their shapes while the shutter is open.
    pub mesh_bytes: u64,
    /// Bytes of their places.
    pub placement_bytes: u64,
    /// Bytes of decoded images, each once.
    pub texture_bytes: u64,
    /// The estimate for the default structure.
    pub structure: Footprint,
}

impl SceneMemory {
    /// Adds up.
    pub fn of(scene: &Scene) -> Self {
        let meshes = || scene.meshes.iter();
        let motion = scene.motion.as_deref();
        let deformation = |mesh| motion.and_then(|motion| motion.deformation(mesh));
        let unused = |(number, mesh): (usize, &Arc<Mesh>)| {
            let mut unused = MeshUse::new(mesh.indices.len() as u64, mesh.bounds());
            unused.moves = deformation(number).is_some();
            unused
        };
        let mut used: Vec<MeshUse> = meshes().enumerate().map(unused).collect();
        for (number, instance) in scene.instances.iter().enumerate() {
            let mesh = &mut used[instance.mesh.index()];
            mesh.place(&instance.transform.to_world());
            mesh.moves |= motion.is_some_and(|motion| motion.placement(number).is_some());
        }
        let deformed = (0..used.len()).filter_map(deformation);
        let key_bytes: u64 = deformed.map(|it| it.heap_bytes() as u64).sum();
        let sum = |of: fn(&MeshUse) -> u64| used.iter().map(of).fold(0, u64::saturating_add);
        let mut seen = HashSet::new();
        let images = scene.textures.iter().map(Texture::image);
        let images = images.filter(|image| seen.insert(Arc::as_ptr(image)));
        Self {
            unique_triangles: sum(|mesh| mesh.triangles),
            placed_triangles: sum(MeshUse::placed),
            placements: scene.instances.len() as u64,
            mesh_bytes: meshes().map(|mesh| mesh.heap_bytes() as u64).sum::<u64>() + key_bytes,
            placement_bytes: size_of_val(&*scene.instances) as u64,
            texture_bytes: images.map(|image| image.texel_bytes()).sum(),
            structure: Footprint::estimate(&used),
        }
    }

    /// The same where textures take no more than so many bytes: others are kept in a file.
    #[must_use]
    pub fn with_texture_limit(self, bytes: u64) -> Self {
        Self { texture_bytes: self.texture_bytes.min(bytes), ..self }
    }

    /// The parts by their names, level by level.
    pub fn parts(&self) -> [(&'static str, u64); 5] {
        [
            ("meshes", self.mesh_bytes),
            ("placements", self.placement_bytes),
            ("textures", self.texture_bytes),
            ("structure of meshes", self.structure.triangles),
            ("structure of placements", self.structure.placements),
        ]
    }

    /// All of it.
    pub fn total(&self) -> u64 {
        self.parts().iter().fold(0, |sum, (_, bytes)| sum.saturating_add(*bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Instance, Transform};
    use super::*;
    use crate::math::{Affine3A, MaterialId, MeshId, Vec3};

    #[test]
    fn a_mesh_counts_once_and_its_places_each() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = Mesh { positions, indices: vec![[0, 1, 2]], ..Mesh::default() };
        let instance = Instance {
            mesh: MeshId::from_index(0),
            material: MaterialId::from_index(0),
            transform: Transform::new(Affine3A::IDENTITY),
        };
        let scene = Scene {
            meshes: vec![Arc::new(mesh)],
            instances: vec![instance; 1000],
            ..Scene::default()
        };
        let memory = SceneMemory::of(&scene);
        let counts = (memory.unique_triangles, memory.placed_triangles, memory.placements);
        assert_eq!(counts, (1, 1000, 1000));
        assert_eq!(memory.mesh_bytes, 3 * 12 + 12);
        assert_eq!(memory.placement_bytes, 1000 * size_of::<Instance>() as u64);
        // So few are flattened.
        assert_eq!(memory.structure, Footprint { triangles: 100_000, placements: 0 });
        let sum = memory.parts().map(|(_, bytes)| bytes).iter().sum::<u64>();
        assert_eq!(memory.total(), sum);
    }

    #[test]
    fn copies_of_large_meshes_share_a_structure_and_those_of_small_ones_do_not() {
        let mesh = |triangles: u32| {
            let (positions, indices) = (vec![Vec3::ZERO, Vec3::X, Vec3::Y], [[0, 1, 2]]);
            let indices = indices.repeat(triangles as usize);
            Arc::new(Mesh { positions, indices, ..Mesh::default() })
        };
        let placed = |mesh: usize, times: usize| {
            let instance = Instance {
                mesh: MeshId::from_index(mesh),
                material: MaterialId::from_index(0),
                transform: Transform::new(Affine3A::IDENTITY),
            };
            std::iter::repeat_n(instance, times)
        };
        let instances = placed(0, 100).chain(placed(1, 50)).chain(placed(2, 1)).collect();
        let meshes = vec![mesh(10_000), mesh(100), mesh(3_000)];
        let scene = Scene { meshes, instances, ..Scene::default() };
        let triangles = 10_000 + 50 * 100 + 3_000;
        let expected = Footprint { triangles: 100 * triangles, placements: 100 * 75 };
        assert_eq!(SceneMemory::of(&scene).structure, expected);
    }

    #[test]
    fn what_moves_has_a_structure_of_its_own_and_shapes_that_count() {
        use crate::geom::{Deformation, VertexKey};
        use crate::scene::SceneMotion;
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh =
            Mesh { positions: positions.clone(), indices: vec![[0, 1, 2]], ..Mesh::default() };
        let instance = Instance {
            mesh: MeshId::from_index(0),
            material: MaterialId::from_index(0),
            transform: Transform::new(Affine3A::IDENTITY),
        };
        let key = |time| VertexKey { time, positions: positions.clone(), ..VertexKey::default() };
        let deformation = Deformation::new(vec![key(0.0), key(1.0)]).expect("two keys");
        let mut motion = SceneMotion::default();
        motion.deform(0, Arc::new(deformation));
        let still =
            Scene { meshes: vec![Arc::new(mesh)], instances: vec![instance], ..Scene::default() };
        let before = SceneMemory::of(&still);
        let scene = Scene { motion: Some(Box::new(motion)), ..still };
        let memory = SceneMemory::of(&scene);
        let keys = 2 * (size_of::<VertexKey>() + 3 * 12) as u64;
        assert_eq!(memory.mesh_bytes, before.mesh_bytes + keys);
        assert_eq!(before.structure.placements, 0);
        assert!(memory.structure.placements > 0);
    }

    #[test]
    fn textures_count_up_to_their_limit() {
        let memory = SceneMemory { texture_bytes: 900, ..SceneMemory::default() };
        assert_eq!(memory.with_texture_limit(1000), memory);
        assert_eq!(memory.with_texture_limit(100).total(), 100);
    }
}
