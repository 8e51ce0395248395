//! Tests of the crate as one binary.

mod conformance;
mod sqlite;
