//! A street between façades, 60 m long, with a lamp every 12 m on alternating sides. The fog is
//! thickest at the ground and lit by the lamps alone.

use super::builder::{Builder, camera, glossy, glowing, height_fog, matte, point, spot};
use crate::description::{Bounds, LightDescription, MaterialDescription, SceneDescription};

/// Half the width of the roadway. Unit: m.
const ROAD: f64 = 3.6;
/// Distance of the façades from the middle. Unit: m.
const FACADE: f64 = 6.2;
/// Where the street begins and ends. Unit: m.
const STREET: [f64; 2] = [8.0, -52.0];
/// Width and height of each house, the same list on both sides, shifted. Unit: m.
const HOUSES: [[f64; 2]; 6] = [
    [9.0, 10.5],
    [11.0, 13.5],
    [8.5, 9.0],
    [12.0, 12.0],
    [9.5, 14.5],
    [10.0, 11.0],
];

pub(super) fn description() -> SceneDescription {
    let asphalt = glossy([0.07, 0.07, 0.075], 0.4);
    let kerb = matte([0.24, 0.23, 0.22]);
    let paint = matte([0.55, 0.54, 0.5]);
    let mut street = Builder::default();
    let [near, far] = STREET;
    street.cuboid([-ROAD, -0.3, far], [ROAD, 0.0, near], &asphalt);
    for side in [-1.0, 1.0] {
        let edges = [side * ROAD, side * (FACADE + 8.0)];
        let (low, high) = (edges[0].min(edges[1]), edges[0].max(edges[1]));
        street.cuboid([low, -0.3, far], [high, 0.14, near], &kerb);
        houses(&mut street, side);
    }
    for dash in 0..15 {
        let z = near - 2.0 - f64::from(dash) * 4.0;
        street.quad(
            [-0.07, 0.004, z],
            [0.14, 0.0, 0.0],
            [0.0, 0.0, -1.8],
            &paint,
        );
    }
    // The street ends at a wide house.
    let brick = matte([0.20, 0.12, 0.10]);
    street.cuboid([-14.0, 0.0, far - 6.0], [14.0, 12.5, far], &brick);

    let mut lights = lamps(&mut street);
    // A shop sign: the one cool light.
    let sign = glowing([1.4, 4.2, 7.0]);
    street.cuboid([4.9, 3.0, -20.6], [FACADE, 3.5, -20.4], &sign);
    lights.push(point("shop sign", [4.6, 2.8, -20.5], [3.0, 9.0, 15.0]));

    let air = Bounds {
        min: [-15.0, 0.0, far],
        max: [15.0, 24.0, near],
    };
    let media = vec![height_fog(0.075, [0.96, 0.96, 0.97], 0.35, 0.16, air)];
    let camera = camera([1.3, 1.65, 6.6], [-0.5, 3.1, -14.0], 52.0, 1.3);
    street.scene("Street at night", camera, lights, media)
}

/// One side of the street: boxes with ledges and windows, some of them lit.
fn houses(street: &mut Builder, side: f64) {
    let walls = [
        matte([0.27, 0.24, 0.21]),
        matte([0.22, 0.14, 0.11]),
        matte([0.30, 0.28, 0.26]),
    ];
    let ledge = matte([0.33, 0.31, 0.29]);
    let [near, far] = STREET;
    // The right side starts in the middle of the list, so that no two houses face their twin.
    let shift = if side > 0.0 { 3 } else { 0 };
    let mut start = near;
    for house in 0..HOUSES.len() {
        let [width, height] = HOUSES[(house + shift) % HOUSES.len()];
        let end = (start - width).max(far);
        let (inner, outer) = (side * FACADE, side * (FACADE + 8.0));
        let (low, high) = (inner.min(outer), inner.max(outer));
        let wall = &walls[(house + shift) % walls.len()];
        street.cuboid([low, 0.0, end], [high, height, start], wall);
        let lip = side * (FACADE - 0.25);
        street.cuboid(
            [lip.min(outer), height - 0.4, end],
            [lip.max(outer), height, start],
            &ledge,
        );
        let face = Face {
            side,
            start,
            end,
            height,
            salt: house as u32 + 10 * shift as u32,
        };
        windows(street, &face);
        start = end;
        if start <= far {
            break;
        }
    }
}

/// The street side of a house.
struct Face {
    side: f64,
    start: f64,
    end: f64,
    height: f64,
    /// Makes the pattern of lit windows differ from house to house.
    salt: u32,
}

/// Rows of windows just in front of the wall.
fn windows(street: &mut Builder, face: &Face) {
    const WIDTH: f64 = 1.1;
    const HEIGHT: f64 = 1.6;
    let dark = glossy([0.03, 0.035, 0.045], 0.15);
    let lit = [
        glowing([2.6, 1.7, 0.75]),
        glowing([1.5, 0.95, 0.4]),
        glowing([1.9, 1.6, 1.1]),
    ];
    let columns = ((face.start - face.end) / 2.4) as u32;
    let floors = ((face.height - 2.0) / 3.1) as u32;
    let spacing = (face.start - face.end) / f64::from(columns.max(1));
    let x = face.side * (FACADE - 0.02);
    for floor in 0..floors {
        for column in 0..columns {
            let middle = face.start - (f64::from(column) + 0.5) * spacing;
            let sill = 1.2 + f64::from(floor) * 3.1;
            let chance = scatter(face.salt, floor * 16 + column) % 9;
            let pane: &MaterialDescription = lit.get(chance as usize).unwrap_or(&dark);
            // The front faces the street: u runs so that u × v points to the middle.
            let corner = [x, sill, middle - face.side * WIDTH / 2.0];
            let edge_u = [0.0, 0.0, face.side * WIDTH];
            street.quad(corner, edge_u, [0.0, HEIGHT, 0.0], pane);
        }
    }
}

/// A fixed pattern that looks random.
fn scatter(salt: u32, index: u32) -> u32 {
    let mixed = (index ^ salt.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b);
    (mixed ^ (mixed >> 13)).wrapping_mul(0xc2b2_ae35) >> 16
}

/// Posts with an arm over the roadway; returns their lights.
fn lamps(street: &mut Builder) -> Vec<LightDescription> {
    let iron = glossy([0.05, 0.055, 0.055], 0.5);
    let glass = glowing([60.0, 36.0, 14.0]);
    let mut lights = Vec::new();
    for lamp in 0..5 {
        let side = if lamp % 2 == 0 { -1.0 } else { 1.0 };
        let z = -1.0 - f64::from(lamp) * 11.0;
        let post = side * (ROAD + 0.5);
        let head = side * (ROAD - 0.9);
        street.block([post, 0.14, z], [0.14, 5.6, 0.14], &iron);
        let (low, high) = (post.min(head), post.max(head));
        street.cuboid([low, 5.64, z - 0.05], [high, 5.74, z + 0.05], &iron);
        street.block([head, 5.52, z], [0.5, 0.12, 0.3], &iron);
        street.block([head, 5.47, z], [0.4, 0.05, 0.22], &glass);
        lights.push(spot(
            &format!("lamp {}", lamp + 1),
            [head, 5.4, z],
            [0.0, -1.0, 0.0],
            [130.0, 82.0, 36.0],
            [28.0, 68.0],
        ));
    }
    lights
}
