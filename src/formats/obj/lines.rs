//! Statements: lines of words, and the numbers and names in them.

use std::path::Path;

use crate::files::{Front, Meter};
use crate::formats::LoadError;
use crate::math::Vec3;

/// A statement of an OBJ or MTL file.
pub(super) struct Statement<'a> {
    /// Where it starts, counted from 1.
    pub line: usize,
    /// Its first word.
    pub keyword: &'a str,
    /// What follows, without spaces around.
    pub rest: &'a [u8],
}

/// Calls `each` for every statement; empty lines and comments are left out, lines that end in a
/// backslash are joined if `joins`.
///
/// # Errors
/// Where the file is not text, or what `each` says, with the statement's line.
pub(super) fn for_each(
    bytes: &[u8],
    file: &Path,
    (joins, meter): (bool, &Meter),
    mut each: impl FnMut(Statement) -> Result<(), String>,
) -> Result<(), LoadError> {
    let mut bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(LoadError::line(file, 1, "is UTF-16 text: save it as UTF-8"));
    }
    let mut number = 0;
    let mut joined = Vec::new();
    let mut front = Front::new(meter, bytes.len() as u64);
    while !bytes.is_empty() {
        front.move_to(bytes.len() as u64);
        let mut line = next_line(&mut bytes);
        let first = number + 1;
        number = first;
        if joins && line.ends_with(b"\\") && !line.starts_with(b"#") {
            joined.clear();
            while let Some(start) = line.strip_suffix(b"\\") {
                joined.extend_from_slice(start);
                joined.push(b' ');
                line = next_line(&mut bytes);
                number += 1;
            }
            joined.extend_from_slice(line);
            line = joined.trim_ascii();
        }
        if line.is_empty() || line.starts_with(b"#") {
            continue;
        }
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = line.split_at(end);
        // Keywords are short names; anything else is no such file.
        let keyword = str::from_utf8(keyword).ok().filter(|word| {
            word.len() < 40 && word.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
        });
        let statement = keyword
            .map(|keyword| Statement { line: first, keyword, rest: rest.trim_ascii() })
            .ok_or_else(|| format!("{} is not a statement", quote(line)));
        statement.and_then(&mut each).map_err(|message| LoadError::line(file, first, message))?;
    }
    Ok(())
}

/// Takes the next line, without spaces around.
fn next_line<'a>(bytes: &mut &'a [u8]) -> &'a [u8] {
    let end = bytes.iter().position(|&b| b == b'\n');
    let (line, rest) = bytes.split_at(end.unwrap_or(bytes.len()));
    *bytes = rest.get(1..).unwrap_or_default();
    line.trim_ascii()
}

/// Some of the text for a message.
pub(super) fn quote(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text);
    let start: String = text.chars().take(30).collect();
    let more = if start.len() < text.len() { "…" } else { "" };
    format!("'{}{more}'", start.escape_debug())
}

/// The words up to a comment.
pub(super) fn words(rest: &[u8]) -> impl Iterator<Item = &[u8]> {
    rest.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .take_while(|word| !word.starts_with(b"#"))
}

/// A finite number.
pub(super) fn number(word: &[u8]) -> Result<f32, String> {
    let number = str::from_utf8(word).ok().and_then(|word| word.parse::<f32>().ok());
    let number = number.ok_or_else(|| format!("{} is not a number", quote(word)))?;
    if number.is_finite() { Ok(number) } else { Err(format!("{} is not finite", quote(word))) }
}

/// Between `least` and eight numbers, and how many there are.
pub(super) fn numbers(rest: &[u8], least: usize) -> Result<([f32; 8], usize), String> {
    let mut all = [0.0; 8];
    let mut count = 0;
    for word in words(rest) {
        let slot = all.get_mut(count).ok_or("there are more than eight numbers")?;
        *slot = number(word)?;
        count += 1;
    }
    if count < least {
        return Err(format!("expected {least} numbers, found {count}"));
    }
    Ok((all, count))
}

/// A colour of three numbers, or of one for all three.
pub(super) fn color(rest: &[u8]) -> Result<Vec3, String> {
    let color = match numbers(rest, 1)? {
        ([grey, ..], 1) => Vec3::splat(grey),
        ([r, g, b, ..], 3..) => Vec3::new(r, g, b),
        _ => return Err("expected 1 or 3 numbers, found 2".to_owned()),
    };
    if color.min_element() < 0.0 {
        return Err("a colour is negative".to_owned());
    }
    Ok(color)
}

/// A name to the end of the line, without quotes. Bytes that are not UTF-8, as old exporters wrote
/// them, become marks: the same ones in both files.
pub(super) fn name(rest: &[u8]) -> String {
    unquote(&String::from_utf8_lossy(rest)).to_owned()
}

/// A name without the quotes about it.
pub(super) fn unquote(name: &str) -> &str {
    let name = name.trim();
    name.strip_prefix('"').and_then(|inner| inner.strip_suffix('"')).unwrap_or(name)
}

/// Names between spaces; those in quotes may hold spaces, and so may those that have a backslash
/// before each.
pub(super) fn names(mut text: &str) -> Vec<String> {
    let mut names = Vec::new();
    while !text.trim_start().is_empty() {
        text = text.trim_start();
        if let Some((name, rest)) = text.strip_prefix('"').and_then(|text| text.split_once('"')) {
            names.push(name.to_owned());
            text = rest;
            continue;
        }
        let mut before = ' ';
        let end = text.find(|c: char| {
            let escaped = before == '\\';
            before = c;
            c.is_whitespace() && !escaped
        });
        let (name, rest) = text.split_at(end.unwrap_or(text.len()));
        names.push(name.replace("\\ ", " "));
        text = rest;
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statements(text: &[u8]) -> Result<Vec<(usize, String, String)>, LoadError> {
        let mut all = Vec::new();
        for_each(text, Path::new("a.obj"), (true, &Meter::default()), |statement| {
            let rest = String::from_utf8_lossy(statement.rest).into_owned();
            all.push((statement.line, statement.keyword.to_owned(), rest));
            Ok(())
        })?;
        Ok(all)
    }

    #[test]
    fn lines_end_in_any_way_and_go_on_after_a_backslash() {
        let all = statements(b"\xef\xbb\xbf# c \\\r\nv 1 2 \\\r\n  3\n\n\tg a\nf").unwrap();
        let expected = [(2, "v", "1 2  3"), (5, "g", "a"), (6, "f", "")];
        assert_eq!(all, expected.map(|(n, a, b)| (n, a.to_owned(), b.to_owned())));
        assert!(statements(b"v 1 \\").is_ok());
    }

    #[test]
    fn what_is_not_text_is_refused_with_its_line() {
        let message = |text: &[u8]| statements(text).expect_err("is no text").to_string();
        assert_eq!(message(b"\xff\xfev\0"), "a.obj:1: is UTF-16 text: save it as UTF-8");
        assert_eq!(message(b"v 1\n\x89PNG\0\0"), "a.obj:2: '\u{fffd}PNG\\0\\0' is not a statement");
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(number(b"-.5e1"), Ok(-5.0));
        assert_eq!(number(b"1e-099"), Ok(0.0));
        assert_eq!(number(b"1,5"), Err("'1,5' is not a number".to_owned()));
        assert_eq!(number(b"NaN"), Err("'NaN' is not finite".to_owned()));
        assert_eq!(number(b"1e39"), Err("'1e39' is not finite".to_owned()));
        assert_eq!(numbers(b"1 2 # 3", 3), Err("expected 3 numbers, found 2".to_owned()));
        assert_eq!(color(b"0.5"), Ok(Vec3::splat(0.5)));
    }

    #[test]
    fn names_may_hold_spaces_in_quotes() {
        assert_eq!(names(" a.mtl \"b c.mtl\"  d.mtl"), ["a.mtl", "b c.mtl", "d.mtl"]);
        assert_eq!(names("\"open"), ["\"open"]);
        assert_eq!(names("a\\ b.mtl maps\\c.mtl"), ["a b.mtl", "maps\\c.mtl"]);
        assert_eq!(name(b"\"many, many spaces\" "), "many, many spaces");
    }
}
