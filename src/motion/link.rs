//! A transform of a chain, still or moving.

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

    /// The times from 0 to 1 at which any part changes its way, in no order.
    pub fn times(&self) -> impl Iterator<Item = f64> + '_ {
        let translations = self.translation.times();
        translations.chain(self.rotation.times()).chain(self.scale.times())
    }

    /// The transform at a time.
    #[inline]
    pub fn at(&self, time: f64) -> DAffine3 {
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

impl Link {
    /// Whether it changes while the shutter is open.
    pub fn moves(&self) -> bool {
        matches!(self, Self::Moving(parts) if parts.moves())
    }

    /// The transform at a time.
    #[inline]
    pub fn at(&self, time: f64) -> DAffine3 {
        match self {
            Self::Still(transform) => *transform,
            Self::Moving(parts) => parts.at(time),
        }
    }
}
