//! From bytes to the outermost table.

use std::path::Path;

use toml::de::DeTable;

use super::reader::{Source, Table};
use crate::formats::LoadError;

/// The longest file: it holds no geometry.
const MAX_BYTES: usize = 16 << 20;

/// Parses the text and lends its outermost table.
pub(super) fn with_root<T>(
    path: &Path,
    bytes: &[u8],
    read: impl for<'d> FnOnce(&Table<'d>) -> Result<T, LoadError>,
) -> Result<T, LoadError> {
    if bytes.len() > MAX_BYTES {
        let message = format!("is larger than {} MiB, which no TOML scene is", MAX_BYTES >> 20);
        return Err(LoadError::invalid(path, "", message));
    }
    let text = std::str::from_utf8(bytes)
        .map_err(|_| LoadError::invalid(path, "", "is not text in UTF-8"))?;
    let source = Source::new(path, text);
    let parsed = DeTable::parse(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        source.fault(at, error.message())
    })?;
    read(&Table::new(&source, parsed.get_ref(), "", 0))
}
