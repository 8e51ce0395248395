//! The service: pages, sessions and frames over HTTP and WebSocket.
//!
//! Modules in the order of the way from a request to a frame:
//!
//! - [`options`]: where to listen, who may ask, how much;
//! - [`server`]: binds, starts the threads, serves, shuts down;
//! - `connections`: a bounded number of them, with time-outs; `watchdog`: the end of it all;
//! - `origin`, `attempts`, `refusals`: whose requests are heard, and what the log says of others;
//! - `routes`: HTTP addresses; errors leave as [`problem`] documents;
//! - `socket`: one conversation a WebSocket;
//! - `session`, `sessions`: what a client has set, kept for a while after its connection drops;
//! - `scenes`: built-in scenes, built once; `guides`: what steers a camera through them;
//! - [`render_thread`] over a [`backend`]: the one thread that owns the device;
//! - `jobs`: render jobs and their results; `stills`: their pictures on the way through that thread;
//! - `encoder_pool`: compression, on threads of its own;
//! - `outbox`: the newest frame and the waiting messages of a session, back to its socket;
//! - `telemetry`: what is counted.
//!
//! Threads meet in slots that hold the newest value only, so nothing between them can pile up:
//! the render thread reads what each session wants *now*, and a frame that was not fetched is
//! replaced by a newer one.

mod attempts;
pub mod backend;
mod bell;
mod clock;
mod connections;
mod encoder_pool;
mod guides;
mod jobs;
pub mod options;
mod origin;
mod outbox;
mod panics;
pub mod problem;
mod refusals;
pub mod render_thread;
mod routes;
mod scenes;
pub mod server;
mod session;
mod sessions;
mod socket;
mod stills;
mod telemetry;
mod watchdog;

pub use jobs::{DataError, DataFolder, JobLimits};
pub use options::{ServeError, ServeOptions, ServiceLimits};
pub use server::{serve, serve_on};
