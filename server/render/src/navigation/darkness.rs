//! Why a picture is black, as far as the scene tells.

use glam::DVec3;
use tyndall_scene::{Aabb, Light, Scene};

use super::line::Line;
use super::media;
use super::solids::Solids;

/// Rays through the picture, by column and row.
const GRID: [usize; 2] = [11, 7];
/// Rays into all directions.
const AROUND: usize = 64;
/// Share of the picture that a surface right in front of the eye covers.
const COVERS: f64 = 0.8;
/// Share of the picture below which the scene is as good as out of it: a sliver at its border.
const SLIVER: f64 = 0.05;
/// What is right in front of the eye, in margins that a step keeps.
const NEAR_MARGINS: f64 = 1.5;
/// Beyond this a ray meets nothing. Unit: m.
const FARTHEST: f64 = 1e7;

/// Why a picture is black.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Darkness {
    /// Nothing in the scene gives light.
    NoLight,
    /// The eye is inside a solid thing: it sees the backs of surfaces all around.
    InsideSolid,
    /// A surface right in front of the eye hides everything.
    AtSurface,
    /// Nothing of the scene, or a sliver, is in the picture.
    LooksAway,
    /// What is in the picture gets no light, or too little for the exposure.
    Unlit,
}

/// The first reason that applies to what the scene's camera sees, in a picture with this ratio of width
/// to height.
pub(super) fn darkness(solids: &Solids, scene: &Scene, aspect: f64) -> Darkness {
    if !gives_light(scene) {
        return Darkness::NoLight;
    }
    if is_inside_solid(solids, scene.camera.position) {
        return Darkness::InsideSolid;
    }
    let [columns, rows] = GRID;
    let lines: Vec<Line> = (0..columns * rows)
        .map(|index| {
            let place = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
            let at = [
                place(index % columns, columns),
                place(index / columns, rows),
            ];
            Line::through(&scene.camera, aspect, at)
        })
        .collect();
    let hits: Vec<Option<f64>> = lines
        .iter()
        .map(|line| solids.closest(line.origin, line.direction, FARTHEST))
        .map(|hit| hit.map(|hit| f64::from(hit.distance)))
        .collect();
    let near = NEAR_MARGINS * solids.margin();
    let close = hits.iter().flatten().filter(|distance| **distance < near);
    if close.count() as f64 >= COVERS * lines.len() as f64 {
        return Darkness::AtSurface;
    }
    let met = hits.iter().flatten().count() as f64;
    let in_sight = met > SLIVER * lines.len() as f64 || sees_a_medium(scene, &lines);
    if !in_sight && !shows_sky(scene) {
        return Darkness::LooksAway;
    }
    Darkness::Unlit
}

/// Whether nearly every way out leads to the back of a surface.
fn is_inside_solid(solids: &Solids, eye: DVec3) -> bool {
    let backs = spread(AROUND).filter(|direction| solids.shows_back(eye, *direction, FARTHEST));
    backs.count() as f64 >= 0.9 * AROUND as f64
}

/// Whether a medium is in more than a sliver of the picture.
fn sees_a_medium(scene: &Scene, lines: &[Line]) -> bool {
    let boxes: Vec<Option<Aabb>> = scene
        .media
        .iter()
        .map(|m| media::bounds(&m.shape))
        .collect();
    let sees = |line: &&Line| {
        boxes.iter().any(|bounds| {
            let in_box = |bounds| media::stretch(line, bounds, FARTHEST).is_some();
            bounds.as_ref().is_none_or(in_box)
        })
    };
    lines.iter().filter(sees).count() as f64 > SLIVER * lines.len() as f64
}

fn shows_sky(scene: &Scene) -> bool {
    let sky = scene.environment.as_ref();
    sky.is_some_and(|sky| sky.radiance != [0.0; 3])
}

/// Whether a light, a sky, a surface or a medium gives light.
fn gives_light(scene: &Scene) -> bool {
    let geometry = &scene.geometry;
    let glows =
        |mesh: usize| geometry.materials[geometry.meshes[mesh].material].emission != [0.0; 3];
    scene.lights.iter().any(Light::is_lit)
        || shows_sky(scene)
        || scene.media.iter().any(|medium| medium.emission != [0.0; 3])
        || geometry
            .instances
            .iter()
            .any(|instance| glows(instance.mesh))
}

/// Directions spread evenly over the sphere (Fibonacci lattice).
fn spread(count: usize) -> impl Iterator<Item = DVec3> {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    (0..count).map(move |index| {
        let z = 1.0 - 2.0 * (index as f64 + 0.5) / count as f64;
        let turn = index as f64 * GOLDEN_ANGLE;
        let level = (1.0 - z * z).sqrt();
        DVec3::new(level * turn.cos(), level * turn.sin(), z)
    })
}
