//! A flight over a scene, and structures that are asked about its pictures.

use std::sync::Arc;

use super::figures::{Column, Tiling};
use super::frame::Frame;
use super::structures::{ACROSS, FINER, Method};
use crate::accel::{Accel, AccelSpec, BuildError, build};
use crate::bench::measure::{Answers, BenchError, time_interleaved};
use crate::camera::flight::Pose;
use crate::geom::TriangleSource;
use crate::simd::Isa;

/// What to measure with.
#[derive(Clone, Copy, Debug)]
pub struct FlyThroughBenchSettings {
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

/// A flight over a scene that structures are measured with.
pub struct Bench<'a> {
    /// What tables call the scene.
    pub name: &'a str,
    /// Its triangles.
    pub source: &'a Arc<dyn TriangleSource>,
    /// Where each picture is taken from.
    pub flight: Vec<Pose>,
    /// What to measure with.
    pub settings: &'a FlyThroughBenchSettings,
    /// Is told what is being done.
    pub tell: &'a dyn Fn(&str),
}

/// A structure and its name.
pub type Named = (String, Box<dyn Accel>);

/// A [`Named`] by reference.
pub fn borrowed((spec, accel): &Named) -> (&str, &dyn Accel) {
    (spec, &**accel)
}

impl Bench<'_> {
    /// Builds a structure over a tree of the settings' builder.
    pub fn build(&self, id: &str, options: &str) -> Result<Named, BuildError> {
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
    pub fn measure_columns(
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
            let expected = frame.trace_hits(accels[0].1);
            hits += expected.iter().filter(|hit| hit.is_hit()).count();
            all += expected.len();
            let expected = Answers::Closest(expected);
            for (spec, accel) in &accels[1..] {
                frame.trace(*accel).check(&expected, spec, accels[0].0, "primary")?;
            }
            for (column, (_, accel)) in columns.iter_mut().zip(accels) {
                column.add(&frame.count_work(*accel));
            }
            // Pools are as large as earlier pictures have left them.
            let mut tracers: Vec<_> = accels.iter().map(|(_, accel)| accel.tracer()).collect();
            let seconds = time_interleaved(accels.len(), self.settings.rounds, |i| {
                Ok::<_, BenchError>(frame.time(&mut *tracers[i]))
            })?;
            for (column, seconds) in columns.iter_mut().zip(seconds) {
                column.seconds.push(seconds);
            }
        }
        Ok((columns, hits as f64 / all.max(1) as f64))
    }

    /// Seconds a picture to compress paths for the screen and its tiles: by iteration and by
    /// recursion.
    pub fn time_compressing(&self, built: &[Named]) -> Result<[f64; 2], BenchError> {
        let (_, recursive) = self.build("bvh-path-compression", "pc=recursive")?;
        let mut tracers = [built[Method::Compressed.index()].1.tracer(), recursive.tracer()];
        let mut sums = [0.0; 2];
        for pose in &self.flight {
            let frame = Frame::new(pose, self.settings.resolution, ACROSS);
            // Short, hence often.
            let seconds = time_interleaved(2, 8 * self.settings.rounds, |i| {
                Ok::<_, BenchError>(frame.time_entering(&mut *tracers[i]))
            })?;
            sums = [sums[0] + seconds[0], sums[1] + seconds[1]];
        }
        Ok(sums.map(|sum| sum / self.flight.len().max(1) as f64))
    }

    /// Entry points by tiles.
    pub fn measure_tilings(
        &self,
        built: &[Named],
        columns: &[Column],
    ) -> Result<Vec<(Tiling, Column)>, BenchError> {
        let (packet, at) = (borrowed(&built[Method::Packet.index()]), Method::EntryPoint.index());
        let mut tilings = vec![(Tiling::Fixed(ACROSS), columns[at].clone())];
        let adaptive = self.build_default("kd-entry-point")?;
        let fixed = FINER.map(|across| (Tiling::Fixed(across), across, borrowed(&built[at])));
        let all = fixed.into_iter().chain([(Tiling::Adaptive, ACROSS, borrowed(&adaptive))]);
        for (tiling, across, accel) in all {
            let (mut columns, _) = self.measure_columns(across, &[packet, accel])?;
            tilings.extend(columns.pop().map(|column| (tiling, column)));
        }
        Ok(tilings)
    }
}
