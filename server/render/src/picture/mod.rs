//! A picture being made, apart from any device: how many samples it has, what restarts it, when it is
//! finished, and what of the plan its next frame does.

mod accumulation;
mod pixel_offsets;
mod share;
mod slices;

pub(crate) use accumulation::{Accumulation, Work};
pub(crate) use pixel_offsets::{pixel_offset, spread_pairs};
pub(crate) use share::{Share, When};
pub(crate) use slices::{Cut, Slice, Slices, Sweep};
