//! Where to stand to see most of a scene whose surfaces surround its camera.

use glam::DVec3;
use tyndall_scene::Camera;

use super::enclosure::upright;
use super::line::Line;
use super::media::stretch;
use super::solids::Solids;
use super::step::walk;

/// How far the overview may step back, as a share of the scene's diagonal.
const STEP_BACK: f64 = 0.35;

/// A place to stand and a point to look at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stand {
    /// Unit: m.
    pub position: DVec3,
    /// Unit: m.
    pub target: DVec3,
}

/// The scene's own view from as far straight back as the walls allow, inside the box around everything.
pub(super) fn overview(solids: &Solids, camera: &Camera) -> Stand {
    let (_, level) = upright(camera);
    let back = Line {
        origin: camera.position,
        direction: -level,
    };
    let farthest = STEP_BACK * solids.extent();
    let room = stretch(&back, &solids.bounds, farthest).map_or(0.0, |[_, end]| end);
    let wished = back.at((room - solids.margin()).max(0.0));
    let stepped = walk(solids, camera.position, wished);
    // Where the step slid along a wall, only its part straight back counts.
    let back = (camera.position - stepped).dot(level).max(0.0);
    let straight = camera.position - level * back;
    let slid = stepped.distance(straight) > 0.1 * back;
    Stand {
        position: if slid { camera.position } else { straight },
        target: camera.target,
    }
}
