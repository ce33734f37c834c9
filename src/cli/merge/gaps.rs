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
    let mut names = names(merge);
    let mut wholes = Vec::new();
    for gap in gaps.iter().take(LISTED) {
        let stopped = gap.unfinished.map(|part| merge.parts()[part].path().display().to_string());
        let name = match &stopped {
            Some(path) => format!("{path}.whole"),
            None => names.next().unwrap_or_default(),
        };
        lines.push(format!("  {}", command(merge, gap, &name)?));
        wholes.extend(stopped.map(|path| format!("then merge {name} in place of {path}")));
    }
    if gaps.len() > LISTED {
        lines.push(format!("  and {} more", gaps.len() - LISTED));
    }
    lines.append(&mut wholes);
    lines.push("--incomplete takes what there is, if every pixel has the same samples".to_owned());
    Ok(lines.join("\n"))
}

/// Names for new parts, which none of those that are there has.
fn names(merge: &Merge) -> impl Iterator<Item = String> + use<'_> {
    let is_new = |name: &String| merge.parts().iter().all(|part| part.path() != Path::new(name));
    (0..).map(|number| format!("gap{number}.part")).filter(is_new)
}

/// The command that fills a gap by a part of some name.
fn command(merge: &Merge, gap: &Gap, name: &str) -> Result<String, CliError> {
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
        words.extend([path, "--partial".to_owned(), name.to_owned()]);
    } else {
        let first = gap.samples.start / BLOCK * BLOCK;
        words.extend(crop_of(gap.window));
        words.extend(["--samples".to_owned(), format!("{first}..{}", gap.samples.end)]);
        words.extend(["--partial".to_owned(), name.to_owned()]);
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
