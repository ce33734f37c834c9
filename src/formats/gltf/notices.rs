//! Notices, gathered: what occurs at many places is said once.

use std::collections::HashMap;
use std::path::Path;

use crate::scene::Notice;

/// What a file asks for and does not get.
#[derive(Debug, Default)]
pub struct Notices {
    found: Vec<Found>,
    by_message: HashMap<String, usize>,
}

#[derive(Debug)]
struct Found {
    message: String,
    first: String,
    others: usize,
}

impl Notices {
    /// Notes `message` about the place that a JSON pointer leads to.
    pub fn add(&mut self, place: impl Into<String>, message: impl Into<String>) {
        let message = message.into();
        if let Some(&at) = self.by_message.get(&message) {
            self.found[at].others += 1;
            return;
        }
        self.by_message.insert(message.clone(), self.found.len());
        self.found.push(Found { message, first: place.into(), others: 0 });
    }

    /// All of them, in the order in which they were met first.
    pub fn finish(self, file: &Path) -> Vec<Notice> {
        let file = file.display();
        let notice = |Found { message, first, others }| Notice {
            place: if first.is_empty() { file.to_string() } else { format!("{file}: {first}") },
            message: match others {
                0 => message,
                1 => format!("{message} (and at one other place)"),
                _ => format!("{message} (and at {others} other places)"),
            },
        };
        self.found.into_iter().map(notice).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_thing_is_said_once() {
        let mut notices = Notices::default();
        notices.add("/a/0", "is odd");
        notices.add("/b/0", "is even");
        notices.add("/a/1", "is odd");
        notices.add("/a/2", "is odd");
        let all = notices.finish(Path::new("x.gltf"));
        assert_eq!(all[0].place, "x.gltf: /a/0");
        assert_eq!(all[0].message, "is odd (and at 2 other places)");
        assert_eq!(all[1].message, "is even");
    }
}
