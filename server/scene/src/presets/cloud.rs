//! A cumulus of 260 m over fields, lit from the side.

use super::builder::{Builder, by_reference, camera, matte, procedural, sky, sun};
use crate::description::SceneDescription;
use crate::description::media::ProceduralPattern;

/// Width of the cloud's box. Unit: m.
const WIDTH: f64 = 260.0;
/// Height of the box above the ground. Unit: m.
const BASE: f64 = 90.0;

pub(super) fn description() -> SceneDescription {
    let meadow = matte([0.16, 0.22, 0.08]);
    let rape = matte([0.46, 0.42, 0.10]);
    let soil = matte([0.24, 0.17, 0.11]);
    let barn = matte([0.45, 0.16, 0.12]);
    let mut fields = Builder::default();

    let far = 4000.0;
    fields.quad(
        [-far, 0.0, far],
        [2.0 * far, 0.0, 0.0],
        [0.0, 0.0, -2.0 * far],
        &meadow,
    );
    for (x, z, width, depth, crop) in [
        (-420.0, -60.0, 260.0, 130.0, &rape),
        (-120.0, -170.0, 300.0, 120.0, &soil),
        (230.0, -40.0, 240.0, 150.0, &rape),
        (160.0, -330.0, 330.0, 160.0, &soil),
        (-380.0, -380.0, 380.0, 170.0, &rape),
    ] {
        fields.block([x, 0.0, z], [width, 0.3, depth], crop);
    }
    fields.block([-70.0, 0.0, 90.0], [18.0, 8.0, 10.0], &barn);
    fields.block([-48.0, 0.0, 84.0], [10.0, 5.0, 8.0], &barn);

    let lights = vec![
        sun([0.78, -0.52, -0.35], [20.0, 18.6, 16.4]),
        sky([0.9, 1.5, 2.7]),
    ];
    let cloud = procedural(
        ProceduralPattern::Cloud,
        [0.0, BASE, 0.0],
        WIDTH,
        [0.09, 0.999, 0.85],
    );
    let camera = camera([35.0, 24.0, 330.0], [0.0, 128.0, 0.0], 48.0, -2.4);
    by_reference(fields.scene("Cloud", camera, lights, vec![cloud]))
}
