//! A nave of 24 × 9 × 8 m with two arcades. The sun stands ahead of the camera and to the right,
//! 44° high: its shafts cross under the right arcade and end in the middle of the floor.

use super::builder::{
    Arch, Builder, Triangles, camera, fog, glossy, glowing, matte, point, spot, sun,
};
use crate::description::{Bounds, MaterialDescription, SceneDescription};

/// Half the length, half the width and the height. Unit: m.
const HALL: [f64; 3] = [12.0, 8.0, 4.5];
/// Thickness of the walls: deep jambs shape the shafts. Unit: m.
const WALL: f64 = 0.8;
/// Distance between pillars and between windows. Unit: m.
const BAY: f64 = 4.0;
/// Distance of the arcades from the middle. Unit: m.
const ARCADE: f64 = 2.6;

pub(super) fn description() -> SceneDescription {
    let stone = matte([0.58, 0.53, 0.46]);
    let pale = matte([0.66, 0.62, 0.55]);
    let mut hall = Builder::default();
    shell(&mut hall, &stone);
    window_wall(&mut hall, &stone);
    end_wall(&mut hall, &stone);
    arcades(&mut hall, &pale);
    furniture(&mut hall);
    daylight(&mut hall);

    let lights = vec![
        sun([-0.45, -0.75, -0.62], [26.0, 21.5, 15.5]),
        point("near lantern", [-4.0, 3.75, 0.0], [9.0, 5.2, 2.2]),
        point("far lantern", [4.0, 3.75, 0.0], [9.0, 5.2, 2.2]),
        spot(
            "altar lamp",
            [8.6, 7.4, 0.0],
            [0.28, -1.0, 0.0],
            [80.0, 52.0, 28.0],
            [14.0, 30.0],
        ),
    ];
    let [x, y, z] = HALL;
    let inside = Bounds {
        min: [-x, 0.0, -z],
        max: [x, y, z],
    };
    let media = vec![fog(0.045, [0.97, 0.97, 0.96], 0.45, inside)];
    let camera = camera([-10.6, 1.75, 1.05], [2.0, 2.75, -0.35], 56.0, 1.0);
    hall.scene("Fogged hall", camera, lights, media)
}

/// A bright sky seen through the windows, far and low enough to let the sun pass over it.
fn daylight(hall: &mut Builder) {
    let sky = glowing([0.42, 0.55, 0.75]);
    let [x, y, z] = HALL;
    let (ahead, beside) = (x + 6.0, z + 6.0);
    hall.quad(
        [ahead, -1.0, -z - 1.0],
        [0.0, y + 1.0, 0.0],
        [0.0, 0.0, 2.0 * z + 2.0],
        &sky,
    );
    hall.quad(
        [-x, -1.0, beside],
        [2.0 * x, 0.0, 0.0],
        [0.0, y + 1.0, 0.0],
        &sky,
    );
}

/// Floor, ceiling with beams, and the two walls without windows.
fn shell(hall: &mut Builder, stone: &MaterialDescription) {
    let [x, y, z] = HALL;
    let floor = glossy([0.34, 0.31, 0.28], 0.55);
    let plaster = matte([0.42, 0.39, 0.35]);
    let oak = matte([0.20, 0.13, 0.08]);
    let (out_x, out_z) = (x + WALL, z + WALL);
    hall.cuboid([-out_x, -0.4, -out_z], [out_x, 0.0, out_z], &floor);
    hall.cuboid([-out_x, y, -out_z], [out_x, y + 0.4, out_z], &plaster);
    hall.cuboid([-out_x, 0.0, -out_z], [out_x, y, -z], stone);
    hall.cuboid([-out_x, 0.0, -z], [-x, y, out_z], stone);
    for beam in -2..=2 {
        let middle = f64::from(beam) * BAY;
        hall.cuboid([middle - 0.16, y - 0.35, -z], [middle + 0.16, y, z], &oak);
    }
    // Pilasters and a ledge give the blind wall a scale.
    for bay in -3..=3 {
        let middle = f64::from(bay) * BAY;
        let near = [(middle - 0.3).max(-x), 0.0, -z];
        let far = [(middle + 0.3).min(x), y, -z + 0.18];
        hall.cuboid(near, far, stone);
    }
    hall.cuboid([-x, 2.3, -z], [x, 2.45, -z + 0.12], stone);
}

/// The right wall: six tall windows with a cross of bars each.
fn window_wall(hall: &mut Builder, stone: &MaterialDescription) {
    const SILL: f64 = 2.4;
    const LINTEL: f64 = 6.9;
    const WIDTH: f64 = 1.7;
    let iron = matte([0.05, 0.05, 0.055]);
    let [x, y, z] = HALL;
    let (inner, outer) = (z, z + WALL);
    hall.cuboid([-x, 0.0, inner], [x + WALL, SILL, outer], stone);
    hall.cuboid([-x, LINTEL, inner], [x + WALL, y, outer], stone);
    let mut pier_start = -x;
    for window in 0..6 {
        let middle = -x + (f64::from(window) + 0.5) * BAY;
        let (left, right) = (middle - WIDTH / 2.0, middle + WIDTH / 2.0);
        hall.cuboid([pier_start, SILL, inner], [left, LINTEL, outer], stone);
        pier_start = right;
        let bar_z = [inner + 0.35, inner + 0.45];
        hall.cuboid(
            [middle - 0.06, SILL, bar_z[0]],
            [middle + 0.06, LINTEL, bar_z[1]],
            &iron,
        );
        for bar in 1..=2 {
            let height = SILL + f64::from(bar) * (LINTEL - SILL) / 3.0;
            hall.cuboid(
                [left, height - 0.05, bar_z[0]],
                [right, height + 0.05, bar_z[1]],
                &iron,
            );
        }
    }
    hall.cuboid([pier_start, SILL, inner], [x + WALL, LINTEL, outer], stone);
}

/// The wall ahead: three lancets above the altar.
fn end_wall(hall: &mut Builder, stone: &MaterialDescription) {
    const SILL: f64 = 3.3;
    const LINTEL: f64 = 6.8;
    let [x, y, z] = HALL;
    let (inner, outer) = (x, x + WALL);
    hall.cuboid([inner, 0.0, -z], [outer, SILL, z], stone);
    hall.cuboid([inner, LINTEL, -z], [outer, y, z], stone);
    let mut pier_start = -z;
    for middle in [-1.5, 0.0, 1.5] {
        hall.cuboid(
            [inner, SILL, pier_start],
            [outer, LINTEL, middle - 0.4],
            stone,
        );
        pier_start = middle + 0.4;
    }
    hall.cuboid([inner, SILL, pier_start], [outer, LINTEL, z], stone);
}

/// Two rows of six pillars that carry round arches.
fn arcades(hall: &mut Builder, pale: &MaterialDescription) {
    const HALF_WALL: f64 = 0.3;
    const SPRING: f64 = 4.2;
    let [x, y, _] = HALL;
    let mut shafts = Triangles::default();
    let mut arches = Triangles::default();
    for z in [-ARCADE, ARCADE] {
        for pillar in 0..6 {
            let middle = -10.0 + f64::from(pillar) * BAY;
            hall.block([middle, 0.0, z], [1.0, 0.35, 1.0], pale);
            shafts.prism([middle, 0.35, z], [0.34, 0.3], 3.45, 8);
            hall.block([middle, 3.8, z], [0.9, 0.4, 0.8], pale);
            // The wall between neighbouring arches.
            let solid = [middle - 0.4, middle + 0.4];
            hall.cuboid(
                [solid[0], SPRING, z - HALF_WALL],
                [solid[1], y, z + HALF_WALL],
                pale,
            );
        }
        for bay in 0..5 {
            arches.arch(&Arch {
                center_x: -8.0 + f64::from(bay) * BAY,
                radius: 1.6,
                spring: SPRING,
                top: y,
                z: [z - HALF_WALL, z + HALF_WALL],
            });
        }
        // The half bays at both ends are closed above.
        for (from, to) in [(-x, -10.4), (10.4, x)] {
            let (low, high) = ([from, 5.6, z - HALF_WALL], [to, y, z + HALF_WALL]);
            hall.cuboid(low, high, pale);
        }
    }
    hall.mesh("pillars", shafts, pale);
    hall.mesh("arches", arches, pale);
}

/// Runner, altar, lanterns.
fn furniture(hall: &mut Builder) {
    let cloth = matte([0.32, 0.045, 0.04]);
    let marble = glossy([0.72, 0.70, 0.66], 0.35);
    let gold = MaterialDescription {
        metallic: 1.0,
        ..glossy([0.9, 0.62, 0.25], 0.35)
    };
    let iron = matte([0.05, 0.05, 0.055]);
    hall.cuboid([-11.0, 0.0, -0.7], [7.6, 0.012, 0.7], &cloth);
    hall.cuboid([7.6, 0.0, -1.9], [12.0, 0.16, 1.9], &marble);
    hall.cuboid([8.2, 0.16, -1.6], [12.0, 0.32, 1.6], &marble);
    hall.block([9.9, 0.32, 0.0], [0.9, 1.0, 2.2], &marble);
    hall.sphere([9.9, 1.68, 0.0], 0.36, &gold);

    let lamp = glowing([30.0, 17.0, 7.0]);
    let [_, y, _] = HALL;
    for x in [-4.0, 4.0] {
        // The glowing part hangs above the light, which therefore reaches the floor.
        hall.block([x, 3.9, 0.0], [0.22, 0.3, 0.22], &lamp);
        hall.block([x, 4.2, 0.0], [0.34, 0.06, 0.34], &iron);
        hall.block([x, 4.26, 0.0], [0.03, y - 4.26, 0.03], &iron);
    }
}
