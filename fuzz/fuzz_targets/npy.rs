//! NumPy files of rays: `cargo fuzz run npy`.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = dapple::formats::npy::read_f32_from(bytes, bytes.len() as u64, Path::new("a.npy"), 8);
});
