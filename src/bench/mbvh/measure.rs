//! The measuring of a scene.

use std::sync::Arc;

use super::figures::{Cache, Incoherence, Rates, Scene, Structure};
use super::paper;
use super::structures::{AUTO, INCOHERENCE, INCOHERENT, Mode, PACKETS, STRUCTURES};
use crate::accel::{Accel, AccelSpec, BuildError, build};
use crate::bench::measure::{Ask, BenchError, Measured, Shots, time_interleaved};
use crate::bench::ray_sets::{RaySet, Target};
use crate::geom::TriangleSource;
use crate::simd::Isa;

/// Rays that are asked about at once.
const SLICE: usize = 4096;
/// Sides of a packet of figure 4.
const PACKET: (u32, u32) = (16, 16);
/// Figure 4 shoots this part of the rays at each degree of incoherence.
const PART: usize = 10;

/// What to measure with.
#[derive(Clone, Copy, Debug)]
pub struct MbvhBenchSettings {
    /// Rays of each kind.
    pub rays: usize,
    /// Passes of each structure; the median counts.
    pub rounds: usize,
    /// The builder, as the option `build` names it.
    pub build: &'static str,
    /// Whether trees are refined.
    pub refine: bool,
    /// Bytes that all may take by the estimate.
    pub memory: u64,
    /// The instruction set.
    pub isa: Isa,
}

/// Bytes that a scene's structures and rays may take.
fn estimate(triangles: usize, rays: usize) -> u64 {
    triangles as u64 * 900 + rays as u64 * 120
}

/// Measures a scene. `caches`: whether table 3 is wanted; `tell` is told what is being done.
///
/// # Errors
/// If a structure can't be built or would not fit, or disagrees with `bvh2`.
pub fn measure(
    name: &str,
    source: &Arc<dyn TriangleSource>,
    caches: bool,
    settings: &MbvhBenchSettings,
    tell: &dyn Fn(&str),
) -> Result<Scene, BenchError> {
    let needed = estimate(source.len(), settings.rays);
    if needed > settings.memory {
        return Err(BuildError::TooLarge { needed, limit: settings.memory }.into());
    }
    let built = |id: &str, options: &str| {
        tell(&format!("{name}: building {id}, {options}"));
        let refine = if settings.refine { "on" } else { "off" };
        let text = match id {
            AUTO => id.to_owned(),
            id => format!("{id}:build={},refine={refine},{options}", settings.build),
        };
        let spec: AccelSpec = text.parse().expect("options that the table has");
        build(&spec, Arc::clone(source), settings.isa)
    };
    let accels = STRUCTURES.map(|(id, _, mode)| built(id, &format!("triangles={}", mode.name())));
    let accels = accels.into_iter().collect::<Result<Vec<_>, _>>()?;
    let target = Target::new(&**source, &*accels[0]);

    let shoot = |set: RaySet, ask: Ask, accels: &[(String, &dyn Accel)]| {
        let rays = target.rays(set, settings.rays, 1);
        tell(&format!("{name}: {} rays", set.name()));
        measure_rates(&Shots::new(&rays, ask, SLICE), set.name(), accels, settings.rounds)
    };
    let of_table: Vec<_> = STRUCTURES
        .iter()
        .zip(&accels)
        .map(|((id, _, mode), accel)| (format!("{id}:triangles={}", mode.name()), &**accel))
        .collect();
    let closest = shoot(RaySet::Random, Ask::Closest, &of_table)?;
    let shadow = shoot(RaySet::Shadow, Ask::Any, &of_table)?;
    let structures = STRUCTURES.iter().zip(&accels).zip(closest.into_iter().zip(shadow));
    let structures = structures.map(|((&(id, width, mode), accel), (closest, shadow))| Structure {
        id,
        width,
        mode,
        report: accel.report().clone(),
        bytes: accel.memory().total(),
        closest,
        shadow,
    });
    let structures = structures.collect();
    let packets = built(PACKETS, "triangles=inline")?;
    tell(&format!("{name}: packets"));
    let incoherence = measure_incoherence(&target, &accels, &*packets, settings)?;
    drop(packets);

    let caches = if caches { measure_caches(&built, &shoot)? } else { Vec::new() };
    let (name, triangles) = (name.to_owned(), source.len());
    Ok(Scene { name, triangles, structures, caches, incoherence })
}

/// Builds a structure of an id with options.
type Build<'a> = dyn Fn(&str, &str) -> Result<Box<dyn Accel>, BuildError> + 'a;

/// Table 3, by functions that build a structure with some options and that shoot rays at several.
fn measure_caches(build: &Build<'_>, shoot: &ShootFn<'_>) -> Result<Vec<Cache>, BenchError> {
    let sized = paper::CACHES.map(|(megabytes, ..)| {
        let accel = build("mbvh4", &format!("triangles=cache,cache={megabytes}MB"))?;
        Ok((format!("mbvh4:cache={megabytes}MB"), accel))
    });
    let sized = sized.into_iter().collect::<Result<Vec<_>, BuildError>>()?;
    let sized: Vec<_> = sized.iter().map(|(spec, accel)| (spec.clone(), &**accel)).collect();
    let rates = shoot(RaySet::Random, Ask::Closest, &sized)?;
    let rows = paper::CACHES.iter().zip(rates);
    Ok(rows.map(|(&(megabytes, ..), closest)| Cache { megabytes, closest }).collect())
}

/// Shoots a set of rays at structures, given with their names.
type ShootFn<'a> =
    dyn Fn(RaySet, Ask, &[(String, &dyn Accel)]) -> Result<Vec<Rates>, BenchError> + 'a;

/// Compares all to the first, counts their work and times them, by slices and ray by ray.
fn measure_rates(
    shots: &Shots<'_>,
    set: &'static str,
    accels: &[(String, &dyn Accel)],
    rounds: usize,
) -> Result<Vec<Rates>, BenchError> {
    let expected = shots.trace(accels[0].1);
    for (spec, accel) in &accels[1..] {
        shots.trace(*accel).check(&expected, spec, &accels[0].0, set)?;
    }
    let single = Shots { slice: 1, ..*shots };
    let time = |shots: &Shots<'_>| {
        time_interleaved(accels.len(), rounds, |i| Ok::<_, BenchError>(shots.time(accels[i].1)))
    };
    let (by_slices, ray_by_ray) = (time(shots)?, time(&single)?);
    let rates = accels.iter().zip(by_slices.into_iter().zip(ray_by_ray));
    let rates = rates.map(|((_, accel), (slices, ray_by_ray))| {
        let counts = single.count_work(*accel);
        let of = |seconds| Measured { counts, rays: shots.rays.len(), seconds };
        Rates { single: of(ray_by_ray), slices: of(slices) }
    });
    Ok(rates.collect())
}

/// Figure 4.
fn measure_incoherence(
    target: &Target<'_>,
    accels: &[Box<dyn Accel>],
    packet: &dyn Accel,
    settings: &MbvhBenchSettings,
) -> Result<Vec<Incoherence>, BenchError> {
    let size = (PACKET.0 * PACKET.1) as usize;
    let packets = (settings.rays / PART).div_ceil(size).max(1);
    let inline = |wanted: &str| {
        if wanted == PACKETS {
            return packet;
        }
        let found = STRUCTURES.iter().zip(accels);
        let found = found.filter(|((id, _, mode), _)| *id == wanted && *mode == Mode::Inline);
        found.map(|(_, accel)| &**accel).next().expect("is among the structures")
    };
    let accels = INCOHERENT.map(inline);
    let mut rows = Vec::new();
    for factor in INCOHERENCE {
        let rays = target.packets(factor, packets, size, 1);
        let shots = Shots { grid: Some(PACKET), ..Shots::new(&rays, Ask::Closest, size) };
        let expected = shots.trace(accels[0]);
        for (id, accel) in INCOHERENT.iter().zip(accels).skip(1) {
            shots.trace(accel).check(&expected, id, INCOHERENT[0], "packet")?;
        }
        let seconds = time_interleaved(accels.len(), settings.rounds, |i| {
            Ok::<_, BenchError>(shots.time(accels[i]))
        })?;
        let rate = |seconds: f64| rays.len() as f64 * 1e-6 / seconds.max(1e-9);
        rows.push(Incoherence { factor, rates: seconds.into_iter().map(rate).collect() });
    }
    Ok(rows)
}
