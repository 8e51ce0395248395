//! Shader functions on a device against f64 oracles.

use glam::DVec3;
use tyndall_render::probe;
use tyndall_tests::{gpu, probes};

#[test]
fn one_minus_exp_neg_keeps_its_digits_from_1e_minus_8_to_1e4() {
    let device = gpu::device();
    let xs: Vec<f32> = (0..2000)
        .map(|i| 10_f32.powf(-8.0 + 12.0 * i as f32 / 1999.0))
        .collect();
    let inputs: Vec<[f32; 4]> = xs.iter().map(|x| [*x, 0.0, 0.0, 0.0]).collect();
    let outputs = gpu::probe_vec4(
        &device,
        "probe_numeric",
        0,
        &[("inputs", bytemuck::cast_slice(&inputs))],
        2 * xs.len(),
    );
    for (x, pair) in xs.iter().zip(outputs.chunks_exact(2)) {
        let x64 = f64::from(*x);
        let exact = -(-x64).exp_m1();
        assert!(
            gpu::relative_error(pair[0][1], exact) < 1e-6,
            "1 - e^-{x}: {} for {exact}",
            pair[0][1]
        );
        assert!(
            gpu::relative_error(pair[0][0], exact / x64) < 1e-6,
            "em1({x})"
        );
        assert_eq!(pair[0][3], 1.0, "{x} is finite");
    }
}

#[test]
fn em1_is_one_at_zero_and_continuous_where_series_meets_quotient() {
    let device = gpu::device();
    let inputs = [
        [0.0_f32, 0.0, 0.0, 0.0],
        [0.249_999_9, 0.0, 0.0, 0.0],
        [0.25, 0.0, 0.0, 0.0],
    ];
    let outputs = gpu::probe_vec4(
        &device,
        "probe_numeric",
        0,
        &[("inputs", bytemuck::cast_slice(&inputs))],
        6,
    );
    assert_eq!(outputs[0][0], 1.0);
    assert!((outputs[2][0] - outputs[4][0]).abs() < 1e-6);
}

#[test]
fn neg_log_one_minus_matches_log1p() {
    let device = gpu::device();
    let ys: Vec<f32> = (0..1000)
        .map(|i| {
            if i < 500 {
                10_f32.powf(-8.0 + 6.0 * i as f32 / 500.0)
            } else {
                (i - 499) as f32 / 502.0
            }
        })
        .collect();
    let inputs: Vec<[f32; 4]> = ys.iter().map(|y| [1.0, *y, 0.0, 0.0]).collect();
    let outputs = gpu::probe_vec4(
        &device,
        "probe_numeric",
        0,
        &[("inputs", bytemuck::cast_slice(&inputs))],
        2 * ys.len(),
    );
    for (y, pair) in ys.iter().zip(outputs.chunks_exact(2)) {
        let exact = -(-f64::from(*y)).ln_1p();
        assert!(
            gpu::relative_error(pair[0][2], exact) < 1e-5,
            "-ln(1-{y}): {} for {exact}",
            pair[0][2]
        );
    }
}

#[test]
fn finiteness_is_found_by_bits() {
    let device = gpu::device();
    let inputs = [
        [f32::INFINITY, 0.0, 0.0, 0.0],
        [f32::NEG_INFINITY, 0.0, 0.0, 0.0],
        [f32::NAN, 0.0, 0.0, 0.0],
        [f32::MAX, 0.0, 0.0, 0.0],
    ];
    let outputs = gpu::probe_vec4(
        &device,
        "probe_numeric",
        0,
        &[("inputs", bytemuck::cast_slice(&inputs))],
        8,
    );
    let finite: Vec<f32> = outputs.iter().step_by(2).map(|o| o[3]).collect();
    assert_eq!(finite, [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn safe_normalize_survives_zero_tiny_and_huge_vectors() {
    let device = gpu::device();
    let inputs = [
        [1.0_f32, 0.0, 0.0, 0.0],
        [1.0, 3e-25, 4e-25, 0.0],
        [1.0, 3e25, 0.0, -4e25],
    ];
    let outputs = gpu::probe_vec4(
        &device,
        "probe_numeric",
        0,
        &[("inputs", bytemuck::cast_slice(&inputs))],
        6,
    );
    let expected = [[0.0, 1.0, 0.0], [0.6, 0.8, 0.0], [0.6, 0.0, -0.8]];
    for (found, expected) in outputs.iter().skip(1).step_by(2).zip(expected) {
        for c in 0..3 {
            assert!(
                (found[c] - expected[c]).abs() < 1e-6,
                "{found:?} for {expected:?}"
            );
        }
    }
}

fn henyey_greenstein(cosine: f64, g: f64) -> f64 {
    let den = 1.0 + g * g - 2.0 * g * cosine;
    (1.0 - g * g) / (4.0 * std::f64::consts::PI * den.powf(1.5))
}

#[test]
fn henyey_greenstein_matches_f64_at_every_g_and_at_one_milliradian() {
    let device = gpu::device();
    let mut inputs: Vec<[f32; 4]> = Vec::new();
    let mut expected = Vec::new();
    for g in [
        -0.999_f32, -0.9, -0.5, 0.0, 1e-4, 0.5, 0.75, 0.9, 0.99, 0.999,
    ] {
        for angle in [
            0.0_f64,
            1e-3,
            0.01,
            0.1,
            1.0,
            2.0,
            3.0,
            std::f64::consts::PI - 1e-3,
        ] {
            let out = DVec3::new(angle.sin(), 0.0, angle.cos());
            let rounded = out.as_vec3();
            inputs.push([0.0, 0.0, 1.0, g]);
            inputs.push([rounded.x, rounded.y, rounded.z, 0.0]);
            expected.push(henyey_greenstein(angle.cos(), f64::from(g)));
        }
    }
    let bytes = probe::run(
        &device,
        probes::named("probe_phase"),
        0,
        &[("inputs", bytemuck::cast_slice(&inputs))],
        expected.len() as u64 * 4,
        4,
    )
    .unwrap();
    let found: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
    for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
        let g = inputs[2 * i][3];
        assert!(
            gpu::relative_error(*found, *expected) < 2e-4,
            "g {g}: {found} for {expected}"
        );
    }
}

#[test]
fn henyey_greenstein_integrates_to_one_with_mean_cosine_g() {
    let device = gpu::device();
    let count = 20_000;
    for g in [-0.9_f32, -0.3, 0.0, 0.6, 0.9] {
        let mut inputs: Vec<[f32; 4]> = Vec::new();
        let cosines: Vec<f64> = (0..count)
            .map(|i| -1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(count))
            .collect();
        for cosine in &cosines {
            let sine = (1.0 - cosine * cosine).sqrt();
            inputs.push([0.0, 0.0, 1.0, g]);
            inputs.push([sine as f32, 0.0, *cosine as f32, 0.0]);
        }
        let bytes = probe::run(
            &device,
            probes::named("probe_phase"),
            0,
            &[("inputs", bytemuck::cast_slice(&inputs))],
            u64::from(count as u32) * 4,
            (count as u32).div_ceil(64),
        )
        .unwrap();
        let values: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
        let weight = 2.0 * std::f64::consts::PI * 2.0 / f64::from(count);
        let total: f64 = values.iter().map(|p| f64::from(*p) * weight).sum();
        let mean: f64 = values
            .iter()
            .zip(&cosines)
            .map(|(p, c)| f64::from(*p) * c * weight)
            .sum();
        assert!((total - 1.0).abs() < 1e-4, "g {g}: {total}");
        assert!(
            (mean - f64::from(g)).abs() < 1e-4,
            "g {g}: mean cosine {mean}"
        );
    }
}
