//! Binary and multi bounding volume hierarchies side by side: the tables of M. Ernst and
//! G. Greiner, "Multi bounding volume hierarchies", 2008, measured.
//!
//! All on the calling thread, in a pool of one. The rays run between random points of the scene's
//! box. The structures of a scene are built first and held against `bvh2`; then passes are timed by
//! turns ([`interleaved`]), each with a fresh tracer, so that caches begin empty.

mod json;
pub mod paper;
mod tables;

use std::sync::Arc;

use super::measure::{Ask, BenchError, Measured, Shots, interleaved};
use super::ray_sets::{RaySet, Target};
use crate::accel::{Accel, AccelSpec, BuildError, BuildReport, build};
use crate::geom::TriangleSource;
use crate::simd::Isa;

pub use json::json;
pub use tables::{incoherence_plot, scaling_plot, tables};

/// The structures: with references and a cache of 100 MB, as in the paper, then with triangles in
/// the leaves. `bvh2` is the one that its mode's others are compared to. `auto` is built as it
/// likes.
const STRUCTURES: [(&str, usize, Mode); 7] = [
    ("bvh2", 2, Mode::Cache),
    ("mbvh4", 4, Mode::Cache),
    ("bvh2", 2, Mode::Inline),
    ("mbvh4", 4, Mode::Inline),
    ("mbvh8", 8, Mode::Inline),
    ("mbvh16", 16, Mode::Inline),
    (AUTO, 8, Mode::Inline),
];

/// The default of renders.
const AUTO: &str = "auto";

/// Those of figure 4, which all store their triangles: its columns and curves.
const INCOHERENT: [&str; 4] = ["bvh2", "mbvh4", "mbvh8", PACKETS];
/// Traces packets of rays together.
const PACKETS: &str = "bvh-packet";

/// Rays that are asked about at once.
const SLICE: usize = 4096;
/// Sides of a packet of figure 4.
const PACKET: (u32, u32) = (16, 16);
/// Figure 4's abscissae.
const INCOHERENCE: [f32; 10] = [0.0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0];
/// Figure 4 shoots this part of the rays at each degree of incoherence.
const PART: usize = 10;

/// What leaves hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Ids; what they name is kept in a cache of 100 MB.
    Cache,
    /// Triangles.
    Inline,
}

impl Mode {
    /// As the option `triangles` names it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cache => "cache",
            Self::Inline => "inline",
        }
    }
}

/// What to measure with.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
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

/// A kind of rays: what they cost ray by ray and by slices. Work is counted ray by ray.
#[derive(Clone, Copy, Debug)]
pub struct Rates {
    /// In slices of one.
    pub single: Measured,
    /// In slices of 4096.
    pub slices: Measured,
}

/// A structure over a scene.
#[derive(Clone, Debug)]
pub struct Structure {
    /// Its id.
    pub id: &'static str,
    /// Children of a node.
    pub width: usize,
    /// What its leaves hold.
    pub mode: Mode,
    /// How it was built.
    pub report: BuildReport,
    /// All its bytes.
    pub bytes: usize,
    /// Nearest hits.
    pub closest: Rates,
    /// Any hit between two points.
    pub shadow: Rates,
}

/// A row of table 3.
#[derive(Clone, Copy, Debug)]
pub struct Cache {
    /// Its size.
    pub megabytes: u64,
    /// Nearest hits.
    pub closest: Rates,
}

/// A row of figure 4.
#[derive(Clone, Debug)]
pub struct Incoherence {
    /// Size of the jitter over that of the scene.
    pub factor: f32,
    /// Millions of rays a second of each structure.
    pub rates: Vec<f64>,
}

/// All figures of a scene.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What tables call it.
    pub name: String,
    /// Its triangles.
    pub triangles: usize,
    /// Tables 1, 2 and 4.
    pub structures: Vec<Structure>,
    /// Table 3; empty unless asked for.
    pub caches: Vec<Cache>,
    /// Figure 4.
    pub incoherence: Vec<Incoherence>,
}

impl Structure {
    /// Seconds of one phase.
    fn phase(&self, name: &str) -> f64 {
        let phases = self.report.phases.iter().filter(|(known, _)| *known == name);
        phases.map(|(_, seconds)| seconds).sum()
    }

    /// Seconds to collapse a binary tree, the wide nodes written.
    pub fn collapse_seconds(&self) -> f64 {
        self.phase("collapse") + self.phase("nodes")
    }

    /// Seconds to write out the finished tree: of wide ones the leaves.
    pub fn layout_seconds(&self) -> f64 {
        self.phase("layout") + self.phase("leaves")
    }

    /// Seconds for the binary tree.
    pub fn tree_seconds(&self) -> f64 {
        self.report.seconds() - self.collapse_seconds() - self.layout_seconds()
    }

    /// Children that nodes have room for and do not have.
    pub fn empty(&self) -> usize {
        let links = (self.report.nodes + self.report.leaves).saturating_sub(1);
        (self.report.nodes * self.width).saturating_sub(links)
    }
}

impl Scene {
    /// The binary tree of a mode, and that mode's others.
    fn structures_of(&self, mode: Mode) -> impl Iterator<Item = &Structure> {
        self.structures.iter().filter(move |structure| structure.mode == mode)
    }

    /// `bvh2` in the mode of a structure.
    fn binary_of<'a>(&'a self, structure: &'a Structure) -> &'a Structure {
        self.structures_of(structure.mode).next().unwrap_or(structure)
    }
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
    settings: &Settings,
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
        rates(&Shots::new(&rays, ask, SLICE), set.name(), accels, settings.rounds)
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
    let incoherence = incoherence(&target, &accels, &*packets, settings)?;
    drop(packets);

    let mut rows = Vec::new();
    if caches {
        let sized = paper::CACHES.map(|(megabytes, ..)| {
            let accel = built("mbvh4", &format!("triangles=cache,cache={megabytes}MB"))?;
            Ok((format!("mbvh4:cache={megabytes}MB"), accel))
        });
        let sized = sized.into_iter().collect::<Result<Vec<_>, BuildError>>()?;
        let sized: Vec<_> = sized.iter().map(|(spec, accel)| (spec.clone(), &**accel)).collect();
        let rates = shoot(RaySet::Random, Ask::Closest, &sized)?;
        rows = (paper::CACHES.iter().zip(rates))
            .map(|(&(megabytes, ..), closest)| Cache { megabytes, closest })
            .collect();
    }
    let (name, triangles) = (name.to_owned(), source.len());
    Ok(Scene { name, triangles, structures, caches: rows, incoherence })
}

/// Compares all to the first, counts their work and times them, by slices and ray by ray.
fn rates(
    shots: &Shots<'_>,
    set: &'static str,
    accels: &[(String, &dyn Accel)],
    rounds: usize,
) -> Result<Vec<Rates>, BenchError> {
    let expected = shots.answers(accels[0].1);
    for (spec, accel) in &accels[1..] {
        shots.answers(*accel).check(&expected, spec, &accels[0].0, set)?;
    }
    let single = Shots { slice: 1, ..*shots };
    let time = |shots: &Shots<'_>| {
        interleaved(accels.len(), rounds, |i| Ok::<_, BenchError>(shots.seconds(accels[i].1)))
    };
    let (by_slices, ray_by_ray) = (time(shots)?, time(&single)?);
    let rates = accels.iter().zip(by_slices.into_iter().zip(ray_by_ray));
    let rates = rates.map(|((_, accel), (slices, ray_by_ray))| {
        let counts = single.counts(*accel);
        let of = |seconds| Measured { counts, rays: shots.rays.len(), seconds };
        Rates { single: of(ray_by_ray), slices: of(slices) }
    });
    Ok(rates.collect())
}

/// Figure 4.
fn incoherence(
    target: &Target<'_>,
    accels: &[Box<dyn Accel>],
    packet: &dyn Accel,
    settings: &Settings,
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
        let expected = shots.answers(accels[0]);
        for (id, accel) in INCOHERENT.iter().zip(accels).skip(1) {
            shots.answers(accel).check(&expected, id, INCOHERENT[0], "packet")?;
        }
        let seconds = interleaved(accels.len(), settings.rounds, |i| {
            Ok::<_, BenchError>(shots.seconds(accels[i]))
        })?;
        let rate = |seconds: f64| rays.len() as f64 * 1e-6 / seconds.max(1e-9);
        rows.push(Incoherence { factor, rates: seconds.into_iter().map(rate).collect() });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests;
