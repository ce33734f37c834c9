//! Files that use each other: the strongly connected components of the graph of uses.

use std::collections::{BTreeMap, BTreeSet};

use super::paths::{Path, paths};
use super::sources::Source;

/// For each module the modules whose definitions it uses.
pub type Uses = BTreeMap<Vec<String>, BTreeSet<Vec<String>>>;

/// Who uses whom. A name is followed through the modules that pass it on to the one that defines
/// it; passing a name on is a use as well.
pub fn uses(sources: &[Source]) -> Uses {
    let paths: BTreeMap<&[String], Vec<Path>> =
        sources.iter().map(|source| (&*source.module, paths(source))).collect();
    let of = |(module, named): (&&[String], &Vec<Path>)| {
        let defined = named.iter().filter_map(|path| definer(&path.names, &paths, 0));
        let others = defined.filter(|other| other != module).map(<[String]>::to_vec);
        (module.to_vec(), others.collect())
    };
    paths.iter().map(of).collect()
}

/// The module that defines what a path names.
fn definer<'p>(
    names: &'p [String],
    paths: &'p BTreeMap<&[String], Vec<Path>>,
    followed: usize,
) -> Option<&'p [String]> {
    let length = (0..=names.len()).rev().find(|&length| paths.contains_key(&names[..length]))?;
    let (module, rest) = names.split_at(length);
    let (known, _) = paths.get_key_value(module)?;
    let Some(name) = rest.first().filter(|_| followed < 8) else { return Some(known) };
    let passed_on = paths[module].iter().find(|path| {
        path.imported && path.names.last() == Some(name) && !path.names.starts_with(names)
    });
    passed_on.and_then(|path| definer(&path.names, paths, followed + 1)).or(Some(known))
}

/// Each circle in a line, its modules by name; the crate's root is in none.
pub fn circles(uses: &Uses) -> Vec<String> {
    let reached: BTreeMap<&Vec<String>, BTreeSet<&Vec<String>>> =
        uses.keys().map(|module| (module, reach(module, uses))).collect();
    let mut found = BTreeSet::new();
    for (module, others) in &reached {
        let circle = others.iter().filter(|other| reached[**other].contains(*module));
        let names: Vec<String> = circle.map(|module| module.join("::")).collect();
        if names.len() > 1 {
            found.insert(names.join(", "));
        }
    }
    found.into_iter().collect()
}

/// All modules that a module uses, directly or not.
fn reach<'u>(module: &Vec<String>, uses: &'u Uses) -> BTreeSet<&'u Vec<String>> {
    let mut reached = BTreeSet::new();
    let mut pending = vec![module];
    while let Some(module) = pending.pop() {
        let used = uses.get_key_value(module).map(|(_, used)| used).into_iter().flatten();
        for other in used.filter_map(|other| uses.get_key_value(other)).map(|(other, _)| other) {
            if !other.is_empty() && reached.insert(other) {
                pending.push(other);
            }
        }
    }
    reached
}
