//! A pass of a frame: what it is once it is planned, and how it becomes commands.

use std::fmt::Debug;
use std::sync::Arc;

use serde::{Serialize, Serializer};

use super::kept::KeptKind;
use super::parts::Parts;
use crate::engine::{
    Access, Bindings, Constants, Permutation, RasterState, Recording, ResourceSpec,
};
use crate::error::RenderError;
use crate::picture::When;

/// Name of a pass in plans, metrics and labels. Whoever records the pass says it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
pub struct PassId(pub &'static str);

impl PassId {
    /// The name.
    pub fn name(self) -> &'static str {
        self.0
    }
}

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

/// A pass that runs: everything that recording it takes, and why it runs.
#[derive(Debug, Clone)]
pub struct PlannedPass {
    /// Which.
    pub pass: PassId,
    /// Why it runs.
    pub reason: String,
    pub(crate) when: When,
    pub(crate) programs: Programs,
    /// That it adds to the scene's.
    pub(crate) constants: Constants,
    /// Textures and buffers that it reads and writes.
    pub(crate) accesses: Vec<Access>,
    /// What the plan says that small buffers hold, such as a technique's settings.
    pub(crate) values: Vec<(ResourceSpec, Vec<u8>)>,
    /// Whether lights that may add most must come first in their buffer.
    pub(crate) sorts_lights: bool,
    /// What it asks rays about.
    pub(crate) traces: Traces,
    /// Loop iterations of an invocation at most, where they may be many.
    pub(crate) iterations: u64,
    /// Whether only some pixels take so many.
    pub(crate) lists: bool,
    /// What it keeps from frame to frame.
    pub(crate) keeps: Vec<KeptKind>,
    pub(crate) recorder: Arc<dyn Pass>,
}

/// The shaders of a pass.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Programs {
    /// It has no shader, or its plan says nothing of them.
    None,
    /// This one; passes that dispatch others beside it build their names from it.
    One(Permutation),
    /// Several, with these features in common.
    Several(Permutation),
}

/// What the rays of a pass are asked about; later ones need more.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Traces {
    /// It traces none.
    Nothing,
    /// Whether and where they meet a triangle.
    Rays,
    /// Also what the triangle looks like there, and which triangles emit.
    Triangles,
}

/// A pass that is about to be planned.
#[derive(Debug)]
pub(crate) struct NewPass {
    pub pass: PassId,
    pub when: When,
    pub programs: Programs,
    pub constants: Constants,
    pub accesses: Vec<Access>,
    pub values: Vec<(ResourceSpec, Vec<u8>)>,
    pub sorts_lights: bool,
    pub traces: Traces,
    pub iterations: u64,
    pub lists: bool,
    pub keeps: Vec<KeptKind>,
    pub recorder: Arc<dyn Pass>,
}

impl NewPass {
    /// A pass of frames with a sample of the technique; it accesses and keeps nothing yet.
    pub fn new(pass: PassId, programs: Programs, recorder: impl Pass + 'static) -> Self {
        Self {
            pass,
            when: When::TechniqueSampled,
            programs,
            constants: Constants::default(),
            accesses: Vec::new(),
            values: Vec::new(),
            sorts_lights: false,
            traces: Traces::Nothing,
            iterations: 0,
            lists: false,
            keeps: Vec::new(),
            recorder: Arc::new(recorder),
        }
    }

    /// In other frames.
    pub fn when(mut self, when: When) -> Self {
        self.when = when;
        self
    }

    /// With constants of its own.
    pub fn constants(mut self, constants: Constants) -> Self {
        self.constants = constants;
        self
    }

    /// Reads and writes these, too.
    pub fn accesses(mut self, accesses: impl IntoIterator<Item = Access>) -> Self {
        self.accesses.extend(accesses);
        self
    }

    /// Reads `resource`, which holds `value` as long as the plan stays.
    pub fn values<T: bytemuck::NoUninit>(mut self, resource: ResourceSpec, value: &T) -> Self {
        self.accesses.push(resource.read());
        let bytes = bytemuck::bytes_of(value).to_vec();
        self.values.push((resource, bytes));
        self
    }

    /// Traces rays.
    pub fn traces(mut self, traces: Traces) -> Self {
        self.traces = traces;
        self
    }

    /// Loops up to so many times an invocation: a plain [`Dispatch`](super::Dispatch) is then cut into
    /// parts.
    pub fn iterations(mut self, most: u64) -> Self {
        self.iterations = most;
        self
    }

    /// Loops so often for some pixels only.
    pub fn listed_iterations(mut self, most: u64) -> Self {
        self.lists = true;
        self.iterations(most)
    }

    /// Wants the lights that may add most first in their buffer, if `sorts`.
    pub fn sorts_lights(mut self, sorts: bool) -> Self {
        self.sorts_lights = sorts;
        self
    }

    /// Keeps something of this kind.
    pub fn keeps(mut self, kind: KeptKind) -> Self {
        self.keeps.push(kind);
        self
    }

    /// With the reason why it runs.
    pub(super) fn planned(self, reason: String) -> PlannedPass {
        PlannedPass {
            pass: self.pass,
            reason,
            when: self.when,
            programs: self.programs,
            constants: self.constants,
            accesses: self.accesses,
            values: self.values,
            sorts_lights: self.sorts_lights,
            traces: self.traces,
            iterations: self.iterations,
            lists: self.lists,
            keeps: self.keeps,
            recorder: self.recorder,
        }
    }
}

impl PlannedPass {
    /// The constants that its pipelines are built for.
    pub(crate) fn constants(&self, parts: &Parts<'_>) -> Constants {
        parts.constants.with(&self.constants)
    }

    /// Everything that its shaders may name.
    pub(crate) fn bindings<'a>(&self, parts: &Parts<'a>) -> Result<Bindings<'a>, RenderError> {
        parts.bind(&self.accesses)
    }

    /// Permutation of its shader; of several, the features they share; empty where it has none.
    pub fn variant(&self) -> &str {
        match &self.programs {
            Programs::None => "",
            Programs::One(permutation) => permutation.name(),
            Programs::Several(permutation) => permutation.features(),
        }
    }

    /// Loop iterations for each pixel, of a pass over the whole picture.
    pub(crate) fn whole_picture(&self) -> u64 {
        if self.lists { 0 } else { self.iterations }
    }

    fn values_said(&self) -> impl Iterator<Item = (&'static str, &[u8])> + Clone {
        self.values
            .iter()
            .map(|(resource, bytes)| (resource.name, bytes.as_slice()))
    }

    /// Name of its one shader.
    pub(crate) fn program(&self) -> &str {
        match &self.programs {
            Programs::None => "",
            Programs::One(permutation) | Programs::Several(permutation) => permutation.name(),
        }
    }
}

impl PartialEq for PlannedPass {
    /// What a plan says: recorders follow from the same decisions as the rest.
    fn eq(&self, other: &Self) -> bool {
        (self.pass, &self.reason, self.when, &self.programs)
            == (other.pass, &other.reason, other.when, &other.programs)
            && self.constants == other.constants
            && self.values_said().eq(other.values_said())
    }
}

impl Serialize for PlannedPass {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Said<'a> {
            pass: PassId,
            variant: &'a str,
            reason: &'a str,
        }
        Said {
            pass: self.pass,
            variant: self.variant(),
            reason: &self.reason,
        }
        .serialize(serializer)
    }
}
