//! Tables of figures, before they are laid out as text or Markdown.

/// A titled table; the first column is text, the others are figures.
#[derive(Clone, Debug)]
pub struct Table {
    /// One line.
    pub title: String,
    /// What must be known to read it; may be empty.
    pub note: String,
    /// Names of the columns.
    pub heading: Vec<String>,
    /// A row that is shorter than the heading is empty at its end.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Without rows.
    pub fn new(title: impl Into<String>, note: impl Into<String>, heading: &[&str]) -> Self {
        let heading = heading.iter().map(|&name| name.to_owned()).collect();
        Self { title: title.into(), note: note.into(), heading, rows: Vec::new() }
    }

    /// Heading and rows.
    pub fn lines(&self) -> Vec<Vec<String>> {
        std::iter::once(&self.heading).chain(&self.rows).cloned().collect()
    }

    /// Heading and rows as Markdown.
    pub fn markdown_rows(&self) -> String {
        let line = |cells: &[String]| {
            let padding = self.heading.len().saturating_sub(cells.len());
            format!("| {}{} |\n", cells.join(" | "), " | ".repeat(padding))
        };
        let rule = format!("|---|{}\n", "---:|".repeat(self.heading.len().saturating_sub(1)));
        let body: String = self.rows.iter().map(|row| line(row)).collect();
        format!("{}{rule}{body}", line(&self.heading))
    }

    /// As Markdown, with the title as a heading of the second level.
    pub fn markdown(&self) -> String {
        let note = if self.note.is_empty() { String::new() } else { format!("{}\n\n", self.note) };
        format!("## {}\n\n{note}{}", self.title, self.markdown_rows())
    }
}

/// A figure with so many decimals; nothing at all where there is none.
pub fn cell(value: Option<f64>, decimals: usize) -> String {
    value.map_or(String::new(), |value| format!("{value:.decimals$}"))
}

/// Our figure, and a paper's beside it if it has one.
pub fn beside(ours: f64, theirs: Option<f64>, decimals: [usize; 2]) -> String {
    let ours = cell(Some(ours), decimals[0]);
    match theirs {
        Some(theirs) => format!("{ours} / {}", cell(Some(theirs), decimals[1])),
        None => ours,
    }
}

/// A scene's name, and that of a paper's scene of as many triangles.
pub fn scene_label(name: &str, triangles: usize, paper: Option<&str>) -> String {
    match paper {
        Some(paper) => format!("{name} (P: {paper})"),
        None => format!("{name}, {triangles} triangles"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_rows_are_padded() {
        let mut table = Table::new("t", "", &["a", "b", "c"]);
        table.rows.push(vec!["x".to_owned(), cell(Some(1.25), 1)]);
        table.rows.push(vec!["y".to_owned(), cell(None, 1), cell(Some(2.0), 0)]);
        let expected = "## t\n\n| a | b | c |\n|---|---:|---:|\n| x | 1.2 |  |\n| y |  | 2 |\n";
        assert_eq!(table.markdown(), expected);
        assert_eq!(table.lines().len(), 3);
        let pairs = [beside(1.234, Some(5.0), [2, 1]), beside(1.0, None, [0, 0])];
        assert_eq!(pairs, ["1.23 / 5.0", "1"]);
    }
}
