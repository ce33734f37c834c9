//! Parts of pictures: `cargo fuzz run part`.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| dapple::testing::read_any_part(bytes));
