//! The formulas of the spread on a device against f64, and at their limits.

use tyndall_tests::gpu;

/// W²/D² by Premože's formula and by the exact moments, of `(τ_κ, τ₂, τ_s, τ_a)`.
fn on_device(inputs: &[[f32; 4]]) -> Vec<[f32; 4]> {
    let device = gpu::device();
    let bytes = bytemuck::cast_slice(inputs);
    gpu::probe_vec4(
        &device,
        "probe_spread",
        0,
        &[("inputs", bytes)],
        inputs.len(),
    )
}

fn em1(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x }
}

/// ⟨x²⟩/D² (Lewis 1950), in f64 by enough terms of its series or directly.
fn lewis(x: f64, y: f64) -> f64 {
    if x.max(y) < 3.0 {
        let (mut power, mut complete, mut factor, mut sum) = (1.0, 1.0, 1.0 / 6.0, 1.0 / 6.0);
        for n in 1..40 {
            power *= x;
            complete = power + y * complete;
            factor /= -f64::from(n + 3);
            sum += factor * complete;
        }
        return sum * y * 2.0 / 3.0;
    }
    let slope = if (y - x).abs() < 1e-5 * x {
        (em1(x) - (-x).exp()) / x
    } else {
        (em1(x) - em1(y)) / (y - x)
    };
    2.0 / 3.0 * ((1.0 - em1(x)) / x - slope)
}

#[test]
fn spreads_match_f64_from_no_depth_at_all_to_opaque_media() {
    let mut inputs = Vec::new();
    for scattering in [1e-9, 1e-4, 0.03, 0.5, 0.99, 1.01, 5.0, 300.0, 1e6] {
        for g in [-0.9_f64, -0.3, 0.0, 1e-4, 0.01, 0.5, 0.9, 0.999] {
            for absorption in [0.0, 1e-3, 2.0, 1e4] {
                let turning = scattering * (1.0 - g);
                let second = scattering * (1.0 - g * g);
                inputs.push([turning, second, scattering, absorption].map(|v| v as f32));
            }
        }
    }
    let found = on_device(&inputs);
    for (input, found) in inputs.iter().zip(&found) {
        let [x, y, s, a] = input.map(f64::from);
        let premoze = x / (8.0 + 4.0 / 3.0 * a * x);
        // Not beyond where it is widest.
        let below = 1.0 - (2.0 * (1.0 - x / s)).clamp(0.0, 1.0);
        let kept = ((1.9 * (1.0 - below * below)).max(1e-4) / x).min(1.0);
        let own = lewis(kept * x, kept * y) / -(-kept * s).exp_m1();
        let exact = own / (1.0 + own * a * 4.0 / 3.0);
        assert!(
            gpu::relative_error(found[0], premoze) < 1e-5,
            "{input:?}: {found:?}"
        );
        assert!(
            gpu::relative_error(found[1], exact) < 2e-4,
            "{input:?}: {} for {exact}",
            found[1]
        );
    }
}

#[test]
fn spreads_are_finite_at_every_limit_and_grow_with_depth() {
    let limits = [
        [0.0, 0.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 1e9, 1e9],
        [2e9, 2e9, 1e9, 0.0],
        [1e-30, 1e-30, 1e-30, 1e-30],
        [1e-38, 2e-38, 1e-38, 0.0],
    ];
    for (input, found) in limits.iter().zip(on_device(&limits)) {
        let fine = found[..2].iter().all(|v| v.is_finite() && *v >= 0.0);
        assert!(fine, "{input:?}: {found:?}");
    }
    let rising: Vec<[f32; 4]> = (0..400)
        .map(|i| {
            let depth = 1e-6_f32 * 1.08_f32.powi(i);
            [depth * 0.6, depth * 0.84, depth, 0.0]
        })
        .collect();
    for pair in on_device(&rising).windows(2) {
        let grows = |c: usize| pair[1][c] >= pair[0][c] * (1.0 - 2e-5);
        assert!(grows(0) && grows(1), "{pair:?}");
    }
}
