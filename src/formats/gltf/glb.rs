//! The binary container: a header of 12 bytes, then chunks (glTF 2.0, 4).

use super::json::Fault;

/// The two chunks that matter.
#[derive(Debug, PartialEq, Eq)]
pub struct Glb<'a> {
    /// The document.
    pub json: &'a [u8],
    /// What the first buffer refers to.
    pub binary: Option<&'a [u8]>,
    /// Bytes after the end that the header declares.
    pub trailing: usize,
}

const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BINARY: u32 = u32::from_le_bytes(*b"BIN\0");

/// Whether a file says that it is a container.
pub fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(b"glTF")
}

/// Takes a container apart. Chunks of other types are skipped, as the specification asks.
pub fn split(bytes: &[u8]) -> Result<Glb<'_>, Fault> {
    let broken = |message: String| Err(Fault::new("", message));
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return broken(format!("a GLB header takes 12 bytes, the file has {}", bytes.len()));
    };
    if version != 2 {
        return broken(format!("GLB version {version} is not supported, only 2"));
    }
    let length = length as usize;
    let Some(mut rest) = bytes.get(12..length.max(12)) else {
        return broken(format!("the header declares {length} bytes, the file has {}", bytes.len()));
    };

    let mut json = None;
    let mut binary = None;
    while !rest.is_empty() {
        let at = length - rest.len();
        let (Some(size), Some(kind)) = (word(rest, 0), word(rest, 4)) else {
            return broken(format!("the chunk header at byte {at} is cut off"));
        };
        let size = size as usize;
        let Some(content) = rest[8..].get(..size) else {
            let left = rest.len() - 8;
            return broken(format!("the chunk at byte {at} declares {size} bytes of {left}"));
        };
        match kind {
            JSON if json.is_none() => json = Some(content),
            BINARY if json.is_some() && binary.is_none() => binary = Some(content),
            JSON | BINARY => return broken(format!("the chunk at byte {at} is out of place")),
            _ if json.is_none() => return broken("the first chunk is not JSON".to_owned()),
            _ => {}
        }
        rest = &rest[8 + size..];
    }
    match json {
        Some(json) => Ok(Glb { json, binary, trailing: bytes.len() - length.max(12) }),
        None => broken("has no JSON chunk".to_owned()),
    }
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..at + 4)?;
    Some(u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn container(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        for (kind, content) in chunks {
            bytes.extend((content.len() as u32).to_le_bytes());
            bytes.extend(*kind);
            bytes.extend(*content);
        }
        let length = bytes.len() as u32;
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        bytes
    }

    #[test]
    fn chunks_are_found_and_unknown_ones_skipped() {
        let bytes = container(&[(b"JSON", b"{}  "), (b"BIN\0", b"abcd"), (b"what", b"")]);
        let expected = Glb { json: b"{}  ", binary: Some(b"abcd"), trailing: 0 };
        assert_eq!(split(&bytes), Ok(expected));
    }

    #[test]
    fn every_truncation_is_an_error() {
        let bytes = container(&[(b"JSON", b"{}  "), (b"BIN\0", b"abcd")]);
        for end in 0..bytes.len() {
            assert!(split(&bytes[..end]).is_err(), "cut at {end}");
        }
    }

    #[test]
    fn a_chunk_that_claims_more_than_there_is_is_an_error() {
        let mut bytes = container(&[(b"JSON", b"{}  ")]);
        bytes[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(split(&bytes).is_err());
    }

    #[test]
    fn order_matters() {
        assert!(split(&container(&[(b"BIN\0", b"abcd"), (b"JSON", b"{}  ")])).is_err());
        assert!(split(&container(&[])).is_err());
    }
}
