//! Runs over the levels of the picture: to the coarsest that is needed, and back.

use tyndall_scene::{ScreenSpaceFilter, ScreenSpaceSettings};

use super::levels::{Level, Levels};
use crate::engine::{Bindings, Bytes, Link, Recording, ResourceSpec, Size};
use crate::error::RenderError;
use crate::frame::{Parts, Pass, PassId, PipelineList, PlannedPass};

/// Attenuates and spreads.
pub(super) const PASS: PassId = PassId("screen_space");

/// Largest variance of all pixels (px², f32), and how many are filtered apart.
pub(super) const EXTENT: ResourceSpec = ResourceSpec::buffer("spread_extent", Bytes::Fixed(16));

/// How the picture is filtered, as the plan decided it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Filter {
    pub kind: ScreenSpaceFilter,
    /// Whether bright pixels are filtered apart.
    pub separated: bool,
    /// Whether spreads are blurred before they choose levels.
    pub blurred: bool,
}

impl Filter {
    /// By the settings.
    pub fn of(settings: &ScreenSpaceSettings) -> Self {
        let hierarchical = settings.filter == ScreenSpaceFilter::Hierarchical;
        Self {
            kind: settings.filter,
            separated: hierarchical && settings.separation,
            blurred: hierarchical && settings.density_blur,
        }
    }

    /// Shader of the pixels' own part.
    pub fn pixels(self) -> &'static str {
        match self.kind {
            ScreenSpaceFilter::Splat => "screen_space+pixels+splat",
            ScreenSpaceFilter::Hierarchical => "screen_space+pixels+chain",
            ScreenSpaceFilter::Gather => "screen_space+pixels+gather",
        }
    }

    /// Shader from a level to the next coarser one.
    fn down(self) -> &'static str {
        match (self.kind, self.separated, self.blurred) {
            (ScreenSpaceFilter::Splat, ..) => "screen_space+splat_down",
            (_, false, false) => "screen_space+chain_down",
            (_, true, false) => "screen_space+chain_down+separated",
            (_, false, true) => "screen_space+chain_down+blurred",
            (_, true, true) => "screen_space+chain_down+separated+blurred",
        }
    }

    /// Shader of the picture at the end.
    fn last(self) -> &'static str {
        match (self.kind, self.separated, self.blurred) {
            (ScreenSpaceFilter::Splat, ..) => "screen_space+splat_up+finest",
            (ScreenSpaceFilter::Gather, ..) => "screen_space+gather",
            (_, false, false) => "screen_space+fetch",
            (_, true, false) => "screen_space+fetch+separated",
            (_, false, true) => "screen_space+fetch+blurred",
            (_, true, true) => "screen_space+fetch+separated+blurred",
        }
    }

    /// The dispatches over levels, in order.
    fn steps(self, levels: &[Level]) -> Vec<(&'static str, &Level, [u32; 2])> {
        let finest = &levels[0];
        let mut steps: Vec<_> = levels
            .iter()
            .map(|level| (self.down(), level, level.coarse()))
            .collect();
        if self.kind == ScreenSpaceFilter::Splat {
            let up = levels[1..].iter().rev();
            steps.extend(up.map(|level| ("screen_space+splat_up", level, level.own())));
        }
        steps.push((self.last(), finest, finest.own()));
        steps
    }
}

impl Pass for Filter {
    fn pipelines(&self, planned: &PlannedPass, list: &mut PipelineList) {
        list.compute(planned.program());
        list.compute(self.last());
        if self.kind != ScreenSpaceFilter::Gather {
            list.compute(self.down());
        }
        if self.kind == ScreenSpaceFilter::Splat {
            list.compute("screen_space+splat_up");
        }
    }

    fn record(
        &self,
        planned: &PlannedPass,
        recording: &mut Recording<'_>,
        parts: &Parts<'_>,
    ) -> Result<(), RenderError> {
        let Some(kept) = parts.kept.get::<Levels>() else {
            return Ok(());
        };
        let constants = planned.constants(parts);
        let shared = planned.bindings(parts)?;
        let finest = at_level(&shared, &kept.steps[0]);
        recording
            .encoder
            .clear_buffer(parts.buffer(&EXTENT)?, 0, None);
        let name = PASS.name();
        let [width, height] = parts.size();
        let long = ([width, height, 1], planned.iterations);
        recording.compute_in_parts(name, planned.program(), &constants, &finest, long)?;
        if self.kind == ScreenSpaceFilter::Gather {
            for rows in kept.rows.iter() {
                let mut bindings = shared.clone();
                bindings.buffer("rows", rows);
                let long = ([width, height, 1], kept.row_iterations);
                recording.compute_in_parts(name, self.last(), &constants, &bindings, long)?;
            }
            return Ok(());
        }
        let links: Vec<_> = self
            .steps(&kept.steps)
            .into_iter()
            .map(|(program, level, size)| Link {
                program,
                bindings: at_level(&shared, level),
                size: Size::from(size),
            })
            .collect();
        recording.compute_chain(name, &constants, &links)
    }
}

fn at_level<'a>(shared: &Bindings<'a>, level: &'a Level) -> Bindings<'a> {
    let mut bindings = shared.clone();
    bindings.buffer("level", &level.buffer);
    bindings
}
