//! What is in a part of a picture, or in a checkpoint.

use std::fmt::Write as _;
use std::path::Path;
use std::process::ExitCode;

use serde_json::json;

use crate::cli::error::CliError;
use crate::cli::shell::quote;
use crate::cli::text::print;
use crate::part::Part;

/// Reads all of a part, and prints what it tells.
pub fn run(path: &Path, as_json: bool) -> Result<ExitCode, CliError> {
    let part = Part::open(path)?;
    part.verify()?;
    print(&if as_json { to_json(&part) } else { to_text(&part) })?;
    Ok(ExitCode::SUCCESS)
}

fn to_json(part: &Part) -> String {
    let head = &part.head;
    let (samples, crop, (fewest, most)) = (head.samples(), head.crop(), part.sample_counts());
    let json = json!({
        "part": part.path(),
        "bytes": part.bytes,
        "version": head.version,
        "scene": head.scene,
        "scene_digest": head.scene_digest,
        "resolution": [head.resolution.0, head.resolution.1],
        "crop": [crop.x0, crop.y0, crop.x1, crop.y1],
        "samples": [samples.start, samples.end],
        "spp": head.spp,
        "complete": part.is_complete(),
        "fewest_samples": fewest,
        "most_samples": most,
        "lost_samples": part.lost_count(),
        "render_s": head.render_s,
        "identity": head.identity,
        "settings": head.settings,
    });
    format!("{json}\n")
}

fn to_text(part: &Part) -> String {
    let head = &part.head;
    let (samples, (width, height)) = (head.samples(), head.resolution);
    let (fewest, most) = part.sample_counts();
    let there = match part.is_complete() {
        true if samples.is_empty() => "none: a merge does without it".to_owned(),
        true if fewest == most => "all there".to_owned(),
        true => format!("all there: {fewest} to {most} a pixel"),
        // A checkpoint is one, too. A part beside which there was none goes on as well, but not by
        // the command that made it.
        false => format!(
            "not all there: {fewest} to {most} a pixel; --checkpoint {} --resume goes on",
            quote(part.path())
        ),
    };
    let mut text = format!(
        "{}: part of a picture, {:.1} MB, undamaged\n\
         scene     {} (digest {})\n\
         pixels    {} of {width}x{height}\n\
         samples   {}..{} of {}, {there}\n\
         lost      {}\n\
         time      {:.1} s of rendering\n\
         version   {}\n\
         settings that samples depend on:\n",
        part.path().display(),
        part.bytes as f64 * 1e-6,
        head.scene,
        head.scene_digest,
        head.crop(),
        samples.start,
        samples.end,
        head.spp,
        part.lost_count(),
        head.render_s,
        head.version,
    );
    for (key, value) in &head.identity {
        let _ = writeln!(text, "  {key} = {value}");
    }
    text
}
