//! What one frame does, and why.

use std::fmt;

use serde::Serialize;
use tyndall_scene::ShadowMode;

use super::pass::{NewPass, PassId, PlannedPass};

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

impl FramePlan {
    /// Plans a pass after those that are planned.
    pub(crate) fn run(&mut self, new: NewPass, reason: impl Into<String>) {
        self.passes.push(new.planned(reason.into()));
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
