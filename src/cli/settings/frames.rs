//! Frames of an animation: which ones, and their numbers in the names of files.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use crate::cli::error::CliError;

/// Frames of an animation, from the first to the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frames {
    /// The first.
    pub first: u32,
    /// The last, which is one of them.
    pub last: u32,
}

impl Frames {
    /// All, in their order.
    pub fn each(self) -> RangeInclusive<u32> {
        self.first..=self.last
    }

    /// How many there are, at least 1.
    pub fn count(self) -> u64 {
        u64::from(self.last - self.first) + 1
    }
}

/// Frames, as in `1..240`, or one of them.
pub(super) fn frames(text: &str) -> Result<Frames, String> {
    let form = || "expected the first frame and the last, as in 1..240, or one".to_owned();
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    let number = |text: &str| text.parse::<u32>().map_err(|_| form());
    let (first, last) = (number(first)?, number(last)?);
    if first <= last {
        Ok(Frames { first, last })
    } else {
        Err("the last frame must not be before the first".to_owned())
    }
}

/// A name with a place for the number of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Numbered<'a> {
    /// What is before the number.
    pub before: &'a str,
    /// The digits that it has at least.
    pub digits: usize,
    /// What is after it.
    pub after: &'a str,
}

/// The place for a number in a name: its last row of `#`, a digit each. None if there is none.
pub fn find_number(name: &str) -> Option<Numbered<'_>> {
    let end = name.rfind('#')? + 1;
    let before = name[..end].trim_end_matches('#');
    Some(Numbered { before, digits: end - before.len(), after: &name[end..] })
}

/// A path with the number of a frame in its place.
///
/// # Errors
/// If the path cannot be read as text.
pub fn number(path: &Path, frame: u32) -> Result<PathBuf, CliError> {
    let text = path.to_str().ok_or_else(|| {
        CliError::Usage(format!("{}: with --frames, names must be UTF-8", path.display()))
    })?;
    Ok(find_number(text).map_or_else(
        || path.to_owned(),
        |Numbered { before, digits, after }| format!("{before}{frame:0digits$}{after}").into(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_read_with_both_ends() {
        assert_eq!(frames("1..240").map(Frames::count), Ok(240));
        assert_eq!(frames("7"), Ok(Frames { first: 7, last: 7 }));
        for wrong in ["", "a", "3..1", "-1..3", "1..", "..1", "1..4294967296", "1...3"] {
            assert!(frames(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_last_row_of_signs_is_the_number() {
        let numbered = |path: &str| number(Path::new(path), 7).expect("UTF-8");
        for (path, expected) in [
            ("a/out.####.exr", "a/out.0007.exr"),
            ("c#/out.#.exr", "c#/out.7.exr"),
            ("##/a.exr", "07/a.exr"),
            ("a.exr", "a.exr"),
        ] {
            assert_eq!(numbered(path), Path::new(expected));
        }
        assert_eq!(number(Path::new("##"), 12345).expect("UTF-8"), Path::new("12345"));
    }
}
