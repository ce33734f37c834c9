//! A chain of transforms over time.

use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};

use super::track::Track;

/// A transform made of parts that change.
#[derive(Clone, Debug)]
pub struct MovingParts {
    /// Done last.
    pub translation: Track<DVec3>,
    /// Of unit length.
    pub rotation: Track<DQuat>,
    /// Done first.
    pub scale: Track<DVec3>,
}

impl MovingParts {
    /// Whether any changes.
    pub fn moves(&self) -> bool {
        self.translation.moves() || self.rotation.moves() || self.scale.moves()
    }

    #[inline]
    fn at(&self, time: f64) -> DAffine3 {
        let (scale, rotation) = (self.scale.at(time), self.rotation.at(time));
        DAffine3::from_scale_rotation_translation(scale, rotation, self.translation.at(time))
    }
}

/// A transform of a chain.
#[derive(Clone, Debug)]
pub enum Link {
    /// It stays.
    Still(DAffine3),
    /// It changes.
    Moving(Arc<MovingParts>),
}

/// A chain of transforms, of which at least one changes while the shutter is open.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The outermost first.
    links: Vec<Link>,
}

impl Motion {
    /// A chain, the outermost transform first; `None` if nothing changes.
    pub fn new(chain: impl IntoIterator<Item = Link>) -> Option<Self> {
        let mut links: Vec<Link> = Vec::new();
        for link in chain {
            match (links.last_mut(), link) {
                (Some(Link::Still(before)), Link::Still(next)) => *before *= next,
                (_, link) => links.push(link),
            }
        }
        let moves = |link: &Link| matches!(link, Link::Moving(parts) if parts.moves());
        links.iter().any(moves).then_some(Self { links })
    }

    /// The same in a space that stands still in another.
    #[must_use]
    pub fn within(&self, outer: DAffine3) -> Self {
        let mut links = self.links.clone();
        match links.first_mut() {
            Some(Link::Still(first)) => *first = outer * *first,
            _ => links.insert(0, Link::Still(outer)),
        }
        Self { links }
    }

    /// The same of what stands still in the moving space.
    #[must_use]
    pub fn around(&self, inner: DAffine3) -> Self {
        let mut links = self.links.clone();
        match links.last_mut() {
            Some(Link::Still(last)) => *last *= inner,
            _ => links.push(Link::Still(inner)),
        }
        Self { links }
    }

    /// The same of what moves in the moving space.
    #[must_use]
    pub fn then(&self, inner: Arc<MovingParts>) -> Self {
        let mut links = self.links.clone();
        links.push(Link::Moving(inner));
        Self { links }
    }

    /// The transforms, the outermost first.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// The whole transform at a time.
    #[inline]
    pub fn at(&self, time: f64) -> DAffine3 {
        let at = |link: &Link| match link {
            Link::Still(transform) => *transform,
            Link::Moving(parts) => parts.at(time),
        };
        let [first, rest @ ..] = &self.links[..] else { return DAffine3::IDENTITY };
        rest.iter().fold(at(first), |outer, link| outer * at(link))
    }

    /// The times from 0 to 1 at which any track changes its way, with both ends, in order.
    pub fn times(&self) -> Vec<f64> {
        let mut times = vec![0.0, 1.0];
        for link in &self.links {
            if let Link::Moving(parts) = link {
                times.extend(parts.translation.times());
                times.extend(parts.rotation.times());
                times.extend(parts.scale.times());
            }
        }
        times.retain(|time| (0.0..=1.0).contains(time));
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        times
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_are_evaluated_at_the_time_itself() {
        let turn = |degrees: f64| DQuat::from_rotation_z(degrees.to_radians());
        let key = |i: i32| (f64::from(i) / 9.0, turn(f64::from(i) * 120.0));
        let keys: Vec<_> = (0..=9).map(key).collect();
        let parts = MovingParts {
            translation: Track::still(DVec3::X),
            rotation: Track::new(&keys).expect("has keys"),
            scale: Track::still(DVec3::ONE),
        };
        let links = [
            Link::Still(DAffine3::from_translation(DVec3::Y)),
            Link::Moving(Arc::new(parts)),
            Link::Still(DAffine3::from_scale(DVec3::splat(2.0))),
        ];
        let motion = Motion::new(links).expect("moves");
        for step in 0..100 {
            let time = f64::from(step) / 100.0;
            let found = motion.at(time).transform_point3(DVec3::X);
            let (sine, cosine) = libm::sincos((time * 1080.0).to_radians());
            let expected = DVec3::new(1.0 + 2.0 * cosine, 1.0 + 2.0 * sine, 0.0);
            assert!(found.distance(expected) < 1e-12, "{found} at {time}");
        }
        assert_eq!(motion.times().len(), 10);
        let moved = motion.within(DAffine3::from_translation(DVec3::Z)).at(0.0).translation;
        assert_eq!(moved, DVec3::new(1.0, 1.0, 1.0));
        assert!(Motion::new([Link::Still(DAffine3::IDENTITY)]).is_none());
    }
}
