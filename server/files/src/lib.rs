//! Files of strangers: what every reader of this project shares, so that no file hangs, fills the
//! memory or ends the process.
//!
//! - [`regular`]: opens regular files only, and reads them up to a limit;
//! - [`relative`]: which names stay inside a folder;
//! - [`guarded`]: runs a decoder that others wrote on a thread that may fail;
//! - [`decode_image`]: PNG, JPEG and Radiance, their size checked before memory is taken;
//! - [`read_exr_header`]: the same check for OpenEXR.

mod exr_header;
mod guard;
mod images;
pub mod regular;
pub mod relative;

pub use exr_header::{ExrError, ExrLimits, read_exr_header};
pub use guard::{DecoderFailed, guarded};
pub use images::{ImageError, ImageLimits, decode_image, decode_radiance};
