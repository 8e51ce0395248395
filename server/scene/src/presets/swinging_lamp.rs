//! A workshop of 8 × 4 × 6 m in fog. A lamp swings on its cable over the bench, a fan turns under a
//! lamp on the left and a crate slides by; the lamp on the right lights nothing that moves.

use std::f64::consts::{PI, TAU};

use super::builder::{Builder, Triangles, camera, fog, glossy, matte, spot};
use crate::description::geometry::TransformKeyframe;
use crate::description::lights::SpotKeyframe;
use crate::description::{
    AnimationDescription, Bounds, LightDescription, SceneDescription, Transform,
};

/// Half the width, the height and half the depth. Unit: m.
const ROOM: [f64; 3] = [4.0, 4.0, 3.0];
/// After which everything starts over. Unit: s.
const PERIOD: f64 = 6.0;
/// Swings of the lamp in that time.
const SWINGS: f64 = 2.0;
/// Keyframes in that time: the lamp leaves its arc by no more than 6 mm on the chords between.
const KEYS: u32 = 48;
/// Where the lamp's cable hangs. Unit: m.
const HOOK: [f64; 3] = [0.4, 4.0, -0.4];
/// From the hook to the bulb. Unit: m.
const CABLE: f64 = 1.7;
/// Farthest swing. Unit: degree.
const AMPLITUDE_DEGREES: f64 = 38.0;

/// Evenly spaced times, the last one a period after the first.
fn times() -> impl Iterator<Item = f64> {
    (0..=KEYS).map(|key| f64::from(key) / f64::from(KEYS) * PERIOD)
}

/// The lamp's angle about z. Unit: degree.
fn swing_degrees(seconds: f64) -> f64 {
    AMPLITUDE_DEGREES * (TAU * SWINGS * seconds / PERIOD).cos()
}

/// Keyframes of a placement.
fn placed(at: impl Fn(f64) -> Transform) -> Vec<TransformKeyframe> {
    times()
        .map(|time_seconds| TransformKeyframe {
            time_seconds,
            transform: at(time_seconds),
        })
        .collect()
}

/// The lamp on its cable, from the hook down; swings about it.
fn pendulum(scene: &mut Builder) {
    let swings = || {
        placed(|seconds| Transform {
            translation: HOOK,
            rotation_degrees: [0.0, 0.0, swing_degrees(seconds)],
            ..Transform::default()
        })
    };
    let iron = glossy([0.20, 0.20, 0.22], 0.4);
    let shade = matte([0.10, 0.22, 0.16]);
    scene.cuboid([-0.012, -CABLE + 0.2, -0.012], [0.012, 0.0, 0.012], &iron);
    scene.moves(swings());
    // Open below; the light is at its brim, so that the shade dims none of the cone. Nothing glows by
    // itself: then no ray is traced, and no BVH is built for any frame.
    let mut cone = Triangles::default();
    cone.prism([0.0, -CABLE + 0.02, 0.0], [0.26, 0.06], 0.2, 20);
    scene.mesh("lampshade", cone, &shade);
    scene.moves(swings());
}

/// The light of the swinging lamp.
fn swinging_light() -> LightDescription {
    let pose = |seconds: f64| {
        let (sin, cos) = swing_degrees(seconds).to_radians().sin_cos();
        let direction = [sin, -cos, 0.0];
        let position: [f64; 3] = std::array::from_fn(|i| HOOK[i] + CABLE * direction[i]);
        (position, direction)
    };
    let (position, direction) = pose(0.0);
    let intensity = [46.0, 36.0, 21.0];
    let mut light = spot(
        "swinging lamp",
        position,
        direction,
        intensity,
        [24.0, 40.0],
    );
    if let LightDescription::Spot(light) = &mut light {
        light.keyframes = times()
            .map(|time_seconds| {
                let (position, direction) = pose(time_seconds);
                SpotKeyframe {
                    time_seconds,
                    position,
                    direction,
                }
            })
            .collect();
    }
    light
}

/// A fan of three blades that turns level under the left lamp, twice in a period.
fn fan(scene: &mut Builder) {
    let tin = glossy([0.5, 0.52, 0.55], 0.35);
    let hub = [-2.5, 2.35, -0.9];
    for blade in 0..3 {
        scene.cuboid([0.1, -0.012, -0.11], [0.72, 0.012, 0.11], &tin);
        scene.moves(placed(|seconds| {
            let degrees = 120.0 * f64::from(blade) + 720.0 * seconds / PERIOD;
            Transform {
                translation: hub,
                rotation_degrees: [0.0, degrees, 0.0],
                ..Transform::default()
            }
        }));
    }
}

/// A crate that slides to and fro before the bench, through the swinging light.
fn crate_on_wheels(scene: &mut Builder) {
    let wood = matte([0.45, 0.30, 0.16]);
    scene.cuboid([-0.3, 0.0, -0.3], [0.3, 0.62, 0.3], &wood);
    scene.moves(placed(|seconds| {
        let phase = TAU * seconds / PERIOD;
        Transform {
            translation: [0.4 + 1.1 * phase.sin(), 0.0, 0.6],
            rotation_degrees: [0.0, 25.0 * (phase + 0.5 * PI).sin(), 0.0],
            ..Transform::default()
        }
    }));
}

/// Walls, the bench, and slats under the lamp on the right.
fn workshop(scene: &mut Builder) {
    let [x, y, z] = ROOM;
    let floor = matte([0.30, 0.28, 0.26]);
    let plaster = matte([0.50, 0.47, 0.43]);
    let wood = matte([0.36, 0.24, 0.14]);
    scene.cuboid([-x - 0.2, -0.2, -z - 0.2], [x + 0.2, 0.0, z + 0.2], &floor);
    scene.cuboid([-x - 0.2, 0.0, -z - 0.2], [x + 0.2, y, -z], &plaster);
    scene.cuboid([-x - 0.2, 0.0, -z], [-x, y, z], &plaster);
    scene.cuboid([x, 0.0, -z], [x + 0.2, y, z], &plaster);
    scene.block([0.4, 0.82, -1.0], [2.4, 0.08, 0.8], &wood);
    for side in [-1.0, 1.0] {
        scene.block([0.4 + side * 1.05, 0.0, -1.0], [0.1, 0.82, 0.7], &wood);
    }
    scene.sphere([0.0, 1.08, -1.0], 0.18, &matte([0.62, 0.16, 0.10]));
    let tin = matte([0.2, 0.34, 0.5]);
    scene.block([0.85, 0.9, -1.1], [0.26, 0.34, 0.26], &tin);
    for slat in 0..6 {
        let left = 2.3 + 0.28 * f64::from(slat);
        scene.cuboid([left, 2.1, -2.4], [left + 0.12, 2.14, -1.2], &wood);
    }
    scene.block([3.0, 0.0, -1.8], [0.9, 0.7, 0.9], &wood);
}

pub(super) fn description() -> SceneDescription {
    let [x, y, z] = ROOM;
    let mut scene = Builder::default();
    workshop(&mut scene);
    pendulum(&mut scene);
    fan(&mut scene);
    crate_on_wheels(&mut scene);

    let lamp = |name: &str, position: [f64; 3], intensity: [f64; 3], angles: [f64; 2]| {
        spot(name, position, [0.0, -1.0, 0.0], intensity, angles)
    };
    let lights = vec![
        swinging_light(),
        lamp(
            "fan lamp",
            [-2.5, 3.9, -0.9],
            [15.0, 19.0, 26.0],
            [16.0, 26.0],
        ),
        lamp(
            "shelf lamp",
            [3.0, 3.9, -1.8],
            [26.0, 22.0, 17.0],
            [12.0, 20.0],
        ),
    ];
    // The eye stands in the fog, too: the room is open toward it.
    let inside = Bounds {
        min: [-x, 0.0, -z],
        max: [x, y, z + 3.0],
    };
    let media = vec![fog(0.11, [0.95, 0.95, 0.95], 0.35, inside)];
    let camera = camera([0.0, 1.9, 5.6], [0.05, 1.75, -1.0], 52.0, 1.2);
    let mut scene = scene.scene("Swinging lamp", camera, lights, media);
    scene.animation = Some(AnimationDescription {
        period_seconds: Some(PERIOD),
    });
    scene
}
