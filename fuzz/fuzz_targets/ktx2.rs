//! Anything that begins as KTX 2.0 files do: `cargo fuzz run ktx2`.
#![no_main]

use dapple::texture::{FileLevels, Image};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = Image::decode_noting(bytes, "fuzz.ktx2", FileLevels::All);
});
