//! iTerm2's inline images, <https://iterm2.com/documentation-images.html>.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// The bytes that show a PNG over so many rows at the cursor.
pub fn encode(png: &[u8], rows: usize) -> String {
    let (size, data) = (png.len(), STANDARD.encode(png));
    let keys = format!("inline=1;size={size};height={rows};width=auto;preserveAspectRatio=1");
    format!("\x1b]1337;File={keys}:{data}\x07")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_is_told_with_its_size() {
        let text = encode(b"\x89PNG and more", 7);
        let (keys, data) = text.split_once(':').expect("keys before data");
        assert!(keys.starts_with("\x1b]1337;File=inline=1;size=13;height=7;"), "{keys:?}");
        let data = data.strip_suffix('\x07').expect("it ends");
        assert_eq!(STANDARD.decode(data).expect("base64"), b"\x89PNG and more");
    }
}
