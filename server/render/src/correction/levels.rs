//! Runs over the levels of residuals, from the finest to the coarsest and back.

use super::history;
use super::pyramid::Level;
use super::state::Correction;
use crate::engine::{Link, Recording, Size};
use crate::error::RenderError;
use crate::frame::{Parts, Pass, PipelineList, PlannedPass};

/// What the plan decided of the correction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Correct {
    /// Whether there is a technique's picture to start from.
    pub base: bool,
    /// Whether residuals are carried over from picture to picture.
    pub carries: bool,
    /// Whether media are density grids.
    pub grids: bool,
}

/// A dispatch of the correction, before what it reads is bound.
type Step<'a> = (String, &'a Level, [u32; 2]);

impl Correct {
    fn steps<'a>(self, correction: &'a Correction, looks: bool) -> Vec<Step<'a>> {
        let base = if self.base { "+base" } else { "" };
        let levels = &correction.levels;
        let finest = &levels[0];
        let [before, after] = if self.carries {
            correction.history.passes(looks, self.grids)
        } else {
            Default::default()
        };
        let at_finest = |(name, size): (&str, [u32; 2])| (name.to_owned(), finest, size);
        let step = |name: &str, level: &'a Level, size: [u32; 2]| (name.to_owned(), level, size);
        let mut steps: Vec<Step<'a>> = before.into_iter().map(at_finest).collect();
        steps.push(step(
            &format!("correction+residual{base}"),
            finest,
            finest.own(),
        ));
        steps.extend(after.into_iter().map(at_finest));
        for level in &levels[..levels.len() - 1] {
            steps.push(step("correction+reduce", level, level.coarse()));
        }
        for level in levels.iter() {
            steps.push(step("correction+band_energy", level, level.coarse()));
        }
        for level in levels.iter() {
            steps.push(step("correction+window_energy", level, level.window()));
        }
        for level in levels.iter() {
            steps.push(step("correction+believed_energy", level, level.window()));
        }
        for level in levels[1..].iter().rev() {
            steps.push(step("correction+combine", level, level.own()));
        }
        steps.push(step(
            &format!("correction+combine+finest{base}"),
            finest,
            finest.own(),
        ));
        steps
    }
}

impl Pass for Correct {
    fn pipelines(&self, _planned: &PlannedPass, list: &mut PipelineList) {
        let base = if self.base { "+base" } else { "" };
        for name in [
            "reduce",
            "band_energy",
            "window_energy",
            "believed_energy",
            "combine",
        ] {
            list.compute(&format!("correction+{name}"));
        }
        list.compute(&format!("correction+residual{base}"));
        list.compute(&format!("correction+combine+finest{base}"));
        if self.carries {
            for name in history::programs(self.grids) {
                list.compute(name);
            }
        }
    }

    fn record(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        let Some(correction) = parts.kept.get::<Correction>() else {
            return Ok(());
        };
        let steps = self.steps(correction, parts.share.restarts);
        let shared = planned.bindings(parts)?;
        let mut links = Vec::with_capacity(steps.len());
        for (program, level, size) in &steps {
            let mut bindings = shared.clone();
            bindings.buffer("level", &level.buffer);
            links.push(Link {
                program,
                bindings,
                size: Size::from(*size),
            });
        }
        let constants = planned.constants(parts);
        recording.compute_chain(planned.pass.name(), &constants, &links)
    }
}
