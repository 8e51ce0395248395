//! Blocks of compressed bytes: into a buffer whose size is known before.

mod blosc;
mod blosclz;

pub(crate) use blosc::blosc;

use flate2::{Decompress, FlushDecompress};

use crate::VolumeError;

/// The most that deflate can expand: 258 bytes from two bits, and rounding up for the header.
pub(crate) const ZIP_RATIO: u64 = 1040;
/// The most that blosc can expand. Its worst codec by far is zstd, whose blocks repeat one byte up
/// to 128 KiB from 4 bytes.
pub(crate) const BLOSC_RATIO: u64 = 1 << 16;

/// Inflates a zlib stream that has to fill `output` exactly.
pub(crate) fn zip(input: &[u8], output: &mut [u8], field: &str) -> Result<(), VolumeError> {
    let mut state = Decompress::new(true);
    state
        .decompress(input, output, FlushDecompress::Finish)
        .map_err(|error| broken(field, &error.to_string()))?;
    if state.total_out() != output.len() as u64 {
        let found = format!("{} bytes once inflated", state.total_out());
        return Err(VolumeError::invalid(
            field,
            found,
            format!("{}", output.len()),
        ));
    }
    Ok(())
}

fn broken(field: &str, why: &str) -> VolumeError {
    VolumeError::invalid(
        field,
        format!("broken data ({why})"),
        "a whole compressed block",
    )
}
