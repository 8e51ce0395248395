//! A barn of 10 × 5 × 8 m: the roof is a row of slats, and the sun draws each gap into the dust.

use super::builder::{Builder, camera, fog, glossy, matte, sun};
use crate::description::{Bounds, SceneDescription};

/// Half the width, the height and half the depth. Unit: m.
const BARN: [f64; 3] = [5.0, 5.0, 4.0];
/// Width of a slat. Unit: m.
const SLAT: f64 = 0.34;
/// Distance from slat to slat. Unit: m.
const PITCH: f64 = 0.52;

pub(super) fn description() -> SceneDescription {
    let [x, y, z] = BARN;
    let earth = matte([0.36, 0.29, 0.22]);
    let planks = matte([0.34, 0.24, 0.16]);
    let beam = matte([0.16, 0.10, 0.06]);
    let hay = matte([0.62, 0.46, 0.17]);
    let tin = glossy([0.55, 0.57, 0.60], 0.3);
    let mut barn = Builder::default();

    barn.cuboid([-x - 0.3, -0.3, -z - 0.3], [x + 0.3, 0.0, z + 0.3], &earth);
    barn.cuboid([-x - 0.3, 0.0, -z - 0.3], [x + 0.3, y, -z], &planks);
    barn.cuboid([-x - 0.3, 0.0, z], [x + 0.3, y, z + 0.3], &planks);
    barn.cuboid([-x - 0.3, 0.0, -z], [-x, y, z], &planks);
    barn.cuboid([x, 0.0, -z], [x + 0.3, y, z], &planks);

    let slats = (2.0 * (x + 0.3) / PITCH) as u32;
    for slat in 0..slats {
        let left = -x - 0.3 + f64::from(slat) * PITCH;
        barn.cuboid(
            [left, y, -z - 0.3],
            [left + SLAT, y + 0.06, z + 0.3],
            &planks,
        );
    }
    for rafter in [-2.6, 0.0, 2.6] {
        barn.cuboid([-x, y - 0.28, rafter - 0.1], [x, y, rafter + 0.1], &beam);
    }
    for post_x in [-2.5, 2.5] {
        barn.block([post_x, 0.0, -2.6], [0.24, y - 0.28, 0.24], &beam);
    }

    for (foot, size) in [
        ([-2.9, 0.0, -1.6], [1.3, 0.8, 0.9]),
        ([-1.5, 0.0, -1.9], [1.2, 0.8, 0.9]),
        ([-2.2, 0.8, -1.75], [1.25, 0.75, 0.85]),
        ([3.2, 0.0, 0.6], [0.9, 0.8, 1.3]),
    ] {
        barn.block(foot, size, &hay);
    }
    barn.sphere([1.1, 0.62, -0.6], 0.62, &tin);
    barn.block([1.9, 0.0, -2.7], [0.7, 1.9, 0.7], &beam);

    let inside = Bounds {
        min: [-x, 0.0, -z],
        max: [x, y, z],
    };
    let lights = vec![sun([-0.42, -0.85, 0.26], [34.0, 29.0, 21.0])];
    let media = vec![fog(0.06, [0.96, 0.95, 0.93], 0.5, inside)];
    let camera = camera([-3.6, 1.35, 3.4], [0.9, 1.75, -2.0], 58.0, -0.4);
    barn.scene("Light shafts", camera, lights, media)
}
