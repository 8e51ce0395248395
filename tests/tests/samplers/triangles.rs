//! Directions uniform over the solid angle of a triangle, against its closed form (Van Oosterom and
//! Strackee 1983).

use glam::{DVec3, Vec3};
use tyndall_tests::chi_squared::assert_fits;

use super::{COUNT, Which, assert_density, direction, sample, with};

/// Rows of parts that a triangle is cut into.
const ROWS: usize = 6;

/// Unit: sr.
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    // By the edges: unit vectors would lose the digits of a small one, even in f64.
    let volume = (b - a).cross(c - a).dot(a).abs();
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let shared = la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la;
    2.0 * volume.atan2(shared)
}

/// The ROWS² parts, each with the barycentric place of its middle.
fn parts([a, b, c]: [DVec3; 3]) -> Vec<f64> {
    let n = ROWS as f64;
    let at = |i: f64, j: f64| a + (b - a) * (i / n) + (c - a) * (j / n);
    let mut found = vec![0.0; ROWS * ROWS * 2];
    for i in 0..ROWS {
        for j in 0..ROWS - i {
            let (x, y) = (i as f64, j as f64);
            found[2 * (i * ROWS + j)] = solid_angle([at(x, y), at(x + 1.0, y), at(x, y + 1.0)]);
            if i + j + 1 < ROWS {
                let corners = [at(x + 1.0, y + 1.0), at(x + 1.0, y), at(x, y + 1.0)];
                found[2 * (i * ROWS + j) + 1] = solid_angle(corners);
            }
        }
    }
    found
}

/// Which part the ray along `v` meets.
fn part([a, b, c]: [DVec3; 3], v: DVec3) -> usize {
    let normal = (b - a).cross(c - a);
    let met = v * (normal.dot(a) / normal.dot(v)) - a;
    let squared = normal.length_squared();
    let x = met.cross(c - a).dot(normal) / squared;
    let y = (b - a).cross(met).dot(normal) / squared;
    let slack = 2e-4;
    assert!(
        x > -slack && y > -slack && x + y < 1.0 + slack,
        "outside: {x} {y}"
    );
    let n = ROWS as f64;
    let (x, y) = (x.max(0.0) * n, y.max(0.0) * n);
    let (i, j) = ((x as usize).min(ROWS - 1), (y as usize).min(ROWS - 1));
    let second = x.fract() + y.fract() > 1.0 && i + j + 1 < ROWS;
    2 * (i * ROWS + j.min(ROWS - 1 - i)) + usize::from(second)
}

#[test]
fn directions_are_uniform_over_the_solid_angle_of_a_triangle() {
    // Way to the first corner, edges: an ordinary one, one close by that fills nearly half of all
    // directions, one seen at a grazing angle, a sliver, and ones of 1e-3 and 1e-4 sr.
    let cases: [[[f32; 3]; 3]; 6] = [
        [[1.0, 0.5, -2.0], [0.3, 2.0, 0.1], [-2.0, 0.4, 0.6]],
        [[-30.0, -30.0, 0.05], [80.0, 0.0, 0.0], [0.0, 80.0, 0.0]],
        [[2.0, 0.05, -1.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]],
        [[1.0, -1.0, 3.0], [0.01, 2.0, 0.0], [0.02, 1.0, 0.0]],
        [[10.0, -3.0, 3.0], [0.3, 0.3, 0.0], [0.0, 0.5, -0.4]],
        [[10.0, -3.0, 3.0], [0.1, 0.1, 0.0], [0.0, 0.15, -0.1]],
    ];
    for (seed, case) in cases.into_iter().enumerate() {
        let [corner, edge1, edge2] = case.map(Vec3::from);
        let a = corner.as_dvec3();
        let corners = [a, a + edge1.as_dvec3(), a + edge2.as_dvec3()];
        let whole = solid_angle(corners);
        let name = format!("triangle of {whole:.1e} sr");
        let mut counts = vec![0; ROWS * ROWS * 2];
        let parameters = [with(corner, 0.0), with(edge1, 0.0), with(edge2, 0.0)];
        for [found, _] in sample(Which::SphericalTriangle, 90 + seed as u32, parameters) {
            let v = direction(found);
            assert!((v.length() - 1.0).abs() < 1e-6, "{name}: {v}");
            assert_density(&name, found[3], 1.0 / whole, 1e-4);
            counts[part(corners, v)] += 1;
        }
        let expected: Vec<f64> = parts(corners)
            .into_iter()
            .map(|part| part / whole * COUNT as f64)
            .collect();
        assert_fits(&name, &counts, &expected);
    }
}
