//! Anything, as the contents of a .gltf or .glb file.
#![no_main]

use std::path::Path;

use dapple::formats::{LoadOptions, MissingTexture, gltf};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let missing_texture = MissingTexture::Magenta;
    let options = LoadOptions { missing_texture, ..LoadOptions::default() };
    let _ = gltf::parse(Path::new("no-such-folder/fuzz.gltf"), bytes, &options);
});
