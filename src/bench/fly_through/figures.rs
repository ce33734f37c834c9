//! The figures of a scene, and the ratios that tables make of them.

use super::frame::Work;
use super::paper;
use super::structures::{LightKind, Method};
use crate::accel::{Counts, Event};
use crate::bench::table::scene_label;

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

impl Column {
    /// Nodes looked at a picture: in searches, and by packets.
    pub fn visits(&self) -> [f64; 2] {
        let of = |event: Event| self.counts[event] as f64 / self.seconds.len().max(1) as f64;
        [of(Event::Search), of(Event::InnerNode) + of(Event::Leaf)]
    }

    /// Nodes looked at a picture, in all.
    pub fn all_visits(&self) -> f64 {
        let [searched, walked] = self.visits();
        searched + walked
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

    /// Adds the work of one more picture.
    pub fn add(&mut self, work: &Work) {
        self.counts = self.counts + work.counts;
        self.peaks.push(work.pool.peak);
        self.pool = self.pool.max(work.pool.size);
    }
}

/// How tiles are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tiling {
    /// So many along a side.
    Fixed(u32),
    /// Over the kd-tree, whose structure cuts tiles where the scene is complex.
    Adaptive,
}

impl Tiling {
    /// As tables name it.
    pub fn name(self) -> String {
        match self {
            Self::Fixed(across) => format!("{across}x{across}"),
            Self::Adaptive => "kd, adaptive".to_owned(),
        }
    }
}

/// Rays to a light.
#[derive(Clone, Debug)]
pub struct Light {
    /// What shines.
    pub kind: LightKind,
    /// Rays that were shot, over all pictures.
    pub rays: usize,
    /// By tracer, in the order of the table.
    pub columns: Vec<Column>,
}

impl Light {
    /// Millions of rays a second.
    pub fn rate(&self, column: &Column) -> f64 {
        self.rays as f64 * 1e-6 / column.total().max(1e-12)
    }
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
    /// By structure.
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
    pub fn column(&self, method: Method) -> &Column {
        &self.columns[method.index()]
    }

    /// Its name, and that of the paper's scene of as many triangles.
    pub fn label(&self) -> String {
        let paper = paper::Scene::of(self.triangles).map(|paper| paper.name);
        scene_label(&self.name, self.triangles, paper)
    }

    /// Visits of entry points and of compressed paths over those of packets.
    pub fn visit_ratios(&self) -> [f64; 2] {
        let visits = |method| self.column(method).all_visits();
        let packets = visits(Method::Packet).max(1.0);
        [visits(Method::EntryPoint) / packets, visits(Method::Compressed) / packets]
    }

    /// Millions of rays a second.
    pub fn rate(&self, column: &Column) -> f64 {
        (self.rays * column.seconds.len()) as f64 * 1e-6 / column.total().max(1e-12)
    }

    /// Bytes of compressed paths in per cent of those of nodes: on average, at most, and of the
    /// pool.
    pub fn pool_shares(&self) -> [f64; 3] {
        let column = self.column(Method::Compressed);
        let share = |bytes: f64| bytes * 100.0 / self.bytes[0].max(1) as f64;
        let mean = column.peaks.iter().sum::<usize>() as f64 / column.peaks.len().max(1) as f64;
        let most = column.peaks.iter().max().copied().unwrap_or(0);
        [mean, most as f64, column.pool as f64].map(share)
    }
}
