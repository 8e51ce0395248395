//! Run time against error: every figure is a pair, with device, settings and seed.
//!
//! Two measurements. [`FrameBench`] times frames of a moving camera, pass by pass on the device's
//! clock, beside the error of one such frame. [`Suite`] climbs a ladder of settings of each technique
//! at rest and judges every picture against the truth, whole and restricted to the paths that the
//! technique claims; another renderer can be measured beside ([`PeerOptions`]). Results come as
//! text ([`table()`]), [`csv()`], JSON (the rows) and [`html`].

mod budget;
mod claim;
mod error;
mod frames;
mod machine;
mod measures;
mod memory;
mod peer;
pub mod pm_ref;
mod report;
mod row;
mod shot;
mod statistics;
mod subject;
mod suite;
mod table;
mod truth;

pub use budget::Budget;
pub use claim::Claim;
pub use error::BenchError;
pub use frames::{FrameBench, Row};
pub use machine::Machine;
pub use measures::Measures;
pub use peer::PeerOptions;
pub use report::html;
pub use row::{LadderRow, csv};
pub use statistics::Summary;
pub use subject::Subject;
pub use suite::{Exhibit, SceneResult, Suite, default_cache};
pub use table::{Efficiency, efficiencies, table};
pub use truth::TruthOptions;
