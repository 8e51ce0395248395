//! Picture files: what a renderer yields goes out with everything known about it, and comes back to
//! be compared.
//!
//! [`Layers`] is what one still consists of; [`write_exr`] and [`read_exr`] keep it as `OpenEXR` with
//! named layers and [`Metadata`]; [`read`] takes any picture that `tyndall compare` accepts;
//! [`display`] shows radiance as the page does; [`hash_json`] names a scene by its content.

mod display;
mod error;
mod exr_read;
mod exr_write;
mod hash;
mod layers;
mod npy;
mod output;
mod png_file;
mod read;

pub use display::{display, exposed};
pub use error::PictureError;
pub use exr_read::read_exr;
pub use exr_write::{encode_exr, write_exr};
pub use hash::{hash_bytes, hash_json, scene_hash};
pub use layers::{Layers, Metadata};
pub use npy::read_npy;
pub use output::{Format, Layer, Output};
pub use png_file::{encode_png, write_png};
pub use read::{Picture, Range, read};
