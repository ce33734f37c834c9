//! A chain of transforms over time.

use std::sync::{Arc, OnceLock};

use glam::DAffine3;

use super::course::Course;
use super::link::{Link, MovingParts};
use super::rigid::{are_rigid, rigid};

/// A chain of transforms, of which at least one changes while the shutter is open.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The outermost first.
    links: Vec<Link>,
    /// The same prepared, if it can be; found when it is asked for.
    course: OnceLock<Option<Arc<Course>>>,
    /// What was put around it since then.
    outer: Option<DAffine3>,
    /// Whether it only turns and moves.
    is_rigid: bool,
}

/// The shutter closes at 1; what jumps there has not done so yet.
const LAST: f64 = 1.0_f64.next_down();

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
        links.iter().any(Link::moves).then(|| Self::of(links))
    }

    fn of(links: Vec<Link>) -> Self {
        let is_rigid = are_rigid(&links);
        Self { links, course: OnceLock::new(), outer: None, is_rigid }
    }

    /// The same in a space that stands still in another. Both share what is prepared.
    #[must_use]
    pub fn within(&self, outer: DAffine3) -> Self {
        let mut links = self.links.clone();
        match links.first_mut() {
            Some(Link::Still(first)) => *first = outer * *first,
            _ => links.insert(0, Link::Still(outer)),
        }
        let course = OnceLock::from(self.course().cloned());
        let outer = Some(self.outer.map_or(outer, |inner| outer * inner));
        Self { course, outer, ..Self::of(links) }
    }

    /// The same of what stands still in the moving space.
    #[must_use]
    pub fn around(&self, inner: DAffine3) -> Self {
        let mut links = self.links.clone();
        match links.last_mut() {
            Some(Link::Still(last)) => *last *= inner,
            _ => links.push(Link::Still(inner)),
        }
        Self::of(links)
    }

    /// The same of what moves in the moving space.
    #[must_use]
    pub fn then(&self, inner: Arc<MovingParts>) -> Self {
        let mut links = self.links.clone();
        links.push(Link::Moving(inner));
        Self::of(links)
    }

    /// The transforms, the outermost first.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    #[inline]
    fn course(&self) -> Option<&Arc<Course>> {
        self.course.get_or_init(|| Course::new(&self.links).map(Arc::new)).as_ref()
    }

    /// About how many bytes it takes, with what is prepared.
    pub fn bytes(&self) -> usize {
        let links = size_of::<Self>() + size_of_val(&*self.links);
        links + self.course().map_or(0, |course| course.bytes())
    }

    /// The whole transform at a time from 0 to 1.
    #[inline]
    pub fn at(&self, time: f64) -> DAffine3 {
        let time = time.min(LAST);
        if let Some(course) = self.course() {
            let at = course.at(time);
            return self.outer.map_or(at, |outer| outer * at);
        }
        let [first, rest @ ..] = &self.links[..] else { return DAffine3::IDENTITY };
        rest.iter().fold(first.at(time), |outer, link| outer * link.at(time))
    }

    /// Where something stands that has no size, at a `time` from 0 to 1; see [`rigid`].
    #[inline]
    pub fn rigid_at(&self, time: f32) -> Option<DAffine3> {
        let to_world = self.at(f64::from(time));
        let stays = self.is_rigid && to_world.is_finite();
        if stays { Some(to_world) } else { rigid(&to_world) }
    }

    /// The times from 0 to 1 at which any track changes its way, with both ends, in order.
    pub fn times(&self) -> Vec<f64> {
        let mut times = vec![0.0, 1.0];
        for link in &self.links {
            if let Link::Moving(parts) = link {
                times.extend(parts.times());
            }
        }
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        times
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use super::super::Track;
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
