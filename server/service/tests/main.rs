//! The service over real sockets, as modules of one binary. `quiet.rs` is another: it measures the
//! threads of its process.

mod clock;
mod faults;
mod guards;
mod http;
mod jobs;
mod lavapipe;
mod load;
mod steering;
mod stream;
mod support;
