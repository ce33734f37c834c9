//! TOML scenes, without the files that they place: `cargo fuzz run toml`.
#![no_main]

use dapple::formats::toml;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = toml::check(bytes);
});
