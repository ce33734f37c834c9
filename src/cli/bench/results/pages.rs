//! The page of tables beside the papers'.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use super::folder::Kept;
use crate::bench::results::member::Member;
use crate::bench::results::page;
use crate::bench::results::tables::make_tables;
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
