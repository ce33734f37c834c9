//! The figures of a scene.

use super::paper;
use super::structures::Mode;
use crate::accel::BuildReport;
use crate::bench::measure::Measured;
use crate::bench::table::scene_label;

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
    pub fn structures_of(&self, mode: Mode) -> impl Iterator<Item = &Structure> {
        self.structures.iter().filter(move |structure| structure.mode == mode)
    }

    /// `bvh2` in the mode of a structure.
    pub fn binary_of<'a>(&'a self, structure: &'a Structure) -> &'a Structure {
        self.structures_of(structure.mode).next().unwrap_or(structure)
    }

    /// Its name, and that of the paper's scene of as many triangles.
    pub fn label(&self) -> String {
        let paper = paper::Scene::of(self.triangles).map(|paper| paper.name);
        scene_label(&self.name, self.triangles, paper)
    }
}
