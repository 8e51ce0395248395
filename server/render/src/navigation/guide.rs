//! The guide of a scene: its still surfaces, and the answers that follow from them.

use glam::DVec3;
use tyndall_scene::description::Navigation;
use tyndall_scene::{Aabb, Scene};

use super::darkness::{Darkness, darkness};
use super::enclosure::encloses;
use super::overview::{Stand, overview};
use super::pick::{Picked, pick};
use super::pivot::pivot;
use super::solids::Solids;
use super::step::{turn, walk};
use crate::error::RenderError;

/// What a page is told about steering through a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NavigationFacts {
    /// How to steer.
    pub mode: Navigation,
    /// Box around what is worth looking at: without ground planes, skies and air. Unit: m.
    pub bounds: Aabb,
    /// What an orbit of the scene's own camera turns about. Unit: m.
    pub pivot: DVec3,
    /// Where to stand to see most, for a camera that surfaces surround: "frame all" must not leave them.
    pub overview: Option<Stand>,
}

/// Answers where a camera may go and what it sees.
#[derive(Debug)]
pub struct Guide {
    solids: Solids,
    facts: NavigationFacts,
}

impl Guide {
    /// Builds the BVH; `declared` is what the scene says about steering. Takes a few µs a triangle, so it
    /// belongs on a thread that may be busy.
    ///
    /// # Errors
    /// [`RenderError`] where the surfaces make a BVH too deep to trace.
    pub fn build(scene: &Scene, declared: Option<Navigation>) -> Result<Self, RenderError> {
        let solids = Solids::build(scene)?;
        let enclosed = encloses(&solids, &scene.camera);
        let derived = if enclosed {
            Navigation::Look
        } else {
            Navigation::Orbit
        };
        Ok(Self {
            facts: NavigationFacts {
                mode: declared.unwrap_or(derived),
                bounds: solids.bounds,
                pivot: pivot(&solids, scene),
                overview: enclosed.then(|| overview(&solids, &scene.camera)),
            },
            solids,
        })
    }

    /// What a page is told.
    pub fn facts(&self) -> &NavigationFacts {
        &self.facts
    }

    /// How near a step leads to a surface. Unit: m.
    pub fn margin(&self) -> f64 {
        self.solids.margin()
    }

    /// Where an eye ends that wants to go from one place straight to another. It goes through no surface
    /// that faces it, keeps a margin, and slides along what it meets; nearer than the margin it may
    /// still leave. Takes a few µs. Unit: m.
    pub fn walk(&self, from: DVec3, to: DVec3) -> DVec3 {
        walk(&self.solids, from, to)
    }

    /// [`Self::walk`] of an eye that turns about a pivot: on what it slides along it keeps its distance, so
    /// that an orbit that comes down to the ground goes on around. Unit: m.
    pub fn turn(&self, from: DVec3, to: DVec3, pivot: DVec3) -> DVec3 {
        turn(&self.solids, from, to, pivot)
    }

    /// What the scene's camera sees at a place of a picture with this ratio of width to height; the place
    /// in shares of width and height from the left upper corner. Takes longer where much moves.
    pub fn pick(&self, scene: &Scene, aspect: f64, place: [f64; 2]) -> Option<Picked> {
        pick(&self.solids, scene, aspect, place)
    }

    /// The first reason that applies why what the scene's camera sees is black, in a picture with this
    /// ratio of width to height.
    pub fn darkness(&self, scene: &Scene, aspect: f64) -> Darkness {
        darkness(&self.solids, scene, aspect)
    }
}
