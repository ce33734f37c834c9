//! PLY files, cut into triangles: `cargo fuzz run ply`.
#![no_main]

use std::path::Path;

use dapple::formats::{LoadOptions, MissingTexture, ply};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let missing_texture = MissingTexture::Magenta;
    let options = LoadOptions { missing_texture, ..LoadOptions::default() };
    let _ = ply::parse(Path::new("no-such-folder/fuzz.ply"), bytes, &options);
});
