//! What of its plan a frame does.

use super::slices::Slice;

/// What of the plan a frame does.
#[derive(Debug, Clone, Copy)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "independent parts of a frame"
)]
pub(crate) struct Share {
    /// Whether anything is added to the picture; otherwise it is only shown again.
    pub adds: bool,
    /// A sample of the technique.
    pub base: bool,
    /// Index of its place in its pixel, and in its strata.
    pub place: u32,
    /// A slice of the reference.
    pub slice: Option<Slice>,
    /// Samples of a pixel once it is done, of the first one also its part.
    pub done: f32,
    /// The correction, and the estimate of the error.
    pub estimated: bool,
    /// Whether what was traced before is forgotten.
    pub restarts: bool,
}

/// Which frames a pass is part of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum When {
    /// Those with a sample of the technique.
    TechniqueSampled,
    /// Those with traced samples.
    Traced,
    /// Those in which the picture is corrected and its error estimated.
    Estimated,
    /// Every one.
    Always,
}

impl Share {
    /// Whether a pass that is part of such frames is part of this one.
    pub fn includes(self, when: When) -> bool {
        match when {
            When::TechniqueSampled => self.adds && self.base,
            When::Traced => self.adds && self.slice.is_some(),
            When::Estimated => self.estimated,
            When::Always => true,
        }
    }
}
