//! Anything that begins as KTX 2.0 files do: `cargo fuzz run ktx2`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = dapple::texture::Image::decode(bytes, "fuzz.ktx2");
});
