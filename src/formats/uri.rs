//! References from a scene's file to others: URIs, kept within the folder of the scene.

use std::io;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use super::read::read_regular;

/// Base64 with or without its padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// What a URI stands for.
#[derive(Debug, PartialEq, Eq)]
pub enum Resource {
    /// The bytes themselves, from a data URI.
    Bytes(Vec<u8>),
    /// Files below the scene's folder that it may mean, the likeliest first.
    Files(Vec<PathBuf>),
}

/// Understands a URI of a scene that lies in `folder`.
///
/// # Errors
/// What is wrong with it: a scheme other than `data:`, a path that is absolute or leaves `folder`,
/// broken base64.
pub fn resolve(folder: &Path, uri: &str) -> Result<Resource, String> {
    if let Some(data) = strip_prefix_ignoring_case(uri, "data:") {
        return decode_data(data).map(Resource::Bytes);
    }
    if let Some(scheme) = scheme(uri) {
        return Err(format!("{scheme}: addresses are not fetched, only files beside the scene"));
    }
    // As written in the specification; then, for exporters that do not escape, as it stands; then
    // as Windows spells paths.
    let decoded = decode_percent(uri);
    let mut files = Vec::new();
    let mut problem = None;
    let spellings = [decoded.as_deref(), Some(uri)];
    for spelling in spellings.into_iter().flatten() {
        let slashed = spelling.replace('\\', "/");
        match (below(folder, &slashed), below(folder, spelling)) {
            // Judged with the backslash as a separator too, which it is on some systems.
            (Ok(slashed), Ok(plain)) => files.extend([plain, slashed]),
            (Err(error), _) | (_, Err(error)) => problem = problem.or(Some(error)),
        }
    }
    files.dedup();
    match problem {
        Some(problem) => Err(problem.to_owned()),
        None => Ok(Resource::Files(files)),
    }
}

/// The bytes that a URI stands for.
///
/// # Errors
/// See [`resolve`], or why the file cannot be read.
pub fn read(folder: &Path, uri: &str) -> Result<Vec<u8>, String> {
    let files = match resolve(folder, uri)? {
        Resource::Bytes(bytes) => return Ok(bytes),
        Resource::Files(files) => files,
    };
    let mut first = None;
    for file in files {
        match read_regular(&file) {
            Ok(bytes) => return Ok(bytes),
            Err(error) => first = first.or(Some(error)),
        }
    }
    Err(match first {
        Some(error) if error.kind() == io::ErrorKind::NotFound => "no such file".to_owned(),
        Some(error) => error.to_string(),
        None => "names no file".to_owned(),
    })
}

/// The file that a URI names, which is there.
///
/// # Errors
/// See [`resolve`], or that there is no such file.
pub fn file(folder: &Path, uri: &str) -> Result<PathBuf, String> {
    match resolve(folder, uri)? {
        Resource::Bytes(_) => Err("is no file but data".to_owned()),
        Resource::Files(files) => {
            files.into_iter().find(|file| file.exists()).ok_or_else(|| "no such file".to_owned())
        }
    }
}

fn strip_prefix_ignoring_case<'a>(text: &'a str, prefix: &str) -> Option<&'a str> {
    let head = text.get(..prefix.len())?;
    head.eq_ignore_ascii_case(prefix).then(|| &text[prefix.len()..])
}

/// The scheme of a URI that has one (RFC 3986, 3.1).
fn scheme(uri: &str) -> Option<&str> {
    let (scheme, _) = uri.split_once(':')?;
    let letters = |c: char| c.is_ascii_alphanumeric() || "+-.".contains(c);
    let is_scheme = scheme.starts_with(|c: char| c.is_ascii_alphabetic());
    (is_scheme && scheme.chars().all(letters)).then_some(scheme)
}

/// The content of a data URI, which follows `data:` (RFC 2397).
fn decode_data(data: &str) -> Result<Vec<u8>, String> {
    let (header, content) =
        data.split_once(',').ok_or("the data URI has no comma before its content")?;
    let base64 = header.rsplit(';').next().is_some_and(|last| last.eq_ignore_ascii_case("base64"));
    let escaped = content.contains('%');
    if base64 && !escaped {
        return BASE64.decode(content).map_err(|error| format!("broken base64: {error}"));
    }
    let plain = decode_percent_bytes(content).ok_or("the data URI has a broken % escape")?;
    if !base64 {
        return Ok(plain);
    }
    BASE64.decode(plain).map_err(|error| format!("broken base64: {error}"))
}

/// `folder` and `path`, which must stay within.
fn below(folder: &Path, path: &str) -> Result<PathBuf, &'static str> {
    const OUTSIDE: &str = "leads out of the scene's folder, which is not followed";
    if path.is_empty() {
        return Err("names no file");
    }
    if path.contains('\0') || (cfg!(windows) && path.contains(':')) {
        return Err("is no name of a file");
    }
    if path.starts_with('/') {
        return Err("is an absolute path, which is not followed");
    }
    let mut inside = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                inside.pop().ok_or(OUTSIDE)?;
            }
            name => inside.push(name),
        }
    }
    if inside.is_empty() {
        return Err("names no file");
    }
    Ok(inside.into_iter().fold(folder.to_path_buf(), |path, name| path.join(name)))
}

/// Text with its % escapes resolved, if these are whole and give UTF-8.
fn decode_percent(text: &str) -> Option<String> {
    String::from_utf8(decode_percent_bytes(text)?).ok()
}

fn decode_percent_bytes(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let high = char::from(rest.next()?).to_digit(16)?;
            let low = char::from(rest.next()?).to_digit(16)?;
            bytes.push((high * 16 + low) as u8);
        } else {
            bytes.push(byte);
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(uri: &str) -> Result<PathBuf, String> {
        match resolve(Path::new("scenes"), uri)? {
            Resource::Files(files) => Ok(files[0].clone()),
            Resource::Bytes(_) => Err("is data".to_owned()),
        }
    }

    #[test]
    fn relative_uris_name_files_below_the_folder() {
        let file = |path: &str| Ok(Path::new("scenes").join(path));
        assert_eq!(first("a.bin"), file("a.bin"));
        assert_eq!(first("./t/../t/two%20words.png"), file("t/two words.png"));
        assert_eq!(first(" two  words.png"), file(" two  words.png"));
        assert_eq!(first("100%.png"), file("100%.png"));
    }

    #[test]
    fn nothing_leads_out_of_the_folder() {
        for uri in [
            "/etc/passwd",
            "../a.bin",
            "a/../../b.bin",
            "%2e%2e/a.bin",
            "..\\a.bin",
            "\\\\server\\share",
            "%2Fetc/passwd",
            "file:///etc/passwd",
            "https://example.org/a.bin",
            "C:\\a.bin",
            "a%00.bin",
            "",
            ".",
        ] {
            assert!(first(uri).is_err(), "{uri:?} gives {:?}", first(uri));
        }
    }

    #[test]
    fn data_uris_are_decoded() {
        let data = |uri: &str| resolve(Path::new(""), uri);
        assert_eq!(data("data:;base64,AAEC"), Ok(Resource::Bytes(vec![0, 1, 2])));
        assert_eq!(data("data:a/b;base64,AAE="), Ok(Resource::Bytes(vec![0, 1])));
        assert_eq!(data("DATA:a/b;base64,AAE"), Ok(Resource::Bytes(vec![0, 1])));
        assert_eq!(data("data:text/plain,a%20b"), Ok(Resource::Bytes(b"a b".to_vec())));
        assert!(data("data:a/b;base64,!").is_err());
        assert!(data("data:a/b;base64").is_err());
    }
}
