//! Where the results of a bench go.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::provenance;
use crate::bench::table::Table;
use crate::cli::error::CliError;
use crate::cli::text;
use crate::files::{self, Flush};

/// Flags of all benches.
#[derive(clap::Args, Debug)]
pub struct OutputArgs {
    /// Write the tables as Markdown, JSON and SVG into this folder
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Print one JSON object in place of the tables
    #[arg(long)]
    json: bool,
}

impl OutputArgs {
    /// Whether there is to be a report.
    pub fn wants_report(&self) -> bool {
        self.report.is_some()
    }

    /// Makes the folder of the report, before the work.
    ///
    /// # Errors
    /// If it could not be written to.
    pub fn probe(&self) -> Result<(), CliError> {
        let Some(folder) = &self.report else { return Ok(()) };
        fs::create_dir_all(folder)
            .and_then(|()| files::probe(&folder.join("report")))
            .map_err(|error| CliError::not_written(folder, &error))
    }
}

/// What a bench found.
pub struct Results {
    /// The stem of files.
    pub name: &'static str,
    /// For people.
    pub tables: Vec<Table>,
    /// For programs: an object, to which [`provenance`] adds a member.
    pub json: Value,
    /// Stems of files after the name, and pictures as SVG.
    pub plots: Vec<(String, String)>,
}

impl Results {
    /// Prints them, and writes the report if there is to be one.
    ///
    /// # Errors
    /// What could not be written.
    pub fn publish(&self, args: &OutputArgs) -> Result<(), CliError> {
        let mut json = self.json.clone();
        json["measured"] = provenance::to_json();
        let object = format!("{json:#}\n");
        if let Some(folder) = &args.report {
            write(folder, &format!("{}.md", self.name), &self.to_markdown())?;
            write(folder, &format!("{}.json", self.name), &object)?;
            for (stem, svg) in &self.plots {
                write(folder, &format!("{}-{stem}.svg", self.name), svg)?;
            }
        }
        Ok(text::print(&if args.json { object } else { self.to_text() })?)
    }

    fn to_markdown(&self) -> String {
        let tables: Vec<_> = self.tables.iter().map(Table::markdown).collect();
        let picture = |(stem, _): &(String, String)| format!("\n![]({}-{stem}.svg)\n", self.name);
        let measured = format!("\n{}\n", provenance::to_text());
        tables.join("\n") + &measured + &self.plots.iter().map(picture).collect::<String>()
    }

    fn to_text(&self) -> String {
        let text = |one: &Table| {
            let note = wrap(&one.note);
            format!("{}\n{note}\n{}", one.title, text::align_columns(&one.lines()))
        };
        self.tables.iter().map(text).collect::<Vec<_>>().join("\n")
    }
}

/// A paragraph in lines of at most a hundred characters, where words allow it.
fn wrap(paragraph: &str) -> String {
    const WIDTH: usize = 100;
    let (mut text, mut width) = (String::new(), 0);
    for word in paragraph.split_whitespace() {
        let length = word.chars().count();
        if width > 0 && width + 1 + length > WIDTH {
            text.push('\n');
            width = 0;
        } else if width > 0 {
            text.push(' ');
            width += 1;
        }
        text.push_str(word);
        width += length;
    }
    if text.is_empty() { text } else { text + "\n" }
}

fn write(folder: &Path, name: &str, text: &str) -> Result<(), CliError> {
    let path = folder.join(name);
    files::write(&path, Flush::ToDisk, |file| file.write_all(text.as_bytes()))
        .map_err(|error| CliError::not_written(&path, &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_are_wrapped_at_words() {
        let words = ["abcd"; 41].join(" ");
        let lines: Vec<_> = wrap(&words).lines().map(str::len).collect();
        assert_eq!(lines, [99, 99, 4]);
        assert_eq!(wrap(""), "");
    }
}
