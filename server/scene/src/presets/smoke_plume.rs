//! A yard with a chimney of 1.2 m whose smoke, 6 m of it, stands against a low sun.

use super::builder::{Builder, by_reference, camera, matte, procedural, sky, sun};
use crate::description::SceneDescription;
use crate::description::media::ProceduralPattern;

/// Height of the chimney. Unit: m.
const CHIMNEY: f64 = 1.2;
/// Height of the smoke. Unit: m.
const SMOKE: f64 = 6.0;

pub(super) fn description() -> SceneDescription {
    let earth = matte([0.30, 0.26, 0.21]);
    let brick = matte([0.42, 0.20, 0.14]);
    let plaster = matte([0.60, 0.57, 0.52]);
    let wood = matte([0.24, 0.16, 0.10]);
    let mut yard = Builder::default();

    yard.quad(
        [-40.0, 0.0, 40.0],
        [80.0, 0.0, 0.0],
        [0.0, 0.0, -80.0],
        &earth,
    );
    // Four walls around the flue, so that the smoke comes out of a hole.
    let (outer, inner) = (0.34, 0.20);
    let middle = 0.5 * (outer + inner);
    let wall = outer - inner;
    for side in [-1.0, 1.0] {
        yard.block(
            [side * middle, 0.0, 0.0],
            [wall, CHIMNEY, 2.0 * outer],
            &brick,
        );
        yard.block(
            [0.0, 0.0, side * middle],
            [2.0 * inner, CHIMNEY, wall],
            &brick,
        );
    }
    yard.cuboid([-9.0, 0.0, -7.0], [9.0, 1.9, -6.6], &plaster);
    yard.cuboid([-9.1, 1.9, -7.1], [9.1, 2.0, -6.5], &brick);
    for (x, z) in [(-3.4, -2.2), (-2.9, -2.5), (-3.2, -1.7)] {
        yard.block([x, 0.0, z], [0.4, 0.42, 0.4], &wood);
    }
    yard.block([2.9, 0.0, -1.4], [1.1, 0.8, 0.7], &wood);

    let lights = vec![
        sun([-0.72, -0.46, 0.38], [26.0, 21.0, 14.5]),
        sky([0.55, 0.75, 1.15]),
    ];
    let smoke = procedural(
        ProceduralPattern::SmokePlume,
        [0.0, CHIMNEY - 0.05, 0.0],
        SMOKE,
        [5.0, 0.92, 0.5],
    );
    let camera = camera([-2.6, 1.6, 9.4], [0.25, 3.1, 0.0], 46.0, -2.0);
    by_reference(yard.scene("Smoke plume", camera, lights, vec![smoke]))
}
