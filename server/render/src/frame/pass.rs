//! How a planned pass becomes commands.

use std::fmt::Debug;

use crate::engine::{RasterState, Recording, Size};
use crate::error::RenderError;
use crate::frame::parts::Parts;
use crate::frame::plan::PlannedPass;

/// Records a planned pass. Made with the plan, so that it holds what the plan decided: nothing is
/// decided a second time.
pub(crate) trait Pass: Debug + Send + Sync {
    /// Records what comes before every pass of a frame, whether or not the frame includes this one.
    fn begin(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        let _ = (planned, recording, parts);
        Ok(())
    }

    /// Names the pipelines that recording it takes; of a pass with one shader, that one.
    fn pipelines(&self, planned: &PlannedPass, list: &mut PipelineList) {
        list.compute(planned.program());
    }

    /// Records it.
    fn record(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError>;
}

/// The pipelines of a pass.
#[derive(Debug, Default)]
pub(crate) struct PipelineList {
    /// Permutations.
    pub compute: Vec<String>,
    /// Permutations with the state they draw with.
    pub raster: Vec<(String, RasterState)>,
}

impl PipelineList {
    pub fn compute(&mut self, program: &str) {
        self.compute.push(program.to_owned());
    }

    pub fn raster(&mut self, program: &str, state: &RasterState) {
        self.raster.push((program.to_owned(), state.clone()));
    }
}

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
        let constants = parts.constants_of(planned);
        let bindings = parts.bindings(planned)?;
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
