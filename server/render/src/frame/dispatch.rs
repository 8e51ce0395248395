//! Passes without code of their own.

use super::parts::Parts;
use super::pass::{Pass, PipelineList, PlannedPass};
use crate::engine::{Recording, Size};
use crate::error::RenderError;

/// One dispatch of the planned permutation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dispatch(pub Reach);

/// How many invocations a dispatch has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Reach {
    /// One a pixel.
    Picture,
    /// One a block of pixels of this side, rounded up to a multiple along both axes.
    Blocks { side: u32, multiple: u32 },
}

impl Reach {
    /// For a picture of this size.
    pub fn of(self, size: [u32; 2]) -> [u32; 2] {
        match self {
            Self::Picture => size,
            Self::Blocks { side, multiple } => {
                size.map(|length| length.div_ceil(side).next_multiple_of(multiple))
            }
        }
    }
}

impl Pass for Dispatch {
    fn record(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        let name = planned.pass.name();
        let constants = planned.constants(parts);
        let bindings = planned.bindings(parts)?;
        let [width, height] = self.0.of(parts.size());
        if planned.iterations > 0 {
            let long = ([width, height, 1], planned.iterations);
            recording.compute_in_parts(name, planned.program(), &constants, &bindings, long)
        } else {
            let size = Size::from([width, height]);
            recording.compute(name, planned.program(), &constants, &bindings, size)
        }
    }
}

/// Needs no commands: what it stands for was made when the view took the scene.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MadeBefore;

impl Pass for MadeBefore {
    fn pipelines(&self, _planned: &PlannedPass, _list: &mut PipelineList) {}

    fn record(
        &self,
        _planned: &PlannedPass,
        _recording: &mut Recording<'_>,
        _parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        Ok(())
    }
}
