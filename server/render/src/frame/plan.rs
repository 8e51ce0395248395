//! What one frame does, and why.

use std::fmt;
use std::sync::Arc;

use serde::{Serialize, Serializer};
use tyndall_scene::ShadowMode;

use super::kept::KeptKind;
use super::pass::Pass;
use crate::engine::{Access, Constants, Permutation, ResourceSpec};
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

/// A pass, or part of one, that does not run.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SkippedPass {
    /// Which.
    pub pass: PassId,
    /// What of it is left out; empty for all of it.
    pub variant: String,
    /// Why it is skipped.
    pub reason: String,
}

/// Passes in the order they run, and what is skipped.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct FramePlan {
    /// Runs, in this order.
    pub passes: Vec<PlannedPass>,
    /// Does not run.
    pub skipped: Vec<SkippedPass>,
    /// How visibility toward lights is found, where a pass asks for it.
    #[serde(skip)]
    pub(crate) visibility: Option<ShadowMode>,
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
}

impl FramePlan {
    /// Plans a pass after those that are planned.
    pub(crate) fn run(&mut self, new: NewPass, reason: impl Into<String>) {
        self.passes.push(PlannedPass {
            pass: new.pass,
            reason: reason.into(),
            when: new.when,
            programs: new.programs,
            constants: new.constants,
            accesses: new.accesses,
            values: new.values,
            sorts_lights: new.sorts_lights,
            traces: new.traces,
            iterations: new.iterations,
            lists: new.lists,
            keeps: new.keeps,
            recorder: new.recorder,
        });
    }

    /// Says why a pass, or `part` of it, does not run.
    pub(crate) fn skip(&mut self, pass: PassId, part: &str, reason: impl Into<String>) {
        self.skipped.push(SkippedPass {
            pass,
            variant: part.to_owned(),
            reason: reason.into(),
        });
    }

    /// The pass called so, if it runs.
    pub fn pass(&self, pass: PassId) -> Option<&PlannedPass> {
        self.passes.iter().find(|planned| planned.pass == pass)
    }

    /// Whether `pass` runs.
    pub fn runs(&self, pass: PassId) -> bool {
        self.pass(pass).is_some()
    }
}

impl PlannedPass {
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

impl fmt::Display for FramePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "runs")?;
        for p in &self.passes {
            writeln!(f, "  {:<18} {:<36} {}", p.pass.0, p.variant(), p.reason)?;
        }
        writeln!(f, "skipped")?;
        for p in &self.skipped {
            writeln!(f, "  {:<18} {:<36} {}", p.pass.0, p.variant, p.reason)?;
        }
        Ok(())
    }
}
