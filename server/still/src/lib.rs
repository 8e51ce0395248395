//! One way from a scene to a picture file, whoever asks for it: `tyndall render`, a job, the page.
//!
//! - `task`: the picture in the making, step by step, so that others may have the device in between;
//! - `encode`: the finished picture as the bytes of a file.
//!
//! Where the stop rule counts samples, the same scene gives the same bits on one device, however the steps
//! were cut and whatever else the device did meanwhile.

pub mod encode;
pub mod task;

pub use encode::{EncodeFailed, FinishedStill, encode};
pub use task::{Progress, Step, StillTask};
pub use tyndall_picture::{Format, Layer, Output};
