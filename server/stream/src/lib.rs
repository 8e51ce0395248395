//! What travels between the service and the page, in the order a frame goes through it.
//!
//! - [`pacing`] decides when a client gets its next frame and how well it is compressed,
//! - [`encode`] compresses it,
//! - [`header`] goes in front of it,
//! - [`protocol`] carries everything else as JSON, in unions that `messages` defines; what it says of
//!   steering is in `navigation`.
//!
//! No GPU, no network, no clock: the service brings those.

pub mod encode;
mod facts;
pub mod header;
mod messages;
mod navigation;
pub mod pacing;
pub mod protocol;
