//! The text of OBJ files, cut into triangles: `cargo fuzz run obj`.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = dapple::formats::obj::check_obj(bytes);
});
