//! The tables that set a bench's figures beside its paper's.

use super::files::Bench;
use super::member::{Malformed, Member};
use super::{coherent_page, kd_page, mbvh_page, render_page};

/// The tables of a bench's file, each with the name of its place on the page.
///
/// # Errors
/// What is malformed in the file.
pub fn make_tables(
    bench: Bench,
    root: &Member<'_>,
) -> Result<Vec<(&'static str, String)>, Malformed> {
    match bench {
        Bench::Mbvh => mbvh_page::make_tables(root),
        Bench::Coherent => coherent_page::make_tables(root),
        Bench::Kd => kd_page::make_tables(root),
        Bench::Render => render_page::make_tables(root),
        // Its table is that of all structures, which no paper has.
        Bench::Accels => Ok(Vec::new()),
    }
}
