//! A scene at a time while the shutter is open.

use super::placement::narrow;
use super::{Scene, SceneMotion, Transform};
use crate::geom::Posed;
use crate::light::Punctual;
use crate::math::{Affine3A, InstanceId, MeshId};
use crate::motion::Motion;

/// From a moving space to the world at a time.
#[inline]
fn to_world_of(motion: &Motion, time: f32) -> Affine3A {
    narrow(&motion.at(f64::from(time)))
}

impl Scene {
    /// What moves, to add to.
    pub fn motion_mut(&mut self) -> &mut SceneMotion {
        self.motion.get_or_insert_default()
    }

    /// Where an instance stands at a time.
    #[inline(always)]
    pub fn transform_at(&self, instance: InstanceId, time: f32) -> Transform {
        let still = &self.instances[instance.index()].transform;
        let moves = self.motion.as_ref().and_then(|motion| motion.placement(instance.index()));
        moves.map_or(*still, |motion| Transform::new(to_world_of(motion, time)))
    }

    /// From the space of an instance's mesh to the world at a time.
    #[inline]
    pub fn to_world_at(&self, instance: InstanceId, time: f32) -> Affine3A {
        let moves = self.motion.as_ref().and_then(|motion| motion.placement(instance.index()));
        match moves {
            Some(motion) => to_world_of(motion, time),
            None => self.instances[instance.index()].transform.to_world(),
        }
    }

    /// A mesh at a time.
    #[inline(always)]
    pub fn mesh_at(&self, mesh: MeshId, time: f32) -> Posed<'_> {
        let moves = self.motion.as_ref().and_then(|motion| motion.deformation(mesh.index()));
        Posed::new(&self.meshes[mesh.index()], moves.map(|it| &**it), time)
    }

    /// Whether an instance moves or its mesh is deformed.
    #[inline(always)]
    pub fn moves(&self, instance: InstanceId) -> bool {
        self.motion.as_ref().is_some_and(|motion| {
            let mesh = self.instances[instance.index()].mesh.index();
            motion.placement(instance.index()).is_some() || motion.deformation(mesh).is_some()
        })
    }

    /// A light at a time; `None` where its node has no directions then.
    #[inline]
    pub fn light_at(&self, light: usize, time: f32) -> Option<Punctual> {
        let still = &self.lights[light];
        let moves = self.motion.as_ref().and_then(|motion| motion.light(light));
        moves.map_or(Some(*still), |moving| moving.at(still, time))
    }

    /// Whether a light moves.
    #[inline]
    pub fn light_moves(&self, light: usize) -> bool {
        self.motion.as_ref().is_some_and(|motion| motion.light(light).is_some())
    }
}
