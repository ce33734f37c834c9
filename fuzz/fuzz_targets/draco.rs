//! Anything, as a mesh packed by Draco: `cargo fuzz run draco`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = dapple::formats::gltf::check_draco(bytes);
});
