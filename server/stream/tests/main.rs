//! Messages, header, pacing and encoders, as modules of one binary: linking is most of its cost.

mod encode;
mod header;
mod mutations;
mod pacing;
mod protocol;
mod typescript;
