//! What is worth looking at: the box that "frame all" frames.
//!
//! Parts of surfaces, grids and spheres of media count; boxes of air count where there is nothing else, and
//! lights where there is not even that. The largest thing is left out as a backdrop, again and again, while it
//! dwarfs the rest and is flat (a ground plane), glows around the rest (a sky), or is larger by far.

use glam::DVec3;
use tyndall_scene::{Aabb, Light, MediumShape, Scene};

use super::parts::{Part, Parts, union};

/// So many times larger than the rest is a flat or glowing backdrop.
const DWARFS: f64 = 5.0;
/// So many times larger than the rest is a backdrop whatever it is.
const DWARFS_BY_FAR: f64 = 50.0;
/// Thickness of a flat thing, as a share of its diagonal.
const FLAT: f64 = 0.02;

/// How far around a light in nothing but fog is worth looking at. Unit: m.
const LIT: f64 = 1.0;

/// What is framed and what is left out.
pub(super) struct Framing {
    /// Unit: m.
    pub(super) bounds: Aabb,
    backdrops: Vec<Aabb>,
}

impl Framing {
    /// Of a scene with these still parts.
    pub(super) fn of(scene: &Scene, still: &Parts) -> Self {
        let mut things = still.all.clone();
        things.extend(moving(scene));
        things.extend(scene.media.iter().filter_map(|medium| solid(&medium.shape)));
        if things.is_empty() {
            things.extend(scene.media.iter().filter_map(|medium| air(&medium.shape)));
        }
        if things.is_empty() {
            things.extend(scene.lights.iter().filter_map(lamp));
        }
        let camera = &scene.camera;
        let alone = Aabb {
            min: camera.position.min(camera.target) - 1.0,
            max: camera.position.max(camera.target) + 1.0,
        };
        without_backdrops(things).unwrap_or(Self {
            bounds: alone,
            backdrops: Vec::new(),
        })
    }

    /// Whether a surface with this box was left out.
    pub(super) fn is_backdrop(&self, bounds: &Aabb) -> bool {
        self.backdrops.contains(bounds)
    }
}

/// Instances that keyframes move, where they are at present.
fn moving(scene: &Scene) -> impl Iterator<Item = Part> {
    let geometry = &scene.geometry;
    let tracks = geometry.tracks.iter();
    let indices = tracks.flat_map(|track| track.instances.iter().map(|(index, _)| *index));
    indices.filter_map(|index| {
        let bounds = geometry.instance_bounds(&geometry.instances[index])?;
        Some(Part {
            bounds,
            glows: false,
        })
    })
}

/// The box of a medium that has a shape of its own.
fn solid(shape: &MediumShape) -> Option<Part> {
    let bounds = match shape {
        MediumShape::Sphere { .. } | MediumShape::Grid { .. } => super::media::bounds(shape)?,
        MediumShape::Homogeneous { .. } | MediumShape::HeightFog { .. } => return None,
    };
    Some(Part {
        bounds,
        glows: false,
    })
}

/// The box that fog is confined to.
fn air(shape: &MediumShape) -> Option<Part> {
    let bounds = super::media::bounds(shape)?;
    Some(Part {
        bounds,
        glows: false,
    })
}

/// The surroundings of a light with a position: what fog that fills space shows.
fn lamp(light: &Light) -> Option<Part> {
    let position = light.position()?;
    let bounds = Aabb {
        min: position - LIT,
        max: position + LIT,
    };
    Some(Part {
        bounds,
        glows: false,
    })
}

fn without_backdrops(mut things: Vec<Part>) -> Option<Framing> {
    things.sort_by(|a, b| diagonal(&b.bounds).total_cmp(&diagonal(&a.bounds)));
    // The box around each thing and all smaller ones.
    let mut around: Vec<Aabb> = Vec::with_capacity(things.len());
    for thing in things.iter().rev() {
        let smaller = around.last().unwrap_or(&thing.bounds);
        around.push(union(smaller, &thing.bounds));
    }
    around.reverse();
    let left_out = things
        .iter()
        .zip(around.iter().skip(1))
        .take_while(|(thing, rest)| is_backdrop(thing, rest))
        .count();
    let bounds = *around.get(left_out)?;
    Some(Framing {
        bounds: padded(bounds),
        backdrops: things[..left_out].iter().map(|t| t.bounds).collect(),
    })
}

fn is_backdrop(thing: &Part, rest: &Aabb) -> bool {
    let own = diagonal(&thing.bounds);
    let ratio = own / diagonal(rest).max(1e-9);
    let thickness = (thing.bounds.max - thing.bounds.min).min_element();
    let around = union(&thing.bounds, rest) == thing.bounds;
    let special = thickness < FLAT * own || (thing.glows && around);
    ratio > DWARFS_BY_FAR || (special && ratio > DWARFS)
}

fn diagonal(bounds: &Aabb) -> f64 {
    (bounds.max - bounds.min).length()
}

/// A box of some size, even around a point.
fn padded(bounds: Aabb) -> Aabb {
    let least = DVec3::splat(1e-3 + 1e-3 * diagonal(&bounds));
    let missing = (least - (bounds.max - bounds.min)).max(DVec3::ZERO);
    Aabb {
        min: bounds.min - 0.5 * missing,
        max: bounds.max + 0.5 * missing,
    }
}
