//! A camera that may move while the shutter is open.

use std::sync::Arc;

use super::{Camera, CameraRays};
use crate::math::{Affine3A, Ray, Vec2, Vec3};
use crate::motion::Motion;

/// A camera, and how its node moves while the shutter is open, if it does.
#[derive(Clone, Debug)]
pub struct MovingCamera {
    /// The camera as it is at time 0.
    pub camera: Camera,
    /// The motion of its node.
    pub motion: Option<Arc<Motion>>,
}

impl From<Camera> for MovingCamera {
    fn from(camera: Camera) -> Self {
        Self { camera, motion: None }
    }
}

impl From<&Camera> for MovingCamera {
    fn from(camera: &Camera) -> Self {
        Self::from(*camera)
    }
}

impl From<&MovingCamera> for MovingCamera {
    fn from(camera: &MovingCamera) -> Self {
        camera.clone()
    }
}

impl MovingCamera {
    /// Prepares the camera for a film of that aspect.
    pub fn rays(&self, aspect: f32) -> CameraRays {
        CameraRays { motion: self.motion.clone(), ..self.camera.rays(aspect) }
    }
}

impl CameraRays {
    /// See [`Camera::ray`]; at a `time` of the shutter, from 0 to 1. [`Ray::MISS`] where the
    /// camera's node has no directions then.
    #[inline(always)]
    pub fn ray_at(&self, film: Vec2, lens: Vec2, time: f32) -> Ray {
        let Some(motion) = &self.motion else { return self.ray(film, lens) };
        let Some(to_world) = motion.rigid_at(time) else { return Ray::MISS };
        let to_world = to_world.to_cols_array().map(|x| x as f32);
        self.ray_from(&Affine3A::from_cols_array(&to_world), film, lens)
    }

    /// Where the camera stands at a `time` of the shutter: the pinhole, the middle of the lens, or
    /// that of the film.
    pub fn centre_at(&self, time: f32) -> Vec3 {
        let moved = self.motion.as_ref().and_then(|motion| motion.rigid_at(time));
        moved.map_or(self.camera.to_world.translation.into(), |it| it.translation.as_vec3())
    }
}
