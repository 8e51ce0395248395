//! Where a camera may go and what it sees, answered on the CPU from a BVH of the scene's still surfaces.
//!
//! A page asks for it: which way of steering suits the scene (`enclosure`), what "frame all" frames
//! (`framing` of `parts`, `overview`) and what an orbit turns about (`pivot`); how far a step leads before a surface
//! (`step`); which point lies under the pointer (`pick`); why a picture is black (`darkness`). One
//! [`Guide`] serves every session of a scene, on any thread. What moves by keyframes is no obstacle.

mod darkness;
mod enclosure;
mod framing;
mod guide;
mod line;
mod media;
mod overview;
mod parts;
mod pick;
mod pivot;
mod solids;
mod step;
#[cfg(test)]
mod tests;

pub use darkness::Darkness;
pub use guide::{Guide, NavigationFacts};
pub use overview::Stand;
pub use pick::Picked;
