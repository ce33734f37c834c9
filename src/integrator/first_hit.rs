//! What the camera sees, apart from its light: the surface that a path meets first, and in what
//! mirrors or is clear the one that is seen there.

use super::state::{FirstHit, Path, PathSample};
use crate::material::Bsdf;
use crate::math::Vec3;
use crate::medium::Medium;
use crate::world::{Surface, World};

/// Takes note of the surface at the end of a camera ray, which is `distance` long.
pub fn describe_first_hit(surface: &Surface, bsdf: &Bsdf, distance: f32, sample: &mut PathSample) {
    sample.first = Some(FirstHit {
        albedo: bsdf.albedo(),
        normal: facing_normal(surface),
        position: surface.position,
        distance,
        goes_on: bsdf.is_mirror_like(),
    });
}

/// Takes note of a surface behind others, if those before are mirrors or clear.
#[inline(always)]
pub fn follow_first_hit(path: &Path, surface: &Surface, bsdf: &Bsdf, sample: &mut PathSample) {
    if let Some(first) = sample.first.as_mut().filter(|first| first.goes_on) {
        let normal = facing_normal(surface);
        first.follow(path.throughput, bsdf.albedo(), normal, bsdf.is_mirror_like());
    }
}

/// Takes note of what the camera sees where a path scatters in a medium, at a point of that
/// distance, on a side that faces the normal: the surface that would have been `seen` but for that,
/// if it is the first one; of a medium behind what mirrors or is clear its albedo.
pub fn end_first_hit_in_medium(
    path: &Path,
    medium: &Medium,
    (position, distance, normal): (Vec3, f32, Vec3),
    seen: Option<(&Surface, Bsdf, f32)>,
    sample: &mut PathSample,
) {
    let albedo = medium.albedo();
    match (&mut sample.first, seen) {
        (Some(first), _) if first.goes_on => {
            first.follow(path.throughput, albedo, first.normal, false);
        }
        (Some(_), _) => {}
        (None, Some((surface, bsdf, distance))) => {
            describe_first_hit(surface, &bsdf, distance, sample);
            sample.first = sample.first.map(|first| FirstHit { goes_on: false, ..first });
        }
        (None, None) => {
            sample.first = Some(FirstHit { albedo, normal, position, distance, goes_on: false });
        }
    }
}

/// Takes note of the surroundings in a direction, if all surfaces before are mirrors or clear.
pub fn follow_to_environment(world: &World, path: &Path, direction: Vec3, sample: &mut PathSample) {
    if let Some(first) = sample.first.as_mut().filter(|first| first.goes_on)
        && world.scene.environment.is_some()
    {
        let (radiance, _) = world.environment(direction);
        first.follow_to_environment(path.throughput, radiance);
    }
}

impl FirstHit {
    /// Takes the albedo and the normal of a surface that is seen by way of those so far, of which
    /// `throughput` is the tint. `goes_on`: it mirrors or is clear, too.
    #[inline(always)]
    pub(super) fn follow(&mut self, throughput: Vec3, albedo: Vec3, normal: Vec3, goes_on: bool) {
        (self.albedo, self.normal, self.goes_on) = (throughput * albedo, normal, goes_on);
    }

    /// Takes the light of the surroundings for an albedo; they have no normal.
    #[inline(always)]
    pub(super) fn follow_to_environment(&mut self, throughput: Vec3, radiance: Vec3) {
        self.follow(throughput, radiance.min(Vec3::ONE), Vec3::ZERO, false);
    }
}

/// The shading normal on the side of the path.
fn facing_normal(surface: &Surface) -> Vec3 {
    let side = if surface.front { 1.0 } else { -1.0 };
    surface.frame.normal * side
}
