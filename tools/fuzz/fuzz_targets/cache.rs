//! The bytes of a cache file to a scene and hits of a few rays. The size and the check of the section table are made right
//! after each mutation, as a hostile writer would.

#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use std::ops::Range;
use trimray::cache::CacheFile;

/// Where the header holds the file's size, the number of sections and the check of the table; and where the table begins.
const FILE_SIZE: Range<usize> = 64..72;
const SECTIONS: Range<usize> = 72..76;
const TABLE_CHECK: Range<usize> = 80..88;
const TABLE: usize = 88;
const ENTRY: usize = 24;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(file) = CacheFile::from_bytes(bytes) {
        trimray_fuzz::trace(&file.scene());
    }
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, _seed: u32| {
    let size = fuzzer_mutate(data, size, max_size);
    let bytes = &mut data[..size];
    if size >= TABLE {
        bytes[FILE_SIZE].copy_from_slice(&(size as u64).to_le_bytes());
        let count = u32::from_le_bytes(bytes[SECTIONS].try_into().expect("four bytes")) as usize;
        let end = TABLE.saturating_add(count.saturating_mul(ENTRY)).min(size);
        let hash = blake3::hash(&bytes[TABLE..end]);
        bytes[TABLE_CHECK].copy_from_slice(&hash.as_bytes()[..8]);
    }
    size
});
