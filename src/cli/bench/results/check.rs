//! Committed figures beside those of a short run: what is compared, and the verdict.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::folder::Kept;
use super::short_runs;
use crate::bench::results::cells::{Part, read_cells};
use crate::bench::results::compare::{By, Comparison, Pair, compare, is_beyond};
use crate::bench::results::member::Member;
use crate::bench::results::short_run::{ShortRun, What, plan};
use crate::bench::table::cell;
use crate::cli::bench::provenance;
use crate::cli::error::CliError;
use crate::cli::flags::Quiet;
use crate::cli::text;

/// How files are checked.
#[derive(Clone, Copy, Debug)]
pub struct CheckSettings {
    /// Per cent that figures may be off.
    pub within: f64,
    /// Whether ratios alone are compared, on the file's processor too.
    pub ratios: bool,
    /// Whether nothing is told.
    pub quiet: Quiet,
}

/// A file and what came of its check.
pub struct Checked<'a> {
    kept: &'a Kept,
    found: Found,
}

enum Found {
    /// Nothing of it can be measured again; why.
    Left(String),
    /// What was measured, why rates or ratios, and what came of it.
    Compared {
        /// Of the bench.
        run: ShortRun,
        /// Why rates, or why ratios.
        why: &'static str,
        /// Cell by cell.
        comparison: Box<Comparison>,
        /// What a verdict against the file says.
        reasons: Vec<String>,
    },
}

/// Measures all files again, briefly.
///
/// # Errors
/// Files that are malformed, or those of the benches.
pub fn check<'a>(kept: &'a [Kept], settings: &CheckSettings) -> Result<Vec<Checked<'a>>, CliError> {
    // What is malformed is said before minutes are spent.
    let plan = |kept: &'a Kept| {
        let root = Member::root(&kept.json);
        let planned = plan(kept.bench, &root)?;
        let cells = planned.as_ref().ok().map(|run| {
            let part = Part::of_file(run);
            read_cells(kept.bench, &root, part)
        });
        Ok((kept, planned, cells.transpose()?.unwrap_or_default()))
    };
    let plans = kept.iter().map(|kept| plan(kept).map_err(|error| kept.wrong(&error)));
    let plans = plans.collect::<Result<Vec<_>, _>>()?;
    let mut all = Vec::new();
    for (kept, planned, committed) in plans {
        let run = match planned {
            Ok(run) => run,
            Err(why) => {
                all.push(Checked { kept, found: Found::Left(why) });
                continue;
            }
        };
        settings.quiet.tell(&format!("{}: {}", kept.path.display(), describe(&run)));
        let json = short_runs::measure(&run, settings.quiet).map_err(|error| match error {
            // A value that the bench does not know.
            CliError::Input(why) => CliError::Input(format!("{}: {why}", kept.path.display())),
            other => other,
        })?;
        let today = read_cells(kept.bench, &Member::root(&json), Part::of_run(&run));
        let today = today.map_err(|error| CliError::Output(error.to_string()))?;
        let (by, why) = choose_measure(kept.about.processor.as_deref(), settings.ratios);
        let comparison = Box::new(compare(&committed, &today, by));
        let reasons = comparison.explain(settings.within);
        all.push(Checked { kept, found: Found::Compared { run, why, comparison, reasons } });
    }
    if all.iter().all(|one| matches!(one.found, Found::Left(_))) {
        let why = |one: &Checked<'_>| match &one.found {
            Found::Left(why) => CliError::Input(format!("{}: {why}", one.kept.path.display())),
            Found::Compared { .. } => CliError::Input(String::new()),
        };
        return Err(CliError::Several(all.iter().map(why).collect()));
    }
    Ok(all)
}

/// Whether rates can be compared, and why.
fn choose_measure(processor: Option<&str>, ratios: bool) -> (By, &'static str) {
    match processor {
        _ if ratios => (By::Ratios, "ratios to the first structure, as --ratios asks"),
        None => (By::Ratios, "ratios to the first structure: the file tells no processor"),
        Some(name) if name == provenance::processor() => (By::Rates, "rates: the same processor"),
        Some(_) => (By::Ratios, "ratios to the first structure: another processor"),
    }
}

/// What is measured.
fn describe(run: &ShortRun) -> String {
    let (name, triangles) = (run.scene.generator.name(), run.scene.triangles);
    let extent = match &run.what {
        What::Accels { rays } | What::Kd { rays } | What::Mbvh { rays, .. } => {
            format!("{rays} rays of a kind")
        }
        What::Coherent { resolution: (width, height), pictures, .. } => {
            format!("{pictures} pictures of {width}x{height} pixels")
        }
        What::Render { resolution: (width, height), spp, .. } => {
            format!("{width}x{height} pixels, {spp} samples a pixel")
        }
    };
    format!("{name}-{triangles}, {extent}")
}

impl Checked<'_> {
    /// Whether the file describes the program; of one that could not be checked nothing is known.
    pub fn agrees(&self) -> bool {
        match &self.found {
            Found::Left(_) => true,
            Found::Compared { reasons, .. } => reasons.is_empty(),
        }
    }

    /// A table and a verdict.
    fn to_text(&self, within: f64) -> String {
        let path = self.kept.path.display();
        let Found::Compared { run, why, comparison, reasons } = &self.found else {
            return format!("{path}: not checked: {}\n", self.why_left());
        };
        let mut out = format!("{path}: {}; {why}\n\n", describe(run));
        out.push_str(&text::align_columns(&lay_out(comparison, within)));
        let beyond = comparison.pairs.iter().filter(|pair| is_beyond(pair.off(), within)).count();
        let _ = writeln!(
            out,
            "\n{beyond} of {} cells are beyond {within} % (*), which alone decides nothing; work: \
             {} figures equal, {} not",
            comparison.pairs.len(),
            comparison.equal,
            comparison.unequal.len()
        );
        if reasons.is_empty() {
            let worst = comparison
                .worst()
                .map_or(String::new(), |(structure, off)| format!(", {structure} by {off:+.1} %"));
            let _ = writeln!(out, "{path}: agrees: off by {:+.1} %{worst}", comparison.mean);
        }
        const SHOWN: usize = 12;
        for reason in reasons.iter().take(SHOWN) {
            let _ = writeln!(out, "{path}: differs: {reason}");
        }
        if reasons.len() > SHOWN {
            let _ = writeln!(out, "{path}: differs: {} reasons more", reasons.len() - SHOWN);
        }
        out
    }

    fn why_left(&self) -> &str {
        match &self.found {
            Found::Left(why) => why,
            Found::Compared { .. } => "",
        }
    }

    fn to_json(&self) -> Value {
        let (file, bench) = (self.kept.path.display().to_string(), self.kept.bench.name());
        let Found::Compared { run, why, comparison, reasons } = &self.found else {
            return json!({ "file": file, "bench": bench, "left_out": self.why_left() });
        };
        let pair = |pair: &Pair| {
            json!({
                "group": pair.group,
                "structure": pair.structure,
                "committed": pair.committed,
                "today": pair.today,
                "percent": pair.off(),
            })
        };
        let structures = comparison.structures.iter();
        let structures = structures.map(|(name, off)| (name.clone(), Value::from(*off)));
        json!({
            "file": file,
            "bench": bench,
            "run": describe(run),
            "compared": why,
            "cells": comparison.pairs.iter().map(pair).collect::<Vec<_>>(),
            "percent": comparison.mean,
            "structures_percent": structures.collect::<serde_json::Map<_, _>>(),
            "work_equal": comparison.equal,
            "work_unequal": comparison.unequal.iter().map(pair).collect::<Vec<_>>(),
            "differs": reasons,
            "agrees": reasons.is_empty(),
        })
    }
}

/// A row for each structure: of each group the file's figure, today's and how far it is off.
fn lay_out(comparison: &Comparison, within: f64) -> Vec<Vec<String>> {
    let mut groups: Vec<&str> = Vec::new();
    for pair in &comparison.pairs {
        if !groups.contains(&pair.group.as_str()) {
            groups.push(&pair.group);
        }
    }
    let mut heading = vec![String::new()];
    for group in &groups {
        heading.extend([(*group).to_owned(), "today".to_owned(), "%".to_owned()]);
    }
    heading.push("mean %".to_owned());
    let mut rows = vec![heading];
    for (structure, mean) in &comparison.structures {
        let mut row = vec![structure.clone()];
        for group in &groups {
            let is = |pair: &&Pair| pair.group == *group && pair.structure == *structure;
            let Some(pair) = comparison.pairs.iter().find(is) else {
                row.extend([const { String::new() }; 3]);
                continue;
            };
            let mark = if is_beyond(pair.off(), within) { "*" } else { "" };
            row.extend([
                cell(Some(pair.committed), 3),
                cell(Some(pair.today), 3),
                format!("{:+.1}{mark}", pair.off()),
            ]);
        }
        row.push(format!("{mean:+.1}"));
        rows.push(row);
    }
    rows
}

/// All of it for people.
pub fn to_text(all: &[Checked<'_>], within: f64) -> String {
    all.iter().map(|one| one.to_text(within)).collect::<Vec<_>>().join("\n")
}

/// All of it as an object.
pub fn to_json(all: &[Checked<'_>], within: f64) -> Value {
    json!({
        "within": within,
        "agrees": all.iter().all(Checked::agrees),
        "files": all.iter().map(Checked::to_json).collect::<Vec<_>>(),
        "measured": provenance::to_json(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_compared_on_the_files_processor_alone() {
        let here = provenance::processor();
        assert_eq!(choose_measure(Some(&here), false).0, By::Rates);
        assert_eq!(choose_measure(Some(&here), true).0, By::Ratios);
        assert_eq!(choose_measure(Some("another"), false).0, By::Ratios);
        assert_eq!(choose_measure(None, false).0, By::Ratios);
    }
}
