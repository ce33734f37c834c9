//! Text tables, figures, and standard output.

use std::io::{self, Write};

use crate::film::FilmError;

/// Writes to standard output, as every command does with its result. A reader that has gone away
/// (`| head`) is fine.
///
/// # Errors
/// [`FilmError::Stdout`].
pub fn print(text: &str) -> Result<(), FilmError> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(FilmError::Stdout),
    }
}

/// Formats a figure with six significant digits, in scientific notation where it is very small or
/// large.
pub fn format_figure(value: f64) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    let size = value.abs();
    if size != 0.0 && !(1e-4..1e6).contains(&size) {
        return format!("{value:.4e}");
    }
    // Six digits, of which those before the point are counted, and zeros right after it are not.
    let whole = [10.0, 100.0, 1e3, 1e4, 1e5].iter().filter(|&&bound| size >= bound).count();
    let zeros = [1.0, 0.1, 0.01, 1e-3].iter().filter(|&&bound| size != 0.0 && size < bound).count();
    let text = format!("{value:.*}", 5 + zeros - whole);
    if !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// How many there are of something, as people say it.
pub fn format_count(count: u64, one: &str, many: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {many}") }
}

/// A number of bytes, as people say it.
pub fn format_bytes(count: u64) -> String {
    match count {
        0..1_000 => format!("{count} B"),
        1_000..1_000_000 => format!("{:.1} kB", count as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", count as f64 / 1e6),
        _ => format!("{:.2} GB", count as f64 / 1e9),
    }
}

/// Lays out rows in columns, the first row the heading, all but the first column to the right.
pub fn align_columns(rows: &[Vec<String>]) -> String {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max()
    };
    let widths: Vec<_> = (0..count).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| {
            if column == 0 { format!("{cell:width$}") } else { format!("{cell:>width$}") }
        });
        text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_short() {
        let figures = [0.0, 1.0, 0.123456789, 123.456789, 1234567.0, 0.00001234, -2.5, f64::NAN];
        let text = ["0", "1", "0.123457", "123.457", "1.2346e6", "1.2340e-5", "-2.5", "NaN"];
        assert_eq!(figures.map(format_figure), text);
        assert_eq!(format_figure(100.0), "100");
        assert_eq!(format_figure(100_000.0), "100000");
    }

    #[test]
    fn one_is_not_many() {
        let counts = [0, 1, 2].map(|count| format_count(count, "leaf", "leaves"));
        assert_eq!(counts, ["0 leaves", "1 leaf", "2 leaves"]);
    }

    #[test]
    fn sizes_are_rounded() {
        let sizes = [999, 1_500, 2_340_000, 7_200_000_000].map(format_bytes);
        assert_eq!(sizes, ["999 B", "1.5 kB", "2.3 MB", "7.20 GB"]);
    }

    #[test]
    fn columns_line_up() {
        let rows = [vec!["a", "long"], vec!["name", "1"]];
        let rows = rows.map(|row| row.into_iter().map(str::to_owned).collect());
        assert_eq!(align_columns(&rows), "a     long\nname     1\n");
    }
}
