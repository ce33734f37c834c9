//! Many rays at once, over flights of a camera: the tables of J. Barczak, "An improved multi-level
//! raytracing algorithm", measured.
//!
//! All on the calling thread, rays made beforehand: traversal alone. A picture is one region, which
//! the tracer enters; its 8 by 8 tiles are slices, which structures narrow for themselves and cut
//! into packets of 16 by 16 rays: the paper's hierarchy. All answers are held against those of
//! `bvh-packet` first; then the structures take turns, picture by picture ([`interleaved`]).

pub mod frame;
mod json;
mod lights;
pub mod paper;
mod tables;
#[cfg(test)]
mod tests;
mod worth;

use std::sync::Arc;

use self::frame::{Frame, Work};
use super::measure::{BenchError, interleaved};
use crate::accel::{Accel, AccelSpec, BuildError, Counts, Event, build};
use crate::camera::flight::Pose;
use crate::geom::TriangleSource;
use crate::simd::Isa;

pub use json::json;
pub use lights::Light;
pub use tables::{plots, tables};

/// Tiles along a side of a picture, as the paper found best.
const ACROSS: u32 = 8;

/// What is measured: names, and structures. Their order is that of [`Scene::columns`].
pub const TRACERS: [(Name, &str, &str); 9] = [
    (Name::Packet, "bvh-packet", ""),
    (Name::EntryPoint, "bvh-entry-point", ""),
    (Name::Compressed, "bvh-path-compression", ""),
    (Name::CompressedEach, "bvh-path-compression", "per-packet=on"),
    (Name::Partition, "bvh-partition", ""),
    (Name::PartitionCompressed, "bvh-path-compression", "with=partition,per-packet=on"),
    (Name::Single, "bvh2", ""),
    (Name::SingleCompressed, "bvh-path-compression", "with=single"),
    (Name::Wide, "mbvh8", ""),
];

/// A column of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Name {
    /// Packets from the root.
    Packet,
    /// Packets from an entry point.
    EntryPoint,
    /// Packets over compressed paths.
    Compressed,
    /// The same, with a tree for each packet.
    CompressedEach,
    /// Partitioned packets from the root.
    Partition,
    /// Partitioned packets, with a tree for each.
    PartitionCompressed,
    /// Ray by ray.
    Single,
    /// Ray by ray over compressed paths.
    SingleCompressed,
    /// Eight children a node.
    Wide,
}

/// Tiles along a side that entry points are tried with, but for those of the tables.
pub const FINER: [u32; 3] = [16, 32, 64];

/// How tiles are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tiling {
    /// So many along a side.
    Fixed(u32),
    /// Over the kd-tree, whose structure cuts tiles where the scene is complex.
    Adaptive,
}

/// What to measure with.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Pixels of a picture.
    pub resolution: (u32, u32),
    /// Pictures of a flight, at most.
    pub frames: usize,
    /// Passes of each structure over each picture; the median counts.
    pub rounds: usize,
    /// The builder, as the option `build` names it.
    pub build: &'static str,
    /// Bytes that all may take by the estimate.
    pub memory: u64,
    /// The instruction set.
    pub isa: Isa,
}

/// A structure over a flight.
#[derive(Clone, Debug, Default)]
pub struct Column {
    /// Work of all pictures.
    pub counts: Counts,
    /// Seconds of each picture.
    pub seconds: Vec<f64>,
    /// The most bytes of the pool in use at once, of each picture.
    pub peaks: Vec<usize>,
    /// Bytes of the largest pool.
    pub pool: usize,
}

/// All figures of a scene.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What tables call it.
    pub name: String,
    /// Its triangles.
    pub triangles: usize,
    /// Rays of a picture.
    pub rays: usize,
    /// Share of rays that hit something.
    pub covered: f64,
    /// Bytes of the hierarchy: of its nodes, and with the triangles.
    pub bytes: [usize; 2],
    /// By [`TRACERS`].
    pub columns: Vec<Column>,
    /// Entry points by tiles.
    pub tilings: Vec<(Tiling, Column)>,
    /// Mean seconds a picture to compress paths for screen and tiles: iterative, recursive.
    pub compressing: [f64; 2],
    /// Rays to lights.
    pub lights: Vec<Light>,
}

impl Scene {
    /// A structure's figures.
    pub fn column(&self, name: Name) -> &Column {
        &self.columns[place(name)]
    }
}

impl Column {
    /// Nodes looked at a picture: in searches, and by packets.
    pub fn visits(&self) -> [f64; 2] {
        let of = |event: Event| self.counts[event] as f64 / self.seconds.len().max(1) as f64;
        [of(Event::Search), of(Event::InnerNode) + of(Event::Leaf)]
    }

    /// Seconds of all pictures.
    pub fn total(&self) -> f64 {
        self.seconds.iter().sum()
    }

    /// How many times as fast as another: over all pictures, and at most.
    pub fn speed_up(&self, over: &Self) -> [f64; 2] {
        let pairs = over.seconds.iter().zip(&self.seconds);
        let most = pairs.map(|(theirs, ours)| theirs / ours.max(1e-12)).fold(0.0, f64::max);
        [over.total() / self.total().max(1e-12), most]
    }

    fn add(&mut self, work: &Work) {
        self.counts = self.counts + work.counts;
        self.peaks.push(work.pool.peak);
        self.pool = self.pool.max(work.pool.size);
    }
}

/// Bytes that a scene's structures and rays may take.
fn estimate(triangles: usize, rays: usize) -> u64 {
    triangles as u64 * 1200 + rays as u64 * 160
}

/// What is measured with: a scene's name, its triangles and pictures, and who is told.
struct Bench<'a> {
    name: &'a str,
    source: &'a Arc<dyn TriangleSource>,
    flight: Vec<Pose>,
    settings: &'a Settings,
    tell: &'a dyn Fn(&str),
}

/// A structure, as it is called.
type Named = (String, Box<dyn Accel>);

fn borrowed((spec, accel): &Named) -> (&str, &dyn Accel) {
    (spec, &**accel)
}

/// Where a structure stands in [`TRACERS`].
fn place(name: Name) -> usize {
    TRACERS.iter().position(|(known, ..)| *known == name).expect("is among the structures")
}

/// Measures a flight over a scene; `tell` is told what is being done.
///
/// # Errors
/// If a structure can't be built or would not fit, or disagrees with `bvh-packet`.
pub fn measure(
    name: &str,
    source: &Arc<dyn TriangleSource>,
    flight: &[Pose],
    settings: &Settings,
    tell: &dyn Fn(&str),
) -> Result<Scene, BenchError> {
    let rays = settings.resolution.0 as usize * settings.resolution.1 as usize;
    let needed = estimate(source.len(), rays);
    if needed > settings.memory {
        return Err(BuildError::TooLarge { needed, limit: settings.memory }.into());
    }
    let flight = spread(flight, settings.frames);
    let bench = Bench { name, source, flight, settings, tell };
    let built = TRACERS.map(|(_, id, options)| bench.build(id, options));
    let built = built.into_iter().collect::<Result<Vec<Named>, _>>()?;
    let (columns, covered) =
        bench.columns(ACROSS, &built.iter().map(borrowed).collect::<Vec<_>>())?;
    let compressing = bench.compressing(&built)?;
    let tilings = bench.tilings(&built, &columns)?;
    let lights = bench.lights(&built)?;
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
fn spread(flight: &[Pose], most: usize) -> Vec<Pose> {
    let count = flight.len().min(most);
    (0..count).map(|i| flight[(2 * i + 1) * flight.len() / (2 * count)]).collect()
}

impl Bench<'_> {
    fn build(&self, id: &str, options: &str) -> Result<Named, BuildError> {
        let comma = if options.is_empty() { "" } else { "," };
        let text = format!("{id}:build={}{comma}{options}", self.settings.build);
        (self.tell)(&format!("{}: building {text}", self.name));
        let spec: AccelSpec = text.parse().expect("options that the table has");
        Ok((spec.to_string(), build(&spec, Arc::clone(self.source), self.settings.isa)?))
    }

    fn build_default(&self, id: &str) -> Result<Named, BuildError> {
        (self.tell)(&format!("{}: building {id}", self.name));
        let spec: AccelSpec = id.parse().expect("is in the table");
        Ok((spec.to_string(), build(&spec, Arc::clone(self.source), self.settings.isa)?))
    }

    /// The figures of structures over all pictures in tiles, and the share of rays that hit.
    fn columns(
        &self,
        across: u32,
        accels: &[(&str, &dyn Accel)],
    ) -> Result<(Vec<Column>, f64), BenchError> {
        let mut columns = vec![Column::default(); accels.len()];
        let (mut hits, mut all) = (0, 0);
        for (number, pose) in self.flight.iter().enumerate() {
            let count = self.flight.len();
            (self.tell)(&format!(
                "{}: picture {} of {count}, {across}x{across} tiles",
                self.name,
                number + 1
            ));
            let frame = Frame::new(pose, self.settings.resolution, across);
            let expected = frame.hits(accels[0].1);
            hits += expected.iter().filter(|hit| hit.is_hit()).count();
            all += expected.len();
            let expected = super::measure::Answers::Closest(expected);
            for (spec, accel) in &accels[1..] {
                frame.answers(*accel).check(&expected, spec, accels[0].0, "primary")?;
            }
            for (column, (_, accel)) in columns.iter_mut().zip(accels) {
                column.add(&frame.work(*accel));
            }
            // Pools are as large as earlier pictures have left them.
            let mut tracers: Vec<_> = accels.iter().map(|(_, accel)| accel.tracer()).collect();
            let seconds = interleaved(accels.len(), self.settings.rounds, |i| {
                Ok::<_, BenchError>(frame.seconds(&mut *tracers[i]))
            })?;
            for (column, seconds) in columns.iter_mut().zip(seconds) {
                column.seconds.push(seconds);
            }
        }
        Ok((columns, hits as f64 / all.max(1) as f64))
    }

    /// Seconds a picture to compress paths for the screen and its tiles: by iteration and by
    /// recursion.
    fn compressing(&self, built: &[Named]) -> Result<[f64; 2], BenchError> {
        let (_, recursive) = self.build("bvh-path-compression", "pc=recursive")?;
        let mut tracers = [built[place(Name::Compressed)].1.tracer(), recursive.tracer()];
        let mut sums = [0.0; 2];
        for pose in &self.flight {
            let frame = Frame::new(pose, self.settings.resolution, ACROSS);
            // Short, hence often.
            let seconds = interleaved(2, 8 * self.settings.rounds, |i| {
                Ok::<_, BenchError>(frame.entering_seconds(&mut *tracers[i]))
            })?;
            sums = [sums[0] + seconds[0], sums[1] + seconds[1]];
        }
        Ok(sums.map(|sum| sum / self.flight.len().max(1) as f64))
    }

    /// Entry points by tiles.
    fn tilings(
        &self,
        built: &[Named],
        columns: &[Column],
    ) -> Result<Vec<(Tiling, Column)>, BenchError> {
        let (packet, at) = (borrowed(&built[place(Name::Packet)]), place(Name::EntryPoint));
        let mut tilings = vec![(Tiling::Fixed(ACROSS), columns[at].clone())];
        let adaptive = self.build_default("kd-entry-point")?;
        let fixed = FINER.map(|across| (Tiling::Fixed(across), across, borrowed(&built[at])));
        let all = fixed.into_iter().chain([(Tiling::Adaptive, ACROSS, borrowed(&adaptive))]);
        for (tiling, across, accel) in all {
            let (mut columns, _) = self.columns(across, &[packet, accel])?;
            tilings.extend(columns.pop().map(|column| (tiling, column)));
        }
        Ok(tilings)
    }
}
