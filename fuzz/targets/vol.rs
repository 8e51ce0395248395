//! Reads any bytes as a Mitsuba volume.

#![no_main]

use libfuzzer_sys::fuzz_target;
use tyndall_volume::{VolumeLimits, vol};

fuzz_target!(|bytes: &[u8]| {
    let limits = VolumeLimits {
        file_bytes: 1 << 20,
        grid_bytes: 4 << 20,
    };
    if let Ok(grid) = vol::read_bytes(bytes, &limits) {
        assert!(grid.bytes() <= limits.grid_bytes && grid.max().is_finite());
    }
});
