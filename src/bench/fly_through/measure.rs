//! The measuring of a scene, all of it.

use std::sync::Arc;

use super::bench::{Bench, FlyThroughBenchSettings, Named, borrowed};
use super::figures::Scene;
use super::lights;
use super::structures::{ACROSS, STRUCTURES};
use crate::accel::BuildError;
use crate::bench::measure::BenchError;
use crate::camera::flight::Pose;
use crate::geom::TriangleSource;

/// Bytes that a scene's structures and rays may take.
fn estimate(triangles: usize, rays: usize) -> u64 {
    triangles as u64 * 1200 + rays as u64 * 160
}

/// Measures a flight over a scene; `tell` is told what is being done.
///
/// # Errors
/// If a structure can't be built or would not fit, or disagrees with `bvh-packet`.
pub fn measure(
    name: &str,
    source: &Arc<dyn TriangleSource>,
    flight: &[Pose],
    settings: &FlyThroughBenchSettings,
    tell: &dyn Fn(&str),
) -> Result<Scene, BenchError> {
    let rays = settings.resolution.0 as usize * settings.resolution.1 as usize;
    let needed = estimate(source.len(), rays);
    if needed > settings.memory {
        return Err(BuildError::TooLarge { needed, limit: settings.memory }.into());
    }
    let flight = spread(flight, settings.frames);
    let bench = Bench { name, source, flight, settings, tell };
    let built = STRUCTURES.map(|(_, id, options)| bench.build(id, options));
    let built = built.into_iter().collect::<Result<Vec<Named>, _>>()?;
    let (columns, covered) =
        bench.measure_columns(ACROSS, &built.iter().map(borrowed).collect::<Vec<_>>())?;
    let compressing = bench.time_compressing(&built)?;
    let tilings = bench.measure_tilings(&built, &columns)?;
    let lights = lights::measure(&bench, &built)?;
    let memory = built[0].1.memory();
    let nodes = memory.parts.iter().filter(|(part, _)| *part == "nodes").map(|(_, bytes)| bytes);
    Ok(Scene {
        name: name.to_owned(),
        triangles: source.len(),
        rays,
        covered,
        bytes: [nodes.sum(), memory.total()],
        columns,
        tilings,
        compressing,
        lights,
    })
}

/// At most so many of a flight's cameras, evenly.
pub(super) fn spread(flight: &[Pose], most: usize) -> Vec<Pose> {
    let count = flight.len().min(most);
    (0..count).map(|i| flight[(2 * i + 1) * flight.len() / (2 * count)]).collect()
}
