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

/// Probability of 1 − s·cosθ above `c`, with s the sign of g: no difference of near values.
fn tail(c: f64, g: f64) -> f64 {
    let m = g.abs();
    let r = ((1.0 - m).powi(2) + 2.0 * m * c).sqrt();
    // (1 − m)(1 + cosθ)/(r(1 + m + r)), cosθ = 1 − c.
    (1.0 - m) * (2.0 - c) / (r * (1.0 + m + r))
}

#[test]
fn henyey_greenstein_directions_follow_their_lobe_from_its_tip_to_its_tail() {
    let lobes = [0.0, 1e-4, 0.5, -0.5, 0.9, -0.9, 0.99, -0.99, 0.999, -0.999];
    for (seed, g) in lobes.into_iter().enumerate() {
        let axis = AXIS.as_dvec3();
        let s = if g < 0.0 { -1.0 } else { 1.0 };
        let mut counts = vec![0; 512];
        // Bins of the tail: probabilities 1/2, 1/4, 1/8 and so on.
        let mut halvings = vec![0; 13];
        let parameters = [with(AXIS, g), [0.0; 4], [0.0; 4]];
        for [found, _] in sample(Which::HenyeyGreenstein, 10 + seed as u32, parameters) {
            let v = direction(found);
            let c = (0.5 * (v - s * axis).length_squared()).clamp(0.0, 2.0);
            let u = tail(c, f64::from(g)).clamp(0.0, 1.0);
            let m = f64::from(g.abs());
            let den = (1.0 - m) * (1.0 - m) + 2.0 * m * c;
            assert_density(
                "phase",
                found[3],
                (1.0 - m * m) / (4.0 * PI * den * den.sqrt()),
                2e-3,
            );
            counts[32 * bin(u, 16) + bin(turn(axis, v), 32)] += 1;
            halvings[(-u.max(1e-30).log2()).floor().clamp(0.0, 12.0) as usize] += 1;
        }
        assert_uniform(&format!("phase g {g}"), &counts);
        let share = |k: i32| 0.5_f64.powi(if k == 12 { 12 } else { k + 1 });
        let expected: Vec<f64> = (0..13).map(|k| share(k) * COUNT as f64).collect();
        assert_fits(&format!("phase tail g {g}"), &halvings, &expected);
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
