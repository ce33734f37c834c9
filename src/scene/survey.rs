//! What a scene holds, counted, and what in it looks like a mistake.

use super::{Instance, Scene};
use crate::geom::Mesh;
use crate::light::{Punctual, PunctualKind};
use crate::math::DVec3;

/// Figures about a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Survey {
    /// Triangles of all meshes, each mesh once.
    pub unique_triangles: u64,
    /// Triangles of all placed meshes.
    pub placed_triangles: u64,
    /// Placed triangles that emit.
    pub emitting_triangles: u64,
    /// Triangles without area, each mesh once.
    pub flat_triangles: u64,
    /// Meshes with triangles and without normals, by number.
    pub faceted: Vec<usize>,
    /// Placed meshes that are mirrored.
    pub mirrored: u64,
    /// Placed meshes that are flattened to a plane, a line or a point.
    pub flattened: u64,
}

impl Survey {
    /// Counts.
    pub fn of(scene: &Scene) -> Self {
        let mut survey = Self::default();
        for (number, mesh) in scene.meshes.iter().enumerate() {
            survey.unique_triangles += mesh.indices.len() as u64;
            survey.flat_triangles += flat_triangles(mesh);
            if mesh.normals.is_empty() && !mesh.indices.is_empty() {
                survey.faceted.push(number);
            }
        }
        for instance in &scene.instances {
            let triangles = scene.meshes[instance.mesh.index()].indices.len() as u64;
            survey.placed_triangles += triangles;
            if scene.materials[instance.material.index()].is_emissive() {
                survey.emitting_triangles += triangles;
            }
            survey.mirrored += u64::from(instance.transform.mirrored());
            survey.flattened += u64::from(is_flattened(instance));
        }
        survey
    }

    /// What looks like a mistake: for each a word for programs, and what to say.
    pub fn find_faults(&self, scene: &Scene) -> Vec<(&'static str, String)> {
        let mut faults = Vec::new();
        let mut add = |kind, message: String| faults.push((kind, message));
        if self.placed_triangles == 0 {
            add("no-triangles", "there is nothing to see".to_owned());
        }
        let dark = self.emitting_triangles == 0 && scene.lights.is_empty();
        if dark && scene.environment.is_none() {
            add("no-light", "nothing shines: a neutral sky, or --env".to_owned());
        }
        if scene.medium.is_some_and(|medium| medium.extinction().min_element() > 0.0) {
            let far = |light: &Punctual| light.kind == PunctualKind::Directional;
            if scene.environment.is_some() || scene.lights.iter().any(far) {
                let message = "a medium fills all space: no light reaches anything from infinity";
                add("veiled", message.to_owned());
            }
        }
        if scene.cameras.is_empty() {
            add("no-camera", "no camera: all of it is framed, or --look-from".to_owned());
        }
        if !self.faceted.is_empty() {
            let names = names(scene, &self.faceted);
            let (without, all) = (self.faceted.len(), scene.meshes.len());
            add(
                "no-normals",
                format!("no normals in {without} of {all} meshes: flat shading{names}"),
            );
        }
        if self.flat_triangles > 0 {
            add("zero-area", format!("{} triangles have no area", self.flat_triangles));
        }
        if self.mirrored > 0 {
            add("mirrored", format!("{} placed meshes are mirrored", self.mirrored));
        }
        if self.flattened > 0 {
            let message = "placed meshes are scaled to nothing in some direction";
            add("flattened", format!("{} {message}", self.flattened));
        }
        faults
    }
}

/// A few names of meshes, as an addition to a message.
fn names(scene: &Scene, meshes: &[usize]) -> String {
    const MOST: usize = 3;
    let named = meshes.iter().map(|&mesh| scene.meshes[mesh].name.as_str());
    let names: Vec<_> = named.filter(|name| !name.is_empty()).take(MOST + 1).collect();
    match names.len() {
        0 => String::new(),
        count => {
            let more = if count > MOST { ", …" } else { "" };
            format!(" ({}{more})", names[..count.min(MOST)].join(", "))
        }
    }
}

fn flat_triangles(mesh: &Mesh) -> u64 {
    let flat = |triangle: &&[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
        (b - a).cross(c - a) == DVec3::ZERO
    };
    mesh.indices.iter().filter(flat).count() as u64
}

fn is_flattened(instance: &Instance) -> bool {
    instance.transform.to_world().matrix3.as_dmat3().determinant() == 0.0
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::{Material, Transform};
    use super::*;
    use crate::light::Environment;
    use crate::math::{Affine3A, MaterialId, MeshId, Vec3};
    use crate::medium::Medium;

    #[test]
    fn a_sky_behind_endless_fog_is_told() {
        let medium = Medium::new(Vec3::ONE, Vec3::ONE, 0.0);
        let of = |medium| {
            let environment = Some(Environment::constant(Vec3::ONE));
            Scene { medium, environment, ..Scene::default() }
        };
        let told = |scene: &Scene| {
            let faults = Survey::of(scene).find_faults(scene);
            faults.iter().any(|(kind, _)| *kind == "veiled")
        };
        assert!(told(&of(Some(medium))) && !told(&of(None)));
    }

    #[test]
    fn figures_and_faults_of_a_scene_with_all_of_them() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y];
        let mesh = Mesh {
            name: "sail".to_owned(),
            positions,
            indices: vec![[0, 1, 2], [0, 1, 1]],
            ..Mesh::default()
        };
        let placed = |scale: Vec3| Instance {
            mesh: MeshId::from_index(0),
            material: MaterialId::from_index(0),
            transform: Transform::new(Affine3A::from_scale(scale)),
        };
        let scene = Scene {
            meshes: vec![Arc::new(mesh)],
            instances: vec![
                placed(Vec3::ONE),
                placed(Vec3::new(-1.0, 1.0, 1.0)),
                placed(Vec3::new(1.0, 0.0, 1.0)),
            ],
            materials: vec![Material::default()],
            ..Scene::default()
        };
        let survey = Survey::of(&scene);
        assert_eq!((survey.unique_triangles, survey.placed_triangles), (2, 6));
        assert_eq!((survey.mirrored, survey.flattened, survey.flat_triangles), (1, 1, 1));
        let faults = survey.find_faults(&scene);
        let kinds: Vec<_> = faults.iter().map(|(kind, _)| *kind).collect();
        let expected =
            ["no-light", "no-camera", "no-normals", "zero-area", "mirrored", "flattened"];
        assert_eq!(kinds, expected);
        assert_eq!(faults[2].1, "no normals in 1 of 1 meshes: flat shading (sail)");
        let nothing = Survey::of(&Scene::default()).find_faults(&Scene::default());
        assert_eq!(nothing[0].0, "no-triangles");
    }
}
