//! Where things are placed, in f64 until it is settled, and what may not be.

use glam::{DAffine3, DVec3, Mat3A};

use super::Instance;
use crate::files::memory::{self, TooMuch};
use crate::light::{Punctual, PunctualKind};
use crate::math::{Aabb, Affine3A, Vec3};
pub use crate::motion::rigid;

/// The most placed meshes: as many as ids tell apart.
pub const MAX_INSTANCES: u64 = u32::MAX as u64 - 1;

/// Why no more meshes can be placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoRoom {
    /// There are no ids for so many.
    #[error("{0} placed meshes are too many; {MAX_INSTANCES} at most")]
    TooMany(u64),
    /// Memory does not hold them.
    #[error("{0} placed meshes: their list {1}")]
    Memory(u64, TooMuch),
}

/// Makes room for `more` placed meshes; groups within groups multiply. The list takes what is asked
/// for, and no more where that is much.
///
/// # Errors
/// [`NoRoom`], before any memory is set aside.
pub fn make_room(instances: &mut Vec<Instance>, more: u64) -> Result<(), NoRoom> {
    let length = instances.len() as u64;
    let total = length.saturating_add(more);
    if total > MAX_INSTANCES {
        return Err(NoRoom::TooMany(total));
    }
    if total <= instances.capacity() as u64 {
        return Ok(());
    }
    // A few at a time are added to a list that doubles.
    let wanted = if more > length / 4 { total } else { length.saturating_mul(2) };
    let too_much = |error| NoRoom::Memory(total, error);
    memory::claim(wanted * size_of::<Instance>() as u64).map_err(too_much)?;
    instances.reserve_exact((wanted - length) as usize);
    Ok(())
}

/// A transform in f32.
pub fn narrow(to_world: &DAffine3) -> Affine3A {
    let DAffine3 { matrix3, translation } = *to_world;
    let [x, y, z] = [matrix3.x_axis, matrix3.y_axis, matrix3.z_axis].map(DVec3::as_vec3a);
    Affine3A { matrix3: Mat3A::from_cols(x, y, z), translation: translation.as_vec3a() }
}

/// A light at its node; its strength is not scaled with it. None if it has a direction and the
/// node's transform has none, as with a scale of 0, or a place beyond all numbers; a point light
/// needs but the position.
pub fn light_at_node(light: &Punctual, to_world: &DAffine3) -> Option<Punctual> {
    let rigid = rigid(to_world);
    let translation = to_world.translation;
    let to_world = match light.kind {
        PunctualKind::Point if translation.is_finite() => {
            rigid.unwrap_or(DAffine3::from_translation(translation))
        }
        _ => rigid?,
    };
    let position = to_world.translation.as_vec3();
    let direction = -to_world.matrix3.z_axis.as_vec3();
    stands(Punctual { position, direction, ..*light })
}

/// A light moved as all that is placed with it; none if it has a direction and that leaves it none.
pub fn light_moved(light: &Punctual, to_world: &DAffine3) -> Option<Punctual> {
    let turned = match light.kind {
        PunctualKind::Point if to_world.is_finite() => {
            rigid(to_world).unwrap_or(DAffine3::IDENTITY)
        }
        _ => rigid(to_world)?,
    };
    let position = to_world.transform_point3(light.position.as_dvec3()).as_vec3();
    let direction = turned.transform_vector3(light.direction.as_dvec3()).as_vec3();
    stands(Punctual { position, direction, ..*light })
}

/// A light, unless it is farther away than there are places; where that does not matter it stands
/// in the middle.
fn stands(light: Punctual) -> Option<Punctual> {
    match light.kind {
        _ if light.position.is_finite() => Some(light),
        PunctualKind::Directional => Some(Punctual { position: Vec3::ZERO, ..light }),
        PunctualKind::Point | PunctualKind::Spot { .. } => None,
    }
}

/// Whether all of a box can be placed without overflow, with room for what follows.
pub fn stays_finite(to_world: &DAffine3, bounds: Aabb) -> bool {
    let reach = bounds.min.abs().max(bounds.max.abs()).as_dvec3();
    let DAffine3 { matrix3, translation } = *to_world;
    let farthest = matrix3.x_axis.abs() * reach.x
        + matrix3.y_axis.abs() * reach.y
        + matrix3.z_axis.abs() * reach.z
        + translation.abs();
    let entries = matrix3.x_axis.abs().max(matrix3.y_axis.abs()).max(matrix3.z_axis.abs());
    let limit = DVec3::splat(f64::from(f32::MAX) / 4.0);
    farthest.cmple(limit).all() && entries.cmple(limit).all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_size_loses_scale_and_mirroring() {
        let mirrored = DAffine3::from_scale(DVec3::new(-2.0, 3.0, 4.0));
        assert_eq!(rigid(&mirrored), Some(DAffine3::IDENTITY));
        assert_eq!(rigid(&DAffine3::from_scale(DVec3::ZERO)), None);
    }

    /// Moved with a scale of 0, which leaves no directions, it stands where all is drawn to.
    #[test]
    fn a_point_light_needs_no_directions() {
        let mut light = Punctual {
            kind: PunctualKind::Point,
            position: Vec3::new(1.0, 2.0, 3.0),
            direction: Vec3::NEG_Y,
            intensity: Vec3::ONE,
            range: None,
        };
        let to_world = DAffine3 { translation: DVec3::X, ..DAffine3::from_scale(DVec3::ZERO) };
        let moved = light_moved(&light, &to_world).expect("shines");
        assert_eq!((moved.position, moved.direction), (Vec3::X, Vec3::NEG_Y));
        light.kind = PunctualKind::Directional;
        assert_eq!(light_moved(&light, &to_world), None);
        light.kind = PunctualKind::Point;
        assert_eq!(light_moved(&light, &DAffine3::from_scale(DVec3::INFINITY)), None);
    }

    #[test]
    fn room_is_made_or_refused_before_memory_is_taken() {
        let mut instances = Vec::new();
        assert_eq!(make_room(&mut instances, 5), Ok(()));
        assert_eq!(instances.capacity(), 5);
        let error = make_room(&mut instances, u64::MAX).expect_err("no ids");
        assert_eq!(error, NoRoom::TooMany(u64::MAX));
        assert_eq!(make_room(&mut instances, 0), Ok(()));
        assert_eq!(instances.capacity(), 5);
    }

    #[test]
    fn what_would_overflow_is_found_before_it_does() {
        let bounds = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(2.0) };
        let scaled = |scale| stays_finite(&DAffine3::from_scale(DVec3::splat(scale)), bounds);
        assert!(scaled(1e37));
        assert!(!scaled(1e38));
        assert!(!scaled(f64::INFINITY));
        assert!(!scaled(f64::NAN));
    }
}
