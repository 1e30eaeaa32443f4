#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| featherbench_fuzz::drawings(bytes));
