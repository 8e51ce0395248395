//! Reads any bytes as a `.nvdb` file.

#![no_main]

use libfuzzer_sys::fuzz_target;
use tyndall_volume::{ReadOptions, VolumeLimits, nvdb};

fuzz_target!(|bytes: &[u8]| {
    let limits = VolumeLimits {
        file_bytes: 1 << 20,
        grid_bytes: 4 << 20,
    };
    if let Ok(grid) = nvdb::read_bytes(bytes, &ReadOptions::default(), &limits) {
        assert!(grid.bytes() <= limits.grid_bytes && grid.max().is_finite());
    }
});
