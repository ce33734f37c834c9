//! Tables put between the marks of a page.
//!
//! A page says where a table belongs: the line `<!-- results: NAME -->`, then the table, then
//! `<!-- end -->`. All else is the writer's.

use std::fmt::Write as _;

use crate::names::UnknownName;

const START: &str = "<!-- results: ";
const CLOSE: &str = " -->";
const END: &str = "<!-- end -->";

/// What is wrong with a page.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PageError {
    /// A mark names no table.
    #[error("line {0}: {1}")]
    Unknown(usize, UnknownName),
    /// A mark is not followed by an end.
    #[error("line {0}: no `<!-- end -->` follows")]
    Open(usize),
    /// There is none.
    #[error("has no line `<!-- results: NAME -->`")]
    NoMarks,
}

/// The page with all tables as they should be; `tables` are given by name.
///
/// # Errors
/// Marks that make no sense.
pub fn fill(page: &str, tables: &[(&'static str, String)]) -> Result<String, PageError> {
    let (mut text, mut open, mut marks) = (String::new(), None, 0);
    for (number, line) in page.lines().enumerate() {
        let name = line.strip_prefix(START).and_then(|rest| rest.strip_suffix(CLOSE));
        if let Some(name) = name {
            if let Some(first) = open {
                return Err(PageError::Open(first));
            }
            let table = tables.iter().find(|(known, _)| *known == name).ok_or_else(|| {
                let known: Vec<_> = tables.iter().map(|(known, _)| *known).collect();
                PageError::Unknown(number + 1, UnknownName::new("table", name, &known))
            })?;
            let _ = write!(text, "{line}\n{}", table.1);
            (open, marks) = (Some(number + 1), marks + 1);
        }
        if line == END {
            open = None;
        }
        if open.is_none() {
            text.push_str(line);
            text.push('\n');
        }
    }
    match (open, marks) {
        (Some(first), _) => Err(PageError::Open(first)),
        (None, 0) => Err(PageError::NoMarks),
        _ => Ok(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "# P\n\n<!-- results: a -->\n| old |\n| old |\n<!-- end -->\nWords.\n";

    fn tables() -> Vec<(&'static str, String)> {
        vec![("a", "| new |\n".to_owned()), ("b", String::new())]
    }

    #[test]
    fn what_stands_between_marks_is_replaced() {
        let expected = "# P\n\n<!-- results: a -->\n| new |\n<!-- end -->\nWords.\n";
        assert_eq!(fill(PAGE, &tables()).as_deref(), Ok(expected));
        assert_eq!(fill(expected, &tables()).as_deref(), Ok(expected));
    }

    #[test]
    fn marks_that_make_no_sense_are_refused() {
        let told = |page: &str| fill(page, &tables()).expect_err("wrong").to_string();
        assert_eq!(told("words"), "has no line `<!-- results: NAME -->`");
        let open = "line 1: no `<!-- end -->` follows";
        assert_eq!(told("<!-- results: a -->\n| old |\n"), open);
        assert_eq!(told("<!-- results: a -->\n<!-- results: b -->\n<!-- end -->\n"), open);
        let unknown = told("\n<!-- results: c -->\n<!-- end -->\n");
        assert!(unknown.starts_with("line 2: no table `c`; "), "{unknown}");
    }
}
