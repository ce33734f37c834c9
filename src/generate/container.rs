//! The frame of binary glTF: heads of the file and of its two chunks.

use std::io::{self, Write};

use serde_json::Value;

/// Writes all that comes before the binary chunk, of which `binary` bytes are to follow. Returns
/// the length of the file.
///
/// # Errors
/// Those of `out`, and a file that would exceed the 4 GiB of the format.
pub fn write_head(out: &mut dyn Write, document: &Value, binary: u64) -> io::Result<u64> {
    let mut json = serde_json::to_vec(document)?;
    json.resize(json.len().next_multiple_of(4), b' ');
    let bytes = 12 + 8 + json.len() as u64 + 8 + binary;
    let word = |value: u64| {
        let word = u32::try_from(value).map_err(|_| io::Error::other("a .glb ends at 4 GiB"));
        word.map(u32::to_le_bytes)
    };
    for head in [*b"glTF", word(2)?, word(bytes)?, word(json.len() as u64)?, *b"JSON"] {
        out.write_all(&head)?;
    }
    out.write_all(&json)?;
    out.write_all(&word(binary)?)?;
    out.write_all(b"BIN\0")?;
    Ok(bytes)
}
