//! Where the time of a render goes.

use std::time::Instant;

/// What a worker does, one after the other, for each slice of paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Camera rays and their random numbers.
    Start,
    /// What the paths' rays hit.
    ClosestHits,
    /// Listing paths by what they have met, and taking out those that have ended.
    Sort,
    /// Paths that left the scene.
    Environment,
    /// Diffuse surfaces: geometry, light sampling and scattering, in lanes.
    Lambert,
    /// Metals and coated dielectrics: the same.
    MetallicRoughness,
    /// Smooth glass: the same, without light sampling.
    SmoothGlass,
    /// All other surfaces, one by one: emitters, rough glass, layers, normal maps.
    Others,
    /// What lies between surfaces and lights.
    ShadowRays,
    /// Adding samples to pixels.
    Film,
}

impl Stage {
    /// All, in order.
    pub const ALL: [Self; 10] = [
        Self::Start,
        Self::ClosestHits,
        Self::Sort,
        Self::Environment,
        Self::Lambert,
        Self::MetallicRoughness,
        Self::SmoothGlass,
        Self::Others,
        Self::ShadowRays,
        Self::Film,
    ];

    /// What a table calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Start => "start of paths",
            Self::ClosestHits => "closest hits",
            Self::Sort => "sorting",
            Self::Environment => "environment",
            Self::Lambert => "lambert",
            Self::MetallicRoughness => "metallic-roughness",
            Self::SmoothGlass => "smooth glass",
            Self::Others => "other surfaces",
            Self::ShadowRays => "shadow rays",
            Self::Film => "film",
        }
    }
}

/// The seconds of each stage, over all threads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Breakdown {
    seconds: [f64; Stage::ALL.len()],
}

impl Breakdown {
    /// The seconds of a stage.
    pub fn seconds(&self, stage: Stage) -> f64 {
        self.seconds[stage as usize]
    }

    /// The seconds of all stages.
    pub fn total(&self) -> f64 {
        self.seconds.iter().sum()
    }

    /// Adds the time since `start` to a stage; returns the time now.
    pub(super) fn add_since(&mut self, stage: Stage, start: Instant) -> Instant {
        let now = Instant::now();
        self.seconds[stage as usize] += (now - start).as_secs_f64();
        now
    }
}

impl std::ops::AddAssign for Breakdown {
    fn add_assign(&mut self, other: Self) {
        for (sum, seconds) in self.seconds.iter_mut().zip(other.seconds) {
            *sum += seconds;
        }
    }
}
