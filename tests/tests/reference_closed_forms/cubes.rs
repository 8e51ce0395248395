//! Where a beam over one face of a unit cube goes.
//!
//! The camera's pixels cover the face −z, and what lies 2e-4 outside each face emits a colour inward:
//! red before −z, green behind +z, blue on the four sides. Bounds: the table's ±5e-4, and 5e-4 for
//! rays that are up to 5e-4 rad off parallel and the gap before the emitters.

use serde_json::{Value, json};
use tyndall_tests::estimate::{self, Estimate};

const GAP: f64 = 2e-4;
const LEAK: f64 = 5e-4;
const TABLE: f64 = 5e-4;
const SIZE: u32 = 32;
/// Pixels a side that see the cube.
const FACE: u32 = 18;

fn emitter(corner: [f64; 3], edge_u: [f64; 3], edge_v: [f64; 3], emission: [f64; 3]) -> Value {
    json!({ "kind": "quad", "corner": corner, "edge_u": edge_u, "edge_v": edge_v,
        "material": { "base_color": 0, "emission": emission, "double_sided": false } })
}

/// Six quads that face inward and close.
fn inward_box() -> Value {
    let (low, high, side) = (-GAP, 1.0 + GAP, 1.0 + 2.0 * GAP);
    let (x, y, z) = ([side, 0.0, 0.0], [0.0, side, 0.0], [0.0, 0.0, side]);
    let (red, green, blue) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    json!([
        emitter([low, low, low], x, y, red),
        emitter([low, low, high], y, x, green),
        emitter([low, low, low], y, z, blue),
        emitter([high, low, low], z, y, blue),
        emitter([low, low, low], z, x, blue),
        emitter([low, high, low], x, z, blue),
    ])
}

#[test]
fn a_beam_into_a_cube_leaves_where_the_table_says() {
    // algorithms §7.4: (σt, albedo, g) and the shares through −z, +z and the four sides.
    let table = [
        ((5.0, 1.0, 0.0), [0.3691, 0.0487, 0.5822]),
        ((2.0, 1.0, 0.0), [0.2117, 0.2240, 0.5643]),
        ((5.0, 1.0, 0.9), [0.0333, 0.4643, 0.5024]),
        ((20.0, 1.0, 0.9), [0.1432, 0.1107, 0.7461]),
        ((5.0, 0.9, 0.9), [0.0211, 0.2913, 0.3272]),
    ];
    for (seed, ((sigma_t, albedo, g), expected)) in table.into_iter().enumerate() {
        let distance = 0.5 * f64::from(SIZE) / f64::from(FACE) / 0.05_f64.to_radians().tan();
        let still = estimate::render(&json!({
            "version": 1,
            "camera": { "position": [0.5, 0.5, -distance], "target": [0.5, 0.5, 0],
                "vertical_fov_degrees": 0.1 },
            "geometry": inward_box(),
            "media": [{ "kind": "homogeneous", "sigma_t": sigma_t, "albedo": albedo, "g": g,
                "bounds": { "min": [0, 0, 0], "max": [1, 1, 1] } }],
            "render": { "technique": "reference", "width": SIZE, "height": SIZE, "samples": 192,
                "seed": seed },
        }));
        let edge = (SIZE - FACE) / 2;
        let inside = |i: u32| (edge..edge + FACE).contains(&i);
        let weight = |i: usize| {
            let i = i as u32;
            let seen = inside(i % SIZE) && inside(i / SIZE);
            if seen {
                1.0 / f64::from(FACE * FACE)
            } else {
                0.0
            }
        };
        let found = Estimate::of_weighted_pixels(&still, weight);
        for (channel, face) in ["−z", "+z", "sides"].into_iter().enumerate() {
            let name = format!("cube sigma {sigma_t} albedo {albedo} g {g} {face}");
            found.assert_channel(&name, channel, expected[channel], TABLE + LEAK);
        }
    }
}
