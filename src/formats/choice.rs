//! One of several things of a file, chosen by its name or its number.

use std::fmt::Write;

use crate::names::near;

/// Which of the things called `names` is called `wanted`, or else has that number, counted from 0.
pub fn find_by_name_or_number<'a>(
    names: impl IntoIterator<Item = &'a str>,
    wanted: &str,
) -> Option<usize> {
    let mut count = 0;
    let mut named = None;
    for name in names {
        if named.is_none() && name == wanted {
            named = Some(count);
        }
        count += 1;
    }
    named.or_else(|| wanted.parse().ok().filter(|&number| number < count))
}

/// How many names a message lists.
const MOST_LISTED: usize = 12;

/// What to say where there is no `what` called `wanted`: the names that are near, else all there
/// are, each with its number.
pub(super) fn absent(what: &str, wanted: &str, names: &[String]) -> String {
    let mut message = format!("no {what} {wanted:?}; ");
    let near = near(wanted, names.iter().map(String::as_str));
    let shown = |number: usize| match names[number].as_str() {
        "" => number.to_string(),
        name => format!("{number} ({name:?})"),
    };
    let listed = |numbers: &mut dyn Iterator<Item = usize>| {
        numbers.map(shown).collect::<Vec<_>>().join(", ")
    };
    if names.is_empty() {
        message.push_str("it has none");
    } else if near.is_empty() {
        let count = names.len().min(MOST_LISTED);
        let _ = write!(message, "it has {}", listed(&mut (0..count)));
        if count < names.len() {
            let _ = write!(message, " and {} more", names.len() - count);
        }
    } else {
        let all = listed(&mut near.into_iter());
        let _ = write!(message, "did you mean {all}?");
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_goes_before_a_number() {
        let names = ["1", "", "left", "left"];
        for (wanted, found) in
            [("1", Some(0)), ("0", Some(0)), ("left", Some(2)), ("3", Some(3)), ("4", None)]
        {
            assert_eq!(find_by_name_or_number(names, wanted), found, "{wanted}");
        }
        assert_eq!(find_by_name_or_number(names, "Left"), None);
    }

    #[test]
    fn who_slips_is_told_what_is_near() {
        let names = |all: &[&str]| all.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
        let cameras = names(&["front", "", "left side"]);
        assert_eq!(
            absent("camera", "Frnt", &cameras),
            "no camera \"Frnt\"; did you mean 0 (\"front\")?"
        );
        let all = "no camera \"7\"; it has 0 (\"front\"), 1, 2 (\"left side\")";
        assert_eq!(absent("camera", "7", &cameras), all);
        assert_eq!(absent("scene", "a", &[]), "no scene \"a\"; it has none");
        let many = vec![String::new(); 20];
        assert!(absent("scene", "x", &many).ends_with("10, 11 and 8 more"));
    }
}
