//! An IGES file to a model.

#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(model) = trimray::iges::read(bytes) {
        trimray_fuzz::check(&model);
    }
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    trimray_fuzz::mutate_text(data, size, max_size, seed)
});
