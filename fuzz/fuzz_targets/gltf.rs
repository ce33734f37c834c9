//! Anything, as the contents of a .gltf or .glb file, posed at a time and at times over a shutter.
#![no_main]

use std::path::Path;

use dapple::formats::{LoadOptions, MissingTexture, gltf};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let missing_texture = MissingTexture::Magenta;
    let shutter = (bytes.len() % 2 == 1).then_some(0.5);
    let time = Some(0.37);
    let options = LoadOptions { missing_texture, time, shutter, ..LoadOptions::default() };
    let _ = gltf::parse(Path::new("no-such-folder/fuzz.gltf"), bytes, &options);
});
