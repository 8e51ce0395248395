//! The interactive picture B, brought toward the traced one X̄.
//!
//! The residual d = X̄ − B of a few unbiased samples is noisy, the bias behind it is smooth. d is split
//! into bands; each is weighted by how much of it is signal and added to B. Two halves of the samples,
//! even and odd, tell signal from noise without a model of either: the mean of their product over a
//! window is the signal's energy, that of their squared difference the noise's, and the weight is
//! signal/(signal + noise), after James and Stein (1961). It tends to 1 with the samples, so that the
//! picture tends to X̄, and to 0 in noise, so that it stays B. Both also give its expected square error.
//!
//! `algorithms.md` §10, with two changes that measured better or alike on the reference scenes: the
//! noise comes from the halves and not from the variance of samples, and the coarse levels are kept
//! only at the cells of a grid as coarse as they are smooth.
//! Bias: vanishes with the noise of X̄. Cost: about 60 loads of a vector a pixel.

mod history;
mod plan;
mod pyramid;

use tyndall_scene::{Camera, Scene};

use crate::engine::{Bindings, Constants, Device, Link, Recording, Size};
use crate::error::RenderError;
use crate::frame::{Kept, Parts, Pass, PipelineList, PlannedPass, Preparation};
use history::History;
pub(crate) use history::Seen;
pub(crate) use plan::{PASS, SQUARE_ERRORS, plan, without_correction};
use pyramid::Level;

/// By so much the error of a corrected picture may exceed the expected one: a target is met when the
/// expected error times this is below it. Found on the reference scenes, docs/calibration.svg: from four
/// samples on at most 1.47 (fog box, black picture).
pub(crate) const SAFETY: f32 = 1.5;

/// Bytes of the largest buffer that a picture of this size needs.
pub(crate) fn largest_buffer(size: [u32; 2]) -> u64 {
    plan::RESIDUAL_BYTES * pyramid::cells(size)
}

/// What the correction keeps of one view at one size.
#[derive(Debug)]
pub(crate) struct Correction {
    size: [u32; 2],
    /// One a level of residuals, the finest first.
    levels: std::sync::Arc<Vec<Level>>,
    history: History,
}

impl Correction {
    fn new(device: &Device, size: [u32; 2]) -> Self {
        Self {
            size,
            levels: std::sync::Arc::new(pyramid::levels(device, size)),
            history: History::new(device, size),
        }
    }

    /// Sets the picture whose residuals count beside the `samples` of the one at present, traced ones
    /// and the technique's, if any do.
    pub fn look_back(
        &self,
        device: &Device,
        last: Option<&Seen>,
        camera: &Camera,
        samples: (u32, u32),
    ) {
        self.history.look_back(device, last, camera, samples);
    }
}

impl Kept for Correction {
    fn next(&self, preparation: &Preparation<'_>) -> Result<Box<dyn Kept>, RenderError> {
        if self.size == preparation.size {
            return Ok(Box::new(Self {
                size: self.size,
                levels: std::sync::Arc::clone(&self.levels),
                history: self.history.clone(),
            }));
        }
        Ok(Box::new(Self::new(preparation.device, preparation.size)))
    }

    fn upload(&self, _device: &Device, _scene: &Scene) {}

    fn bind<'a>(&'a self, bindings: &mut Bindings<'a>) {
        self.history.bind(bindings);
    }

    fn settle(&mut self, _submitted: bool) {}
}

/// Runs over the levels, from the finest to the coarsest and back. What the plan decided of it:
#[derive(Debug, Clone, Copy)]
struct Correct {
    /// Whether there is a technique's picture to start from.
    base: bool,
    /// Whether residuals are carried over from picture to picture.
    carries: bool,
    /// Whether media are density grids.
    grids: bool,
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
        let mut links = Vec::with_capacity(steps.len());
        for (program, level, size) in &steps {
            let mut bindings = parts.bindings(planned)?;
            bindings.buffer("level", &level.buffer);
            links.push(Link {
                program,
                bindings,
                size: Size::from(*size),
            });
        }
        let constants: Constants = parts.constants_of(planned);
        recording.compute_chain(PASS.name(), &constants, &links)
    }
}
