//! The page of tables beside the papers'.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use super::folder::Kept;
use crate::bench::results::files::Bench;
use crate::bench::results::member::{Malformed, Member};
use crate::bench::results::{coherent_page, kd_page, mbvh_page, page, render_page};
use crate::cli::error::CliError;
use crate::files::{self, Flush};

/// Larger ones are no pages.
const MAX_BYTES: u64 = 16 << 20;

/// Writes all tables of the files into a page, between its marks.
///
/// # Errors
/// A page that can't be read or written, or marks that make no sense; malformed files.
pub fn fill(path: &Path, kept: &[Kept]) -> Result<(), CliError> {
    let shown = path.display();
    let input = |why: String| CliError::Input(format!("{shown}: {why}"));
    let bytes = files::read(path, MAX_BYTES).map_err(|error| input(files::why_unread(&error)))?;
    let text = String::from_utf8(bytes).map_err(|_| input("is not text".to_owned()))?;
    let mut tables = vec![("measured", list_measured(kept))];
    for file in kept {
        let made = make_tables(file.bench, &Member::root(&file.json));
        tables.extend(made.map_err(|error| file.wrong(&error))?);
    }
    let filled = page::fill(&text, &tables).map_err(|error| input(error.to_string()))?;
    files::write(path, Flush::ToDisk, |file| file.write_all(filled.as_bytes()))
        .map_err(|error| CliError::not_written(path, &error))
}

fn make_tables(bench: Bench, root: &Member<'_>) -> Result<Vec<(&'static str, String)>, Malformed> {
    match bench {
        Bench::Mbvh => mbvh_page::make_tables(root),
        Bench::Coherent => coherent_page::make_tables(root),
        Bench::Kd => kd_page::make_tables(root),
        Bench::Render => render_page::make_tables(root),
        // Its table is that of all structures, which no paper has.
        Bench::Accels => Ok(Vec::new()),
    }
}

/// Where the figures come from.
fn list_measured(kept: &[Kept]) -> String {
    let mut text = "| file | measured | processor | commit |\n|---|---|---|---|\n".to_owned();
    for file in kept {
        let about = &file.about;
        let or_not = |value: &Option<String>| value.clone().unwrap_or_else(|| "-".to_owned());
        let _ = writeln!(
            text,
            "| `{}` | {} | {} | {} |",
            file.bench.file(),
            about.extent.join(", "),
            or_not(&about.processor),
            or_not(&about.commit)
        );
    }
    text
}
