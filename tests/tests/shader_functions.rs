//! Shader functions on a device against f64 oracles.

use tyndall_tests::gpu;

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
