//! Kitty's graphics protocol, <https://sw.kovidgoyal.net/kitty/graphics-protocol/>.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// The most that a chunk may hold.
const CHUNK: usize = 4096;

/// The bytes that show a PNG over so many rows at the cursor, which stays. It replaces the picture
/// of the same `id`.
pub fn encode(png: &[u8], rows: usize, id: u32) -> String {
    let data = STANDARD.encode(png);
    let mut text = String::with_capacity(data.len() + data.len() / 64 + 64);
    // Base64 is ASCII: any place is one to cut at.
    let mut rest = &*data;
    let mut keys = format!("a=T,f=100,i={id},p=1,q=2,C=1,r={rows},");
    while !rest.is_empty() {
        let (chunk, after) = rest.split_at(CHUNK.min(rest.len()));
        let more = u8::from(!after.is_empty());
        // Writing to a string cannot fail.
        let _ = write!(text, "\x1b_G{keys}m={more};{chunk}\x1b\\");
        "q=2,".clone_into(&mut keys);
        rest = after;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_joined_are_the_file() {
        let png: Vec<u8> = (0..10_000_u32).map(|it| (it * 7) as u8).collect();
        let text = encode(&png, 12, 77);
        let chunks: Vec<(&str, &str)> = text
            .split_terminator("\x1b\\")
            .map(|it| it.strip_prefix("\x1b_G").expect("begins").split_once(';').expect("keys"))
            .collect();
        assert_eq!(chunks[0].0, "a=T,f=100,i=77,p=1,q=2,C=1,r=12,m=1");
        let more: Vec<&str> = chunks.iter().map(|(keys, _)| &keys[keys.len() - 3..]).collect();
        assert_eq!(more, ["m=1", "m=1", "m=1", "m=0"]);
        assert!(chunks.iter().all(|(_, data)| data.len() <= 4096));
        let data: String = chunks.iter().map(|(_, data)| *data).collect();
        assert_eq!(STANDARD.decode(data).expect("base64"), png);
    }
}
