#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| feti_contact_fuzz::text::run(data));
