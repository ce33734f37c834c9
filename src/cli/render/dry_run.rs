//! `dapple render --dry-run`: what a render would take.

use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use serde_json::json;

use crate::cli::error::CliError;
use crate::cli::job::Job;
use crate::cli::memory;
use crate::cli::text::{self, format_bytes};
use crate::cli::watch::Watch;
use crate::files::memory::limit;
use crate::film::Window;
use crate::render::{Control, Settings, film_bytes, render};
use crate::scene::SceneMemory;

/// Paths that are followed to estimate what one takes: some tenths of a second.
const PATHS: u64 = 1 << 15;

/// Estimates memory, builds the structure, follows a few paths, and prints what that tells.
pub fn run(job: &Job) -> Result<ExitCode, CliError> {
    job.on_threads(|| {
        let scene = SceneMemory::of(&job.staged.world.scene);
        let scene = scene.with_texture_limit(job.textures.limit());
        let (accel, built) = job.take_structure(&Watch::silent())?;
        let build_s = built.as_secs_f64();
        let settings = thin_out(&job.settings);
        let cancel = AtomicBool::new(false);
        let control = Control { cancel: &cancel, progress: &|_| {} };
        let tried = render(&job.staged.world, &job.staged.camera, &*accel, &settings, &control);
        let path_s = tried.elapsed.as_secs_f64() / tried.paths.max(1) as f64;
        let paths = job.settings.crop.area() as u64 * job.settings.spp;

        let estimate = Estimate {
            job,
            scene,
            bytes: &memory::parts(&scene, film_bytes(&job.settings)),
            built_bytes: accel.memory().total() as u64,
            build_s,
            render_s: path_s * paths as f64,
            paths,
        };
        text::print(&if job.args.json { estimate.to_json() } else { estimate.to_text() })?;
        Ok(ExitCode::SUCCESS)
    })?
}

/// The same frame with few pixels and one sample each.
fn thin_out(settings: &Settings) -> Settings {
    let (width, height) = settings.resolution;
    let pixels = f64::from(width) * f64::from(height);
    let shrink = (PATHS as f64 / pixels).sqrt().min(1.0);
    let side = |side: u32| ((f64::from(side) * shrink) as u32).max(1);
    let resolution = (side(width), side(height));
    let crop = Window::of_size(resolution.0 as usize, resolution.1 as usize);
    Settings { resolution, crop, spp: 1, aovs: Vec::new(), ..settings.clone() }
}

struct Estimate<'a> {
    job: &'a Job,
    scene: SceneMemory,
    /// What each part takes by estimate.
    bytes: &'a [(&'static str, u64)],
    /// What the structure takes.
    built_bytes: u64,
    build_s: f64,
    render_s: f64,
    paths: u64,
}

impl Estimate<'_> {
    fn total(&self) -> u64 {
        self.bytes.iter().map(|(_, bytes)| bytes).sum()
    }

    fn to_text(&self) -> String {
        let parts = self.bytes.iter();
        let parts: Vec<String> =
            parts.map(|&(name, bytes)| format!("{name} {}", format_bytes(bytes))).collect();
        let SceneMemory { unique_triangles, placed_triangles, placements, .. } = self.scene;
        let (width, height) = self.job.settings.resolution;
        let threads = rayon::current_num_threads();
        format!(
            "{}: {width}x{height}, {} samples a pixel, {:.1} M paths\n\
             scene   {unique_triangles} triangles unique, {placed_triangles} placed (placements: \
             {placements})\n\
             memory  about {} of {} ({})\n\
             time    load {:.2} s, build {:.2} s (to {}), render about {} on \
             {threads} thread{}\n",
            self.job.args.scene_file.display(),
            self.job.settings.spp,
            self.paths as f64 * 1e-6,
            format_bytes(self.total()),
            format_bytes(self.job.args.memory.unwrap_or_else(limit)),
            parts.join(", "),
            self.job.staged.elapsed.as_secs_f64(),
            self.build_s,
            format_bytes(self.built_bytes),
            format_duration(self.render_s),
            if threads == 1 { "" } else { "s" },
        )
    }

    fn to_json(&self) -> String {
        let bytes: serde_json::Map<String, serde_json::Value> = self
            .bytes
            .iter()
            .map(|&(name, bytes)| (name.replace(' ', "_"), bytes.into()))
            .collect();
        let json = json!({
            "scene": self.job.args.scene_file,
            "resolution": [self.job.settings.resolution.0, self.job.settings.resolution.1],
            "spp": self.job.settings.spp,
            "paths": self.paths,
            "unique_triangles": self.scene.unique_triangles,
            "placed_triangles": self.scene.placed_triangles,
            "placements": self.scene.placements,
            "bytes": bytes,
            "bytes_total": self.total(),
            "bytes_limit": self.job.args.memory.unwrap_or_else(limit),
            "structure_built_bytes": self.built_bytes,
            "load_s": self.job.staged.elapsed.as_secs_f64(),
            "build_s": self.build_s,
            "render_s": self.render_s,
            "threads": rayon::current_num_threads(),
        });
        format!("{json}\n")
    }
}

/// A duration with two digits, in the unit that people use.
fn format_duration(seconds: f64) -> String {
    match seconds {
        s if s < 90.0 => format!("{s:.1} s"),
        s if s < 5400.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_said_in_their_unit() {
        let said = [2.34, 120.0, 7200.0].map(format_duration);
        assert_eq!(said, ["2.3 s", "2 min", "2.0 h"]);
    }
}
