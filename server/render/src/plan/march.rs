//! How rays are marched: strata or nodes, shared among pixels or not.

use tyndall_scene::{RenderSettings, SceneFacts, ShadowMode};

use super::{PlanLimits, visibility};

/// How rays are marched once everything is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct March {
    /// Strata or nodes a ray.
    pub steps: u32,
    /// Side of the tile of pixels that share them.
    pub interleave: u32,
    /// Side of the block of pixels of which one is marched.
    pub spacing: u32,
    /// Whether half of them are equiangular about the light.
    pub equiangular: bool,
    /// Whether they are a Gauss rule's nodes.
    pub quadrature: bool,
}

/// Nodes of the Gauss rule.
const NODES: u32 = 32;

impl March {
    /// Decides it for a scene with these facts.
    pub fn of(facts: &SceneFacts, settings: &RenderSettings, limits: PlanLimits) -> Self {
        let wanted = &settings.single_scattering;
        let spacing = if wanted.half_resolution { 2 } else { 1 };
        let unshadowed = visibility(facts, settings) == ShadowMode::Off;
        // A cone has edges, a narrow lobe a peak, a grid anything: no rule of few nodes sees them.
        let smooth = !facts.heterogeneous && facts.spot_lights == 0 && facts.max_abs_g <= 0.5;
        let most = loop_budget(facts, settings, limits);
        if unshadowed && smooth && wanted.steps > NODES && most >= NODES {
            return Self {
                steps: NODES,
                interleave: 1,
                spacing,
                equiangular: false,
                quadrature: true,
            };
        }
        let interleave = wanted.interleave.max(1);
        // Strata of a summed optical depth follow one another: they cannot be of two kinds.
        let equiangular =
            wanted.equiangular && facts.grids == 0 && facts.point_lights + facts.spot_lights > 0;
        // Every rank has as many, of both kinds.
        let share = interleave * interleave * if equiangular { 2 } else { 1 };
        let steps = wanted.steps.next_multiple_of(share);
        Self {
            steps: if steps <= most {
                steps
            } else {
                (most / share * share).max(share)
            },
            interleave,
            spacing,
            equiangular,
            quadrature: false,
        }
    }

    /// Whether pixels take from their neighbours what they did not march themselves.
    pub fn is_shared(self) -> bool {
        self.interleave > 1 || self.spacing > 1
    }

    /// How they do.
    pub(super) fn sharing(self) -> String {
        let mut how = Vec::new();
        if self.interleave > 1 {
            let side = self.interleave;
            how.push(format!("strata of {side}×{side} pixels"));
        }
        if self.spacing > 1 {
            let side = self.spacing;
            how.push(format!("one of {side}×{side} pixels is marched"));
        }
        format!(
            "{}; what is at no neighbour's distance is marched in full",
            how.join(", ")
        )
    }

    pub(super) fn reason(
        self,
        facts: &SceneFacts,
        settings: &RenderSettings,
        lights: usize,
        limits: PlanLimits,
    ) -> String {
        let wanted = settings.single_scattering.steps;
        let Self {
            steps, interleave, ..
        } = self;
        let kind = match (self.quadrature, self.equiangular) {
            (true, _) => "Gauss nodes",
            (false, true) => "strata, half of them equiangular,",
            (false, false) => "strata",
        };
        let media = facts.media;
        let mut why = format!("{steps} {kind} a ray, {lights} lights, {media} media");
        if settings.single_scattering.equiangular && facts.grids > 0 {
            why = format!(
                "{why}; none equiangular beside density grids, whose depth is summed up in order"
            );
        }
        if self.quadrature {
            why = format!(
                "{why}; nothing along a ray is in shadow or varies: {wanted} strata are not needed"
            );
        } else if steps > wanted {
            why = format!(
                "{why}; a multiple of {} of the {wanted} asked for",
                interleave * interleave
            );
        } else if steps < wanted {
            why = format!(
                "{why}; {wanted} were asked for, but this driver stops a shader after {} loop iterations",
                limits.loop_cap.unwrap_or_default()
            );
        }
        why
    }
}

/// Most steps of a march that keep an invocation below the driver's loop cap.
fn loop_budget(facts: &SceneFacts, settings: &RenderSettings, limits: PlanLimits) -> u32 {
    let Some(cap) = limits.loop_cap else {
        return u32::MAX;
    };
    let lights = (facts.point_lights + facts.spot_lights + facts.directional_lights).max(1) as u32;
    let media = facts.media.max(1) as u32;
    // A shadow ray visits tens of nodes; the bound leaves room for hundreds.
    let per_ray = if settings.shadows.mode == ShadowMode::Traced {
        400
    } else {
        0
    };
    // Emission visits the media twice a step; each light for its source and for both legs.
    let per_step = 1 + 2 * media + lights * (1 + 3 * media + per_ray);
    ((cap - 2000) / per_step).max(1)
}
