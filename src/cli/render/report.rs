//! What a render says of the scene, of lost samples and of what it took.

use serde_json::{Value, json};

use super::checkpoint;
use super::expose::{Outcome, Took};
use crate::cli::job::{Job, percent};
use crate::cli::progress::{note, say};
use crate::cli::settings::Table;
use crate::cli::shell;
use crate::cli::text::format_count;
use crate::files::memory;
use crate::geom::TriangleSource;
use crate::render::{LostSample, Rendered, Sight, Stage};
use crate::texture::TextureFigures;

/// The share of paths that may be cut without a word.
const MANY_CUT: f64 = 0.002;

/// Says what the scene asks for that is not honoured, and what was decided for the user.
pub fn print_scene(job: &Job) {
    let staged = &job.staged;
    staged.notices.iter().for_each(note);
    if job.args.verbose > 0 {
        let (world, scene) = (&staged.world, &staged.world.scene);
        let of = |count: usize, one: &str, many: &str| format_count(count as u64, one, many);
        say(&format!(
            "{}: {}, {} of {}, {}, {}, {}; {:.2} s",
            job.args.scene_file.display(),
            of(world.triangles.len(), "triangle", "triangles"),
            of(scene.instances.len(), "instance", "instances"),
            of(scene.meshes.len(), "mesh", "meshes"),
            of(scene.materials.len(), "material", "materials"),
            of(scene.textures.len(), "texture", "textures"),
            of(world.lights.len(), "light", "lights"),
            staged.elapsed.as_secs_f64(),
        ));
    }
}

/// Names the samples that were not finite, each with the command that follows it. `words` are those
/// of the command line, the first of them `render`.
pub fn print_lost(rendered: &Rendered, words: &[String]) {
    if rendered.lost_count == 0 {
        return;
    }
    say(&format!("warning: {} samples were not finite and are left out:", rendered.lost_count));
    for lost in &rendered.lost {
        say(&format!("  {}", format_replay_command(lost, words)));
    }
}

/// The flag comes before all others: nothing is one after a `--`.
fn format_replay_command(lost: &LostSample, words: &[String]) -> String {
    let place = format!("{},{},{}", lost.x, lost.y, lost.sample);
    let (command, rest) = words.split_at(words.len().min(1));
    let (command, rest) = (shell::join(command), shell::join(rest));
    format!("dapple {command} --debug-sample {place} {rest}")
}

/// Says how far a render came that was ended before its time.
pub fn print_unfinished(job: &Job, outcome: &Outcome) {
    let Outcome { rendered, took } = outcome;
    let (fewest, most) = rendered.samples;
    let why = match took {
        Took { out_of_time: true, .. } => "the time is over",
        _ => "interrupted",
    };
    let counted = format!("{fewest} to {most} of {} samples a pixel", count(job));
    say(&format!("{why}: saved with {counted}"));
    if rendered.without_samples > 0 {
        let (without, all) = (rendered.without_samples, job.settings.crop.area());
        say(&format!("{without} of {all} pixels have no sample: they are black"));
    }
}

/// The samples of each pixel that this render was to take.
fn count(job: &Job) -> u64 {
    let range = checkpoint::range(&job.args);
    range.end - range.start
}

/// Whether the picture is not as good as was asked for.
pub fn is_incomplete(outcome: &Outcome) -> bool {
    let is_noisy = outcome.rendered.reached.is_some_and(|reached| reached.share < 1.0);
    outcome.rendered.cancelled || is_noisy
}

/// Says how much of the picture has more noise than was asked for.
pub fn print_noisy(outcome: &Outcome) {
    let share = outcome.rendered.reached.map_or(0.0, |reached| 1.0 - reached.share);
    let percent = 100.0 * share;
    say(&format!("note: {percent:.1} % of the tiles have --max-spp samples, and more noise"));
}

/// Says that many paths were cut, if they were, and no one asked for short ones.
pub fn print_cut(job: &Job, outcome: &Outcome) {
    let Outcome { rendered, .. } = outcome;
    let share = rendered.rays.cut as f64 / rendered.paths.max(1) as f64;
    let depth = job.args.max_depth;
    if share < MANY_CUT || depth < Table::default().defaults().max_depth {
        return;
    }
    let percent = 100.0 * share;
    say(&format!(
        "note: {percent:.1} % of the paths were cut at --max-depth {depth} and might have found \
         light: what is clear may be black there; --max-depth {} cuts fewer",
        depth.saturating_mul(2).min(1 << 16)
    ));
}

/// The last line: what it took.
pub fn summarize(job: &Job, outcome: &Outcome) -> String {
    let Outcome { rendered, took: Took { loaded, built, denoised, .. } } = outcome;
    let (width, height) = job.settings.resolution;
    let seconds = rendered.elapsed.as_secs_f64();
    let rays = rendered.rays.total() as f64;
    let outputs: Vec<String> = [&job.args.output, &job.args.png, &job.args.partial]
        .into_iter()
        .flatten()
        .map(|path| path.display().to_string())
        .collect();
    let samples = match rendered.samples {
        (fewest, most) if fewest == most => fewest.to_string(),
        (fewest, most) => format!("{fewest} to {most}"),
    };
    let denoised =
        denoised.map_or(String::new(), |time| format!(", denoise {:.2} s", time.as_secs_f64()));
    let noise = rendered.reached.map_or(String::new(), |reached| {
        format!(
            ", noise {:.4} at most, {:.1} % of it reached",
            reached.largest,
            100.0 * reached.share
        )
    });
    let memory = memory::peak()
        .map_or(String::new(), |bytes| format!(", peak {:.0} MB", bytes as f64 / 1e6));
    let sight = job.sight.map_or(String::new(), |Sight { seen, lit, .. }| {
        format!(", seen {}, lit {}", percent(seen), percent(lit))
    });
    format!(
        "{}: {width}x{height}, {samples} spp{noise}{sight}, {:.1} M rays in {:.2} s, {:.2} \
         Mrays/s, {:.2} µs a path; load {:.2} s, build {:.2} s{denoised}{memory}",
        outputs.join(", "),
        rays / 1e6,
        seconds,
        rays / seconds.max(1e-9) / 1e6,
        seconds * 1e6 / rendered.paths.max(1) as f64,
        loaded.as_secs_f64(),
        built.as_secs_f64(),
    )
}

/// What textures take, and what the cache of those that do not fit in memory has done.
pub fn describe_textures(figures: &TextureFigures) -> String {
    let mega = |bytes: u64| format!("{:.1} MB", bytes as f64 / 1e6);
    let TextureFigures { images, tiled, resident, cache } = figures;
    let images = format_count(*images, "image", "images");
    let whole = format!("textures: {images}, {} in memory", mega(*resident));
    if *tiled == 0 {
        return whole;
    }
    let in_memory = match cache.stored_in_memory {
        0 => String::new(),
        bytes => format!(" ({} of it in memory: there is no room for the file)", mega(bytes)),
    };
    format!(
        "{whole}; {tiled} in tiles, {} in a temporary file{in_memory}; tiles: {} read, {} \
         found, {} evicted, {} at most of {}",
        mega(cache.stored),
        cache.read,
        cache.found,
        cache.evicted,
        mega(cache.peak),
        mega(cache.limit),
    )
}

/// The same as a JSON object.
fn textures_as_json(figures: &TextureFigures) -> Value {
    let TextureFigures { images, tiled, resident, cache } = figures;
    let tiles = (*tiled > 0).then(|| {
        json!({
            "limit_bytes": cache.limit,
            "peak_bytes": cache.peak,
            "stored_bytes": cache.stored,
            "stored_in_memory_bytes": cache.stored_in_memory,
            "read": cache.read,
            "found": cache.found,
            "evicted": cache.evicted,
        })
    });
    json!({ "images": images, "tiled": tiled, "resident_bytes": resident, "tiles": tiles })
}

/// The last line as a JSON object.
pub fn summarize_as_json(job: &Job, outcome: &Outcome) -> String {
    let Outcome { rendered, took: Took { loaded, built, denoised, .. } } = outcome;
    json!({
        "scene": job.args.scene_file,
        "resolution": [job.settings.resolution.0, job.settings.resolution.1],
        "spp": rendered.samples.0,
        "accel": job.args.accel.to_string(),
        "paths": rendered.paths,
        "cut_paths": rendered.rays.cut,
        "rays": rendered.rays.total(),
        "shadow_rays": rendered.rays.shadow,
        "breakdown_s": Stage::ALL.map(|stage| (stage.name(), rendered.breakdown.seconds(stage)))
            .into_iter()
            .collect::<std::collections::BTreeMap<_, _>>(),
        "render_s": rendered.elapsed.as_secs_f64(),
        "load_s": loaded.as_secs_f64(),
        "build_s": built.as_secs_f64(),
        "denoise_s": denoised.map(|time| time.as_secs_f64()),
        "mrays_s": rendered.rays.total() as f64 / rendered.elapsed.as_secs_f64().max(1e-9) / 1e6,
        "lost_samples": rendered.lost_count,
        "peak_bytes": memory::peak(),
        "textures": textures_as_json(&job.textures.figures()),
        "interrupted": rendered.cancelled,
        "max_spp": rendered.samples.1,
        "noise": rendered.reached.map(|reached| reached.largest),
        "noise_reached": rendered.reached.map(|reached| reached.share),
        "pixels_without_samples": rendered.without_samples,
        "light": job.args.light.name(),
        "seen": job.sight.map(|sight| sight.seen),
        "lit": job.sight.map(|sight| sight.lit),
    })
    .to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_that_follows_a_lost_sample_is_fit_for_a_shell() {
        let lost = LostSample { x: 3, y: 4, sample: 5 };
        let words = ["render", "-o", "it's.exr", "--", "my scene.gltf"].map(str::to_owned);
        let command = format_replay_command(&lost, &words);
        let expected = r"render --debug-sample 3,4,5 -o 'it'\''s.exr' -- 'my scene.gltf'";
        assert_eq!(command, format!("dapple {expected}"));
    }
}
