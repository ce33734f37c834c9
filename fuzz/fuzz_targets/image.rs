//! Images, as textures and as environments: `cargo fuzz run image`.
#![no_main]

use std::io::Cursor;
use std::path::Path;

use dapple::formats::{EnvironmentImage, NotFinite};
use dapple::texture::Image;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for name in ["fuzz.image", "fuzz.tga"] {
        let _ = Image::decode(bytes, name);
    }
    let (source, length) = (Cursor::new(bytes), bytes.len() as u64);
    let _ = EnvironmentImage::decode(source, length, Path::new("fuzz.image"), NotFinite::Repair);
});
