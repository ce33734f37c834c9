//! The state of a path, and what goes in and out at its vertices.

use super::cone::Cone;
use super::dimensions::TIME_DIMENSION;
use super::interior::Interior;
use super::transit::Transit;
use crate::light::LightSampleContext;
use crate::material::Wavelength;
use crate::math::{MaterialId, Ray, Vec3};
use crate::sampling::StreamId;

/// A path under way; its current ray is kept beside it, in a slice for the tracer.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// See [`Path::throughput`].
    pub(super) throughput: Vec3,
    /// Square of the product of relative indices of refraction that it has passed.
    pub(super) eta_squared: f32,
    /// Where the current ray began, as lights were sampled there.
    pub(super) context: LightSampleContext,
    /// Density over solid angle with which the current ray's direction was sampled; infinite where
    /// no light could have been sampled in that direction.
    pub(super) pdf: f32,
    /// How wide it is, where textures have levels.
    pub(super) cone: Cone,
    /// The solids that it travels in.
    pub(super) interior: Interior,
    /// Of each colour, the density with which it would have drawn the path's legs in media, over
    /// their mean; see [`crate::medium::FreeFlight`].
    pub(super) densities: Vec3,
    /// How many of its segments ended where nothing happens: at borders that it passed straight.
    pub(super) passed: u32,
    /// The wavelength of the light that it follows, once it has met a surface that disperses.
    pub(super) wavelength: Option<Wavelength>,
    /// The random numbers of its sample.
    pub(super) stream: StreamId,
    /// Where its result goes.
    pub slot: u32,
    /// When all of it takes place, while the shutter is open: from 0 to 1.
    pub time: f32,
    /// A hash of pixel, sample and seed.
    pub key: u64,
}

/// What a path has brought back.
#[derive(Clone, Copy, Debug, Default)]
pub struct PathSample {
    /// Radiance at the camera.
    pub radiance: Vec3,
    /// What the camera ray hit first.
    pub first: Option<FirstHit>,
}

/// What the camera sees, apart from its light: the first surface, but albedo and normal are those
/// of what is seen in mirrors and through what is clear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// The share of light that the surface scatters, times the tint of mirrors and glass before it;
    /// of the environment seen there, its light, at most one.
    pub albedo: Vec3,
    /// Unit shading normal, world space, towards the side that is seen; zero for the environment.
    pub normal: Vec3,
    /// World space.
    pub position: Vec3,
    /// Metres from the camera ray's origin.
    pub distance: f32,
    /// Whether all surfaces so far are mirrors or clear, so that albedo and normal may change.
    pub goes_on: bool,
}

/// A segment which, if it is free, lets light through to the path.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// The segment.
    pub ray: Ray,
    /// What is added to the path's radiance if nothing is in the way.
    pub radiance: Vec3,
}

/// How the light that was sampled gets to its vertex, if it does.
#[derive(Clone, Copy, Debug)]
pub enum Direct {
    /// By a segment that must be free.
    Ray(ShadowRay),
    /// Through borders.
    Transit(Transit),
}

/// What follows from a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// The ray to a light.
    pub shadow: Option<ShadowRay>,
    /// Light on its way through borders, instead of a ray.
    pub transit: Option<Transit>,
    /// The ray to go on with; `None`: the path ends.
    pub next: Option<Ray>,
}

impl Step {
    /// The path ends, and asks for no light.
    pub(super) const END: Self = Self { shadow: None, transit: None, next: None };

    /// The path asks for light, perhaps, and goes on, perhaps.
    #[inline(always)]
    pub(super) fn new(direct: Option<Direct>, next: Option<Ray>) -> Self {
        match direct {
            Some(Direct::Ray(ray)) => Self { shadow: Some(ray), transit: None, next },
            Some(Direct::Transit(transit)) => Self { shadow: None, transit: Some(transit), next },
            None => Self { shadow: None, transit: None, next },
        }
    }
}

impl Path {
    /// A path that starts at the camera, at time 0. `stream` is that of its sample.
    #[inline(always)]
    pub fn new(stream: StreamId, key: u64, slot: u32) -> Self {
        Self {
            throughput: Vec3::ONE,
            eta_squared: 1.0,
            context: LightSampleContext { position: Vec3::ZERO, normal: Vec3::ZERO },
            pdf: f32::INFINITY,
            cone: Cone::default(),
            interior: Interior::AIR,
            densities: Vec3::ONE,
            passed: 0,
            wavelength: None,
            stream,
            slot,
            time: 0.0,
            key,
        }
    }

    /// The same at a time.
    #[inline(always)]
    #[must_use]
    pub fn at(self, time: f32) -> Self {
        Self { time, ..self }
    }

    /// The same at the time that its stream tells.
    #[inline(always)]
    #[must_use]
    pub fn at_its_time(self) -> Self {
        self.at(self.stream.at(TIME_DIMENSION).next_1d())
    }

    /// The number of vertices up to the end of segment number `depth`, that one with them: segments
    /// that ended where nothing happens do not count.
    #[inline(always)]
    pub(super) fn vertices(&self, depth: u32) -> u32 {
        depth - self.passed
    }

    /// Whether any of its segments so far do not count.
    #[inline(always)]
    pub fn has_passed(&self) -> bool {
        self.passed > 0
    }

    /// Puts it inside of solids, where it starts.
    pub fn start_in(&mut self, interior: Interior) {
        self.interior = interior;
    }

    /// Lets it begin as wide as a pixel; see
    /// [`Camera::pixel_cone`](crate::camera::Camera::pixel_cone).
    pub fn set_cone(&mut self, [width, spread]: [f32; 2]) {
        self.cone = Cone { width, spread, ..Cone::default() };
    }

    /// Lets it widen along a segment of length `t`.
    pub fn widen(&mut self, t: f32) {
        self.cone.widen(self.pdf, t);
    }

    /// Takes it across a border that it passes straight.
    pub(super) fn pass_border(&mut self) {
        self.passed += 1;
        self.cone.goes_straight = true;
    }

    /// How far a point of its current ray at `t` is from its last vertex, or from the camera.
    pub(super) fn distance_to(&self, point: Vec3, t: f32) -> f32 {
        if self.passed > 0 { (point - self.context.position).length() } else { t }
    }

    /// Ends its current ray, which is `t` metres long, at the point `at` along it.
    pub(super) fn end_at(&mut self, at: f32, t: f32) {
        self.cone.end_at(at, t);
    }

    /// How wide it is at the end of its current ray, once it is widened; metres.
    pub fn width(&self) -> f32 {
        self.cone.width
    }

    /// Whether it is inside of no solid.
    #[inline(always)]
    pub fn is_in_air(&self) -> bool {
        self.interior.is_air()
    }

    /// Whether it is inside of that solid and of no other.
    #[inline(always)]
    pub fn is_only_in(&self, id: MaterialId) -> bool {
        self.interior.is_only(id)
    }

    /// The share of the light at the current ray's end that reaches the camera, over the
    /// probability of having come here.
    pub fn throughput(&self) -> Vec3 {
        self.throughput
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Streams hold thousands of paths, and move all of them at each bounce.
    #[test]
    fn a_path_is_two_lines_of_the_cache() {
        assert!(size_of::<Path>() <= 128, "{}", size_of::<Path>());
    }
}
