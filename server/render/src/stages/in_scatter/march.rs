//! How rays are marched: strata or nodes, shared among pixels or not.

use tyndall_scene::{SceneFacts, ShadowMode};

use crate::engine::Constants;
use crate::frame::PlanInput;

/// How rays are marched once everything is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "independent facts, not the states of a machine"
)]
pub(crate) struct March {
    /// Strata or nodes a ray.
    pub steps: u32,
    /// Side of the tile of pixels that share them.
    pub interleave: u32,
    /// Side of the block of pixels of which one is marched.
    pub spacing: u32,
    /// Whether samples lie at random places in their strata, and the marched pixel in its block.
    pub jitter: bool,
    /// Whether a ray takes no more than it can cross voxels of density grids.
    pub by_voxels: bool,
    /// Whether half of them are equiangular about the light.
    pub equiangular: bool,
    /// Whether they are a Gauss rule's nodes.
    pub quadrature: bool,
    /// Whether lights that cannot add enough to a ray to be seen are left out of it.
    pub culls: bool,
}

/// Fewer lights are not worth looking for one to leave out: a bound costs as much as one or two strata, and
/// with eight that all count the march took 0.9 to 1.4 times as long.
const LEAST_CULLED: usize = 16;
/// Nor are fewer strata of a pixel: with eight it took 0.7 to 1.1 times as long.
const LEAST_CULLED_STRATA: u32 = 16;

/// Side of the tile of pixels that share strata on a software driver, if nothing is said: in the hall at 128
/// strata that takes a fifth of the time and errs by 0.9 %. On an H100 the march of a pixel waits for
/// nothing, and gathering takes longer than it saves.
const SHARED_BY: u32 = 4;
/// Fewer strata are not shared if nothing is said: a pixel would have less than one.
const LEAST_SHARED: u32 = SHARED_BY * SHARED_BY;

/// Nodes of the Gauss rule.
const NODES: u32 = 32;

impl March {
    /// Decides it.
    pub fn of(input: &PlanInput<'_>) -> Self {
        let (facts, limits) = (input.facts, input.limits);
        let wanted = &input.settings.single_scattering;
        let spacing = if wanted.half_resolution { 2 } else { 1 };
        let unshadowed = input.visibility() == ShadowMode::Off;
        // A cone has edges, a narrow lobe a peak, a grid anything: no rule of few nodes sees them.
        let smooth = !facts.heterogeneous && facts.spot_lights == 0 && facts.max_abs_g <= 0.5;
        let interleave = match wanted.interleave {
            0 if limits.software && wanted.steps >= LEAST_SHARED => SHARED_BY,
            chosen => chosen.max(1),
        };
        let culls = input.lights() >= LEAST_CULLED
            && wanted.steps >= LEAST_CULLED_STRATA * interleave * interleave
            && facts.grids == 0
            && !limits.unskipped;
        let most = loop_budget(input, culls);
        if unshadowed && smooth && wanted.steps > NODES && most >= NODES {
            return Self {
                steps: NODES,
                interleave: 1,
                spacing,
                jitter: wanted.jitter,
                equiangular: false,
                quadrature: true,
                by_voxels: false,
                culls,
            };
        }
        let equiangular = wanted.equiangular && equiangular_about(facts);
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
            jitter: wanted.jitter,
            equiangular,
            quadrature: false,
            by_voxels: by_voxels(facts) && !limits.unskipped,
            culls,
        }
    }

    /// What the march's pipelines are built for.
    pub(super) fn constants(self) -> Constants {
        Constants::default()
            .number("INTERLEAVE", self.interleave)
            .number("SPACING", self.spacing)
            .flag("CORNER_MOVES", self.jitter)
            .flag("EQUIANGULAR", self.equiangular)
            .flag("QUADRATURE", self.quadrature)
            .flag("BY_VOXELS", self.by_voxels)
            .flag("CULLS", self.culls)
    }

    /// Loop iterations of a pixel that takes its share of the strata.
    pub(super) fn iterations(self, input: &PlanInput<'_>) -> u64 {
        let shared = u64::from(self.interleave * self.interleave);
        (self.full_iterations(input) / shared).max(1)
    }

    /// Loop iterations of a pixel that takes all of them.
    pub(super) fn full_iterations(self, input: &PlanInput<'_>) -> u64 {
        u64::from(self.steps) * input.iterations_a_point()
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

    pub(super) fn reason(self, input: &PlanInput<'_>) -> String {
        let (facts, lights) = (input.facts, input.lights());
        let wanted = input.settings.single_scattering.steps;
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
        let positioned = facts.positioned_lights();
        if input.settings.single_scattering.equiangular && !self.equiangular && positioned > 1 {
            why = format!(
                "{why}; none equiangular: beside density grids all lights share the strata, and {positioned} have a position"
            );
        }
        if facts.grids > 0 && steps < facts.voxels_across {
            let across = facts.voxels_across;
            why = format!("{why}; one a voxel would take up to {across}");
        } else if self.by_voxels {
            why = format!("{why}; no more than one a voxel that a ray can cross");
        }
        if self.culls {
            why = format!("{why}; lights that cannot add 1e-3 to a ray are left out of it");
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
                input.limits.loop_cap.unwrap_or_default()
            );
        }
        why
    }
}

/// Whether strata can follow a light: each light has its own but beside density grids, whose optical
/// depth is summed up along the strata of all.
fn equiangular_about(facts: &SceneFacts) -> bool {
    let positioned = facts.positioned_lights();
    positioned == 1 || (positioned > 1 && facts.grids == 0)
}

/// Whether the density alone says how fine strata must be: not where another medium, or a light among
/// them, varies faster. Measured on smoke of 64³ voxels, where half a stratum a voxel still does.
fn by_voxels(facts: &SceneFacts) -> bool {
    facts.grids > 0 && facts.grids == facts.media && facts.positioned_lights() == 0
}

/// Most steps of a march that keep an invocation below the driver's loop cap.
fn loop_budget(input: &PlanInput<'_>, culls: bool) -> u32 {
    let Some(cap) = input.limits.loop_cap else {
        return u32::MAX;
    };
    let lights = input.lights().max(1) as u32;
    let media = input.facts.media.max(1) as u32;
    // A shadow ray visits tens of nodes; the bound leaves room for hundreds.
    let per_ray = if input.settings.shadows.mode == ShadowMode::Traced {
        400
    } else {
        0
    };
    // Emission visits the media twice a step; each light for its source and for both legs.
    let per_step = 1 + 2 * media + lights * (1 + 3 * media + per_ray);
    // A light's bound visits the media once, their own once a ray.
    let bounds = if culls { media + lights * media } else { 0 };
    (cap.saturating_sub(2000 + bounds) / per_step).max(1)
}
