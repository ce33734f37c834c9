//! What is missing between parts, and the commands that fill it.

use std::path::Path;

use crate::cli::error::CliError;
use crate::cli::settings::Table;
use crate::cli::shell;
use crate::film::Window;
use crate::part::{Gap, Merge};
use crate::sampling::BLOCK;

/// The most gaps that are told.
const LISTED: usize = 20;

/// Says what is missing, and the commands that fill it.
///
/// # Errors
/// If the parts tell settings that there are not.
pub fn describe(merge: &Merge) -> Result<String, CliError> {
    let gaps = merge.gaps();
    let mut lines = vec!["samples are missing; these commands fill the gaps:".to_owned()];
    for (at, gap) in gaps.iter().take(LISTED).enumerate() {
        lines.push(format!("  {}", command(merge, gap, at)?));
    }
    if gaps.len() > LISTED {
        lines.push(format!("  and {} more", gaps.len() - LISTED));
    }
    lines.push("--incomplete takes what there is, if every pixel has the same samples".to_owned());
    Ok(lines.join("\n"))
}

/// The command that fills a gap.
fn command(merge: &Merge, gap: &Gap, number: usize) -> Result<String, CliError> {
    let head = merge.head();
    let mut words = vec!["render".to_owned(), head.scene.clone()];
    words.extend(Table::default().to_words(Path::new("the part"), &head.settings)?);
    words.extend(["--spp".to_owned(), head.spp.to_string()]);
    let crop_of = |window: Window| {
        let (width, height) = head.resolution;
        let is_whole = window == Window::of_size(width as usize, height as usize);
        (!is_whole).then(|| ["--crop".to_owned(), window.to_string()]).into_iter().flatten()
    };
    let stopped = gap.unfinished.map(|part| &merge.parts()[part]);
    if let Some(part) = stopped {
        // It goes on from where it was stopped, which may be anywhere.
        let samples = part.head.samples();
        let path = part.path().display().to_string();
        words.extend(crop_of(part.head.crop()));
        words.extend(["--samples".to_owned(), format!("{}..{}", samples.start, samples.end)]);
        words.extend(["--resume", "--checkpoint"].map(str::to_owned));
        words.extend([path.clone(), "--partial".to_owned(), path + ".whole"]);
    } else {
        let first = gap.samples.start / BLOCK * BLOCK;
        words.extend(crop_of(gap.window));
        words.extend(["--samples".to_owned(), format!("{first}..{}", gap.samples.end)]);
        words.extend(["--partial".to_owned(), format!("gap{number}.part")]);
    }
    Ok(format!("dapple {}", shell::join(words)))
}

/// How much of the samples there is.
pub fn describe_samples(merge: &Merge) -> String {
    let missing: Vec<String> = merge
        .gaps()
        .iter()
        .map(|gap| format!("{}..{}", gap.samples.start, gap.samples.end))
        .collect();
    format!("of {} samples a pixel these are missing: {}", merge.head().spp, missing.join(", "))
}
