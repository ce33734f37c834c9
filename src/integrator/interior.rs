//! The solids that a path is inside of.
//!
//! After Schmidt and Budge, "Simple Nested Dielectrics in Ray Traced Images", JGT 2002: where
//! solids overlap, the one of the highest priority is there, and borders of the others do nothing.
//! Of equal priorities the one entered last is there, which is right for what lies wholly inside of
//! another. Solids are told apart by their material: who enters the same one again has left it
//! unnoticed, through a hole.

use crate::math::MaterialId;
use crate::world::World;

/// How many solids may lie around a point; of more, those of the least priority are forgotten.
const DEPTH: usize = 4;

/// Solids by priority, the one that is there last; unused places come after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    media: [MaterialId; DEPTH],
}

impl Interior {
    /// Out in the open.
    pub const AIR: Self = Self { media: [MaterialId::NONE; DEPTH] };

    /// Within one solid.
    #[inline]
    pub fn of(id: MaterialId) -> Self {
        let mut media = Self::AIR.media;
        media[0] = id;
        Self { media }
    }

    /// Whether that solid alone is around.
    #[inline]
    pub fn is_only(&self, id: MaterialId) -> bool {
        *self == Self::of(id)
    }

    /// Whether there is nothing around.
    #[inline]
    pub fn is_air(&self) -> bool {
        self.media[0] == MaterialId::NONE
    }

    /// The solid that is there; [`MaterialId::NONE`]: air.
    #[inline]
    pub fn solid(&self) -> MaterialId {
        let used = self.media.iter().rev().find(|&&id| id != MaterialId::NONE);
        used.copied().unwrap_or(MaterialId::NONE)
    }

    /// Whether a solid is among them.
    pub fn contains(&self, id: MaterialId) -> bool {
        self.media.contains(&id)
    }

    /// Without one of them.
    pub fn without(&self, id: MaterialId) -> Self {
        let mut rest = Self::AIR;
        let kept = self.media.iter().filter(|&&medium| medium != id);
        for (place, &medium) in rest.media.iter_mut().zip(kept) {
            *place = medium;
        }
        rest
    }

    /// With one more, which is not yet among them.
    pub fn with(&self, id: MaterialId, priority: impl Fn(MaterialId) -> i32) -> Self {
        let mut media = self.media;
        let mut count = media.iter().filter(|&&medium| medium != MaterialId::NONE).count();
        if count == DEPTH {
            media.rotate_left(1);
            count -= 1;
        }
        let mut place = count;
        while place > 0 && priority(media[place - 1]) > priority(id) {
            media[place] = media[place - 1];
            place -= 1;
        }
        media[place] = id;
        Self { media }
    }

    /// What a path is inside of that meets the back of a solid's border: the solid at least, also
    /// if it never came in.
    pub fn behind(&self, id: MaterialId, world: &World) -> Self {
        if self.contains(id) {
            return *self;
        }
        // The border of what it is in is made of several materials, or it has started inside.
        self.without(self.solid()).with(id, |id| world.priority(id))
    }

    /// Whether a solid's border does nothing there, for who meets its front, or its back.
    pub fn hides(&self, id: MaterialId, front: bool, world: &World) -> bool {
        if front {
            let around = self.without(id).solid();
            around != MaterialId::NONE && world.priority(around) > world.priority(id)
        } else {
            self.solid() != id
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: MaterialId = MaterialId(1);
    const B: MaterialId = MaterialId(2);
    const C: MaterialId = MaterialId(3);

    #[test]
    fn the_last_entered_of_equals_is_there() {
        let equal = |_| 0;
        let both = Interior::AIR.with(A, equal).with(B, equal);
        assert_eq!(both.solid(), B);
        assert_eq!(both.without(B).solid(), A);
        assert_eq!(both.without(A).solid(), B);
        assert!(both.without(A).without(B).is_air());
    }

    #[test]
    fn priorities_come_first() {
        let priority = |id: MaterialId| if id == A { 2 } else { 1 };
        let all = Interior::AIR.with(A, priority).with(B, priority).with(C, priority);
        assert_eq!(all.solid(), A);
        assert_eq!(all.without(A).solid(), C);
        assert_eq!(all.without(A).without(C).solid(), B);
    }

    #[test]
    fn of_too_many_the_least_is_forgotten() {
        let all = (1..=5).fold(Interior::AIR, |all, i| all.with(MaterialId(i), |_| 0));
        assert!(!all.contains(MaterialId(1)));
        assert_eq!(all.solid(), MaterialId(5));
    }
}
