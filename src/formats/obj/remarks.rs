//! What a file asks for and does not get, said once however often it asks.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::Path;

use crate::scene::Notice;

/// Beyond this many different remarks about a file they are only counted.
const MAX_REMARKS: usize = 40;

/// Remarks about one file, each with the line where it first applies.
pub(super) struct Remarks {
    file: String,
    remarks: Vec<Remark>,
    by_message: HashMap<String, usize>,
    left_out: usize,
}

struct Remark {
    line: Option<usize>,
    message: String,
    times: usize,
}

impl Remarks {
    pub(super) fn new(file: &Path) -> Self {
        let file = file.display().to_string();
        Self { file, remarks: Vec::new(), by_message: HashMap::new(), left_out: 0 }
    }

    /// Remarks on a line; only the first of equal messages is kept.
    pub(super) fn add(&mut self, line: usize, message: impl Into<String>) {
        self.push(Some(line), message.into());
    }

    /// Remarks on the file as a whole.
    pub(super) fn add_file(&mut self, message: &str) {
        self.push(None, message.to_owned());
    }

    fn push(&mut self, line: Option<usize>, message: String) {
        let full = self.remarks.len() >= MAX_REMARKS;
        match self.by_message.entry(message) {
            Entry::Occupied(known) => self.remarks[*known.get()].times += 1,
            Entry::Vacant(_) if full => self.left_out += 1,
            Entry::Vacant(new) => {
                self.remarks.push(Remark { line, message: new.key().clone(), times: 1 });
                new.insert(self.remarks.len() - 1);
            }
        }
    }

    /// The notices, in the order of their first occurrence.
    pub(super) fn finish(self) -> Vec<Notice> {
        let Self { file, remarks, left_out, .. } = self;
        let mut notices: Vec<Notice> = remarks
            .into_iter()
            .map(|Remark { line, message, times }| {
                let message = match times {
                    1 => message,
                    _ => format!("{message} (and {} more)", times - 1),
                };
                let place = line.map_or_else(|| file.clone(), |line| format!("{file}:{line}"));
                Notice { place, message }
            })
            .collect();
        if left_out > 0 {
            notices.push(Notice { place: file, message: format!("{left_out} more remarks") });
        }
        notices
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_remarks_are_counted_and_many_are_cut_short() {
        let mut remarks = Remarks::new(Path::new("a.obj"));
        for line in [3, 5, 8] {
            remarks.add(line, "lines are skipped");
        }
        for line in 100..200 {
            remarks.add(line, format!("no material {line}"));
        }
        let notices = remarks.finish();
        assert_eq!(notices.len(), MAX_REMARKS + 1);
        assert_eq!(notices[0].place, "a.obj:3");
        assert_eq!(notices[0].message, "lines are skipped (and 2 more)");
        assert_eq!(notices[MAX_REMARKS].message, "61 more remarks");
    }
}
