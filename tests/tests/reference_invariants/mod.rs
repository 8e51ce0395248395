//! What holds in every scene whatever its solution is: radiance in equilibrium, channels that know
//! nothing of one another, media that add up, and light that goes both ways.
//!
//! Bounds are 4 standard errors with the variances of both sides, 6.3e-5 a comparison; a picture's
//! single pixels get 5.5, 4e-8 a pixel and 1e-4 for all of them.

#![allow(clippy::print_stdout, reason = "helper functions of tests")]

mod channels;
mod emission;
mod furnace;
mod reciprocity;
mod surfaces;
