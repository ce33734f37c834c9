//! What is left of a transform of something without size.

use glam::{DAffine3, DMat3, DVec3};

use super::link::Link;

/// Where something stands that has no size, such as a camera: without scale, mirroring and shear,
/// looking along the node's -Z with its +Y up. None if the node has no such directions.
pub fn rigid(to_world: &DAffine3) -> Option<DAffine3> {
    let z = to_world.matrix3.z_axis.try_normalize()?;
    let x = to_world.matrix3.y_axis.cross(z).try_normalize()?;
    let matrix3 = DMat3::from_cols(x, z.cross(x), z);
    let translation = to_world.translation;
    (matrix3.is_finite() && translation.is_finite()).then_some(DAffine3 { matrix3, translation })
}

/// Whether nothing would be taken from the transform of a chain, at any time: its links turn and
/// move, to the rounding of f64, and nothing else.
pub fn are_rigid(links: &[Link]) -> bool {
    links.iter().all(|link| match link {
        Link::Still(transform) => {
            rigid(transform).is_some_and(|rigid| rigid.abs_diff_eq(*transform, 1e-14))
        }
        Link::Moving(parts) => !parts.scale.moves() && parts.scale.at(0.0) == DVec3::ONE,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_only_turns_and_moves_is_rigid() {
        let turned = DAffine3::from_rotation_x(2.0) * DAffine3::from_translation(DVec3::X * 3.0);
        let are = |link: DAffine3| are_rigid(&[Link::Still(turned), Link::Still(link)]);
        assert!(are(DAffine3::IDENTITY));
        assert!(!are(DAffine3::from_scale(DVec3::new(1.0, 1.0, 1.000_001))));
        assert!(!are(DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0))));
        assert!(!are(DAffine3::from_scale(DVec3::ZERO)));
    }
}
