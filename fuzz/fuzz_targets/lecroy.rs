#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| rodlab_fuzz::lecroy(bytes));
