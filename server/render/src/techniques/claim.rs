//! What a technique's picture claims to show.

/// What a technique's picture claims to show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Claim {
    /// Which paths of light.
    pub paths: Paths,
    /// By what it differs from their truth, for people.
    pub bias: &'static str,
}

/// Paths of light from the camera to a light, by the number of scatterings between.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paths {
    /// All of them.
    Whole,
    /// Those of at most one scattering, on a surface or in a medium.
    AtMostOneScattering,
}
