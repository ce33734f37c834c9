//! A line in a PNG that says what it is a picture of.
//!
//! A `tEXt` chunk with the keyword `dapple`, behind the head: PNG (third edition), 5 and 11.3.3.1.

use super::FilmError;
use std::fs;
use std::path::Path;

/// The bytes of a file before its first chunk.
const SIGNATURE: usize = 8;
/// The bytes of a chunk besides its data: length, type and checksum.
const CHUNK: usize = 12;
/// The bytes of the head, `IHDR`, with all of that.
const HEAD: usize = CHUNK + 13;
/// What the data begin with.
const KEYWORD: &[u8] = b"dapple\0";

/// Puts a label of ASCII into the bytes of a PNG that was just encoded.
pub fn insert(png: &mut Vec<u8>, label: &str) {
    let data = [b"tEXt", KEYWORD, label.as_bytes()].concat();
    let length = (data.len() - 4) as u32;
    let chunk = [&length.to_be_bytes(), &*data, &crc32fast::hash(&data).to_be_bytes()].concat();
    let at = SIGNATURE + HEAD;
    png.splice(at..at, chunk);
}

/// The label of a PNG, if it has one that is sound.
///
/// # Errors
/// [`FilmError::Read`].
pub fn read(path: &Path) -> Result<Option<String>, FilmError> {
    let bytes = fs::read(path).map_err(|error| FilmError::read(path, error))?;
    Ok(find(bytes.get(SIGNATURE + HEAD..).unwrap_or_default()))
}

/// The label in the chunk that bytes begin with.
fn find(bytes: &[u8]) -> Option<String> {
    let (length, rest) = bytes.split_first_chunk()?;
    let (data, rest) = rest.split_at_checked(4 + u32::from_be_bytes(*length) as usize)?;
    let (sum, _) = rest.split_first_chunk()?;
    let label = data.strip_prefix(b"tEXt")?.strip_prefix(KEYWORD)?;
    let is_sound = u32::from_be_bytes(*sum) == crc32fast::hash(data);
    String::from_utf8(label.to_vec()).ok().filter(|_| is_sound)
}

#[cfg(test)]
mod tests {
    use super::super::{Picture, Tonemap, Window, png};
    use super::*;

    #[test]
    fn a_label_is_read_as_it_was_written_and_changes_no_pixel() {
        let folder = tempfile::tempdir().expect("a folder");
        let (plain, labelled) = (folder.path().join("a.png"), folder.path().join("b.png"));
        let window = Window::of_size(3, 1);
        let mut picture = Picture::new(window, window);
        picture.set_aov("", "RGB", &[[0.1, 0.5, 0.9]; 3]);
        png::write(&plain, &picture, Tonemap::Srgb, 0.0, None).expect("written");
        png::write(&labelled, &picture, Tonemap::Srgb, 0.0, Some("a b")).expect("written");
        assert_eq!(read(&plain).expect("read"), None);
        assert_eq!(read(&labelled).expect("read").as_deref(), Some("a b"));
        assert_eq!(png::read(&plain).expect("sound"), png::read(&labelled).expect("sound"));
        let mut bytes = fs::read(&labelled).expect("read");
        bytes[SIGNATURE + HEAD + 16] ^= 1;
        fs::write(&labelled, &bytes).expect("written");
        assert_eq!(read(&labelled).expect("read"), None, "its checksum is another");
        for length in 0..SIGNATURE + HEAD + CHUNK + 9 {
            fs::write(&labelled, &bytes[..length]).expect("cut");
            assert_eq!(read(&labelled).expect("read"), None);
        }
    }
}
