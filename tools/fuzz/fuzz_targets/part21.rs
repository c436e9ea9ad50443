//! The scanner and the decoder of every statement.

#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target};

fuzz_target!(|bytes: &[u8]| {
    trimray::step::count_statements(bytes);
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    trimray_fuzz::mutate_text(data, size, max_size, seed)
});
