//! Directions, points on triangles, and the choice of a candidate.

use std::f64::consts::PI;

use glam::Vec3;
use tyndall_tests::chi_squared::{assert_fits, assert_uniform, bin};

use super::{AXIS, COUNT, Which, assert_density, direction, sample, turn, with};

#[test]
fn cosine_directions_are_cosine_distributed() {
    for (seed, axis) in [AXIS, Vec3::NEG_Z, Vec3::Y].into_iter().enumerate() {
        let n = axis.as_dvec3();
        let mut counts = vec![0; 256];
        for [found, _] in sample(
            Which::Cosine,
            seed as u32,
            [with(axis, 0.0), [0.0; 4], [0.0; 4]],
        ) {
            let v = direction(found);
            assert!((v.length() - 1.0).abs() < 1e-6);
            let cosine = v.dot(n);
            assert!(cosine > 0.0, "below the surface: {cosine}");
            assert_density("cosine", found[3], cosine / PI, 1e-3);
            counts[16 * bin(cosine * cosine, 16) + bin(turn(n, v), 16)] += 1;
        }
        assert_uniform(&format!("cosine about {axis}"), &counts);
    }
}

#[test]
fn triangle_points_are_uniform() {
    let mut counts = vec![0; 128];
    for [found, _] in sample(Which::Triangle, 30, [[0.0; 4]; 3]) {
        let (a, b) = (f64::from(found[0]), f64::from(found[1]));
        assert!(
            a >= 0.0 && b >= 0.0 && a + b <= 1.0 + 1e-6,
            "outside: {a} {b}"
        );
        // The share with less of the first corner, and the place between the others.
        let rest = a + b;
        let along = if rest > 0.0 { b / rest } else { 0.0 };
        counts[16 * bin(rest * rest, 8) + bin(along, 16)] += 1;
    }
    assert_uniform("triangle", &counts);
}

#[test]
fn a_reservoir_keeps_candidates_in_proportion() {
    let sets = [
        [1.0, 2.0, 3.0, 4.0, 0.0, 10.0, 0.5, 1.0_f32],
        [0.0, 0.0, 1e-20, 3e-20, 0.0, 0.0, 1e-20, 0.0],
        [1e6, 1.0, 1.0, 1e5, 1e6, 10.0, 1e4, 1e6],
    ];
    for (seed, weights) in sets.into_iter().enumerate() {
        let [a, b] = [0, 4].map(|i| std::array::from_fn(|k| weights[i + k]));
        let sum: f64 = weights.iter().map(|w| f64::from(*w)).sum();
        let mut kept = vec![0; 8];
        let mut left = vec![0; 32];
        for [found, _] in sample(Which::Reservoir, 40 + seed as u32, [a, b, [0.0; 4]]) {
            kept[found[0] as usize] += 1;
            left[bin(f64::from(found[2]), 32)] += 1;
            assert_density("sum", found[1], sum, 1e-5);
            assert_density("kept", found[3], 1.0, 1e-5);
        }
        let expected: Vec<f64> = weights
            .iter()
            .map(|w| f64::from(*w) / sum * COUNT as f64)
            .collect();
        for (kept, weight) in kept.iter().zip(weights) {
            assert!(weight > 0.0 || *kept == 0, "kept what is worth nothing");
        }
        assert_fits(&format!("reservoir {seed}"), &kept, &expected);
        assert_uniform(&format!("reservoir {seed}, what is left"), &left);
    }
}
