//! Measures of pictures against known values, as modules of one binary.

mod flip;
mod measures;
