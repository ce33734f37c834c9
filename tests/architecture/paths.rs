//! The paths by which a source names what other files of the crate define.

use super::sources::Source;

/// A path from the crate's root.
#[derive(Debug)]
pub struct Path {
    /// Its names; the last one may be `*`.
    pub names: Vec<String>,
    /// Whether it stands in a `use` statement, and so gives its last name to the module.
    pub imported: bool,
}

/// All paths that begin with `crate`, `super`, `self` or a module that the source declares.
pub fn paths(source: &Source) -> Vec<Path> {
    let children = declared_modules(&source.code);
    let mut paths = Vec::new();
    let mut rest = String::with_capacity(source.code.len());
    for statement in split_at_uses(&source.code) {
        match statement {
            Piece::Use(tree) => {
                let written = expand(&tree);
                paths.extend(written.iter().filter_map(|path| {
                    let names = resolve(path, &source.module, &children)?;
                    Some(Path { names, imported: true })
                }));
            }
            Piece::Code(code) => rest.push_str(code),
        }
    }
    for written in inline_paths(&rest) {
        if let Some(names) = resolve(&written, &source.module, &children) {
            paths.push(Path { names, imported: false });
        }
    }
    paths
}

enum Piece<'a> {
    /// What stands between `use` and `;`.
    Use(String),
    Code(&'a str),
}

fn split_at_uses(code: &str) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    let mut rest = code;
    while let Some((start, length)) = next_use(rest) {
        let (before, after) = (&rest[..start], &rest[start + length..]);
        let end = after.find(';').unwrap_or(after.len());
        pieces.push(Piece::Code(before));
        pieces.push(Piece::Use(after[..end].split_whitespace().collect::<Vec<_>>().join(" ")));
        rest = &after[end..];
    }
    pieces.push(Piece::Code(rest));
    pieces
}

/// Where the next word `use` stands, with the blank behind it, at the start of a statement.
fn next_use(code: &str) -> Option<(usize, usize)> {
    code.match_indices("use ").map(|(at, word)| (at, word.len())).find(|&(at, _)| {
        let before = code[..at].trim_end_matches([' ', '\t']);
        before.is_empty() || before.ends_with(['\n', '{', ';', ')']) || before.ends_with("pub")
    })
}

/// `a::{b, c::{self, d}}` as `a::b`, `a::c`, `a::c::d`; names after `as` are left out.
fn expand(tree: &str) -> Vec<String> {
    let Some((prefix, group)) = tree.split_once('{') else {
        let path = tree.split(" as ").next().unwrap_or_default().trim();
        return vec![path.strip_suffix("::self").unwrap_or(path).to_owned()];
    };
    let group = group.trim_end().strip_suffix('}').unwrap_or(group);
    let (mut parts, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&group[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&group[start..]);
    let parts = parts.into_iter().map(str::trim).filter(|part| !part.is_empty());
    parts.flat_map(|part| expand(&format!("{}{part}", prefix.trim()))).collect()
}

/// The modules that a source declares.
fn declared_modules(code: &str) -> Vec<String> {
    let lines = code.lines().filter_map(|line| line.trim().strip_suffix(';'));
    let names = lines.filter_map(|line| line.strip_prefix("mod ").or(line.split(" mod ").nth(1)));
    names.map(|name| name.trim().to_owned()).collect()
}

/// Paths of two names and more, outside of `use` statements.
fn inline_paths(code: &str) -> Vec<String> {
    let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let words = code.split(|c: char| !is_path(c)).map(|word| word.trim_matches(':'));
    words.filter(|word| word.contains("::")).map(str::to_owned).collect()
}

/// The path from the crate's root; `None` if it leads to another crate or to a local name.
fn resolve(path: &str, module: &[String], children: &[String]) -> Option<Vec<String>> {
    let names: Vec<&str> = path.split("::").map(str::trim).collect();
    let (base, rest): (&[String], &[&str]) = match names[0] {
        "crate" => (&[], &names[1..]),
        "self" => (module, &names[1..]),
        "super" => {
            let up = names.iter().take_while(|name| **name == "super").count();
            (module.get(..module.len().checked_sub(up)?)?, &names[up..])
        }
        first if children.iter().any(|child| child == first) => (module, &names),
        _ => return None,
    };
    Some(base.iter().cloned().chain(rest.iter().map(|&name| name.to_owned())).collect())
}
