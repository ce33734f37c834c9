//! The text of MTL files, made into materials: `cargo fuzz run mtl`.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = dapple::formats::obj::check_mtl(bytes);
});
