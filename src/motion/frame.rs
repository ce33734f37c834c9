//! What goes along with what: the blades on a hub that turns keep their places to each other.

use std::sync::Arc;

use glam::DAffine3;

use super::link::Link;
use super::path::Motion;

/// The moving space that something stands still in. Those that are equal are so at all times; they
/// are compared while the motions are there that they are of.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Frame(Vec<FrameLink>);

/// A transform of the chain that leads there.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum FrameLink {
    /// By its bits.
    Still([u64; 12]),
    /// By where it lies: what is animated once is kept once.
    Moving(usize),
}

impl Motion {
    /// The innermost space that moves, and where in that it leads.
    pub fn frame(&self) -> (Frame, DAffine3) {
        let (links, inner) = match self.links() {
            [links @ .., Link::Still(inner)] => (links, *inner),
            links => (links, DAffine3::IDENTITY),
        };
        let link = |link: &Link| match link {
            Link::Still(transform) => FrameLink::Still(transform.to_cols_array().map(f64::to_bits)),
            Link::Moving(parts) => FrameLink::Moving(Arc::as_ptr(parts).addr()),
        };
        (Frame(links.iter().map(link).collect()), inner)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use super::super::{MovingParts, Track};
    use super::*;

    #[test]
    fn what_is_put_around_the_same_motion_shares_its_frame() {
        let turn = [(0.0, DQuat::IDENTITY), (1.0, DQuat::from_rotation_z(1.0))];
        let hub = || {
            Arc::new(MovingParts {
                translation: Track::still(DVec3::ZERO),
                rotation: Track::new(&turn).expect("has keys"),
                scale: Track::still(DVec3::ONE),
            })
        };
        let shared = hub();
        let tilt = DAffine3::from_rotation_x(0.3);
        let motion = |tilt, hub: &Arc<MovingParts>| {
            Motion::new([Link::Still(tilt), Link::Moving(Arc::clone(hub))]).expect("it moves")
        };
        let hub_of = motion(tilt, &shared);
        let blade = |x: f64| hub_of.around(DAffine3::from_translation(DVec3::X * x));
        let (frame, inner) = hub_of.frame();
        assert_eq!((&frame, inner), (&blade(0.0).frame().0, DAffine3::IDENTITY));
        for x in [1.0, 2.0] {
            let (other, inner) = blade(x).frame();
            assert_eq!((&other, inner.translation), (&frame, DVec3::X * x));
            // It leads to the same place at all times.
            let at = hub_of.at(0.7) * inner;
            assert!(at.abs_diff_eq(blade(x).at(0.7), 1e-14));
        }
        assert_ne!(frame, motion(DAffine3::IDENTITY, &shared).frame().0);
        assert_ne!(frame, motion(tilt, &hub()).frame().0);
        assert_ne!(frame, hub_of.then(hub()).frame().0);
    }
}
