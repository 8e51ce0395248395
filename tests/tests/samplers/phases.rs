//! Phase functions: values, bounds and sampled directions against sums of lobes in f64.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use tyndall_render::probe;
use tyndall_scene::{PhaseFunction, PhaseParameters};
use tyndall_tests::chi_squared::{assert_fits, assert_uniform, bin};
use tyndall_tests::{gpu, probes};

use super::{AXIS, COUNT, DEVICE, Which, assert_density, direction, sample, turn, with};

/// Phase functions of every kind, extreme ones among them.
fn examples() -> Vec<PhaseFunction> {
    let lobes = [
        0.0, 1e-4, 0.5, -0.5, 0.75, 0.9, -0.9, 0.99, -0.99, 0.999, -0.999,
    ]
    .map(|g| PhaseFunction::HenyeyGreenstein { g });
    let pairs = [
        [0.8, -0.3, 0.7],
        [0.999, -0.999, 0.5],
        [0.99, 0.0, 0.01],
        [0.9, -0.9, 0.999],
        [0.5, 0.9, 0.0],
        [-0.5, 0.2, 1.0],
    ]
    .map(
        |[g_forward, g_backward, forward_share]| PhaseFunction::TwoLobes {
            g_forward,
            g_backward,
            forward_share,
        },
    );
    lobes.into_iter().chain(pairs).collect()
}

/// Share and mean cosine of each lobe of Henyey and Greenstein's that a phase function is the sum of.
fn lobes(phase: &PhaseFunction) -> Vec<(f64, f64)> {
    match *phase {
        PhaseFunction::HenyeyGreenstein { g } => vec![(1.0, f64::from(g))],
        PhaseFunction::TwoLobes {
            g_forward,
            g_backward,
            forward_share,
        } => {
            let share = f64::from(forward_share);
            vec![
                (share, f64::from(g_forward)),
                (1.0 - share, f64::from(g_backward)),
            ]
        }
    }
}

/// The textbook form. Unit: sr⁻¹.
fn value(phase: &PhaseFunction, cosine: f64) -> f64 {
    let lobe = |(share, g): &(f64, f64)| {
        let den = 1.0 + g * g - 2.0 * g * cosine;
        share * (1.0 - g * g) / (4.0 * PI * den.powf(1.5))
    };
    lobes(phase).iter().map(lobe).sum()
}

/// Probability of 1 − s·cosθ above `c` in a lobe, with s the sign of g: no difference of near values.
fn tail(c: f64, g: f64) -> f64 {
    let m = g.abs();
    let r = ((1.0 - m).powi(2) + 2.0 * m * c).sqrt();
    // (1 − m)(1 + cosθ)/(r(1 + m + r)), cosθ = 1 − c.
    (1.0 - m) * (2.0 - c) / (r * (1.0 + m + r))
}

/// Probabilities of a cosine below and above that of a direction `from_axis` = 1 − cosθ and `from_back` =
/// 1 + cosθ away from both ends.
fn below_and_above(phase: &PhaseFunction, from_axis: f64, from_back: f64) -> (f64, f64) {
    let (mut below, mut above) = (0.0, 0.0);
    for (share, g) in lobes(phase) {
        if g < 0.0 {
            let outside = tail(from_back, g);
            above += share * outside;
            below += share * (1.0 - outside);
        } else {
            let outside = tail(from_axis, g);
            below += share * outside;
            above += share * (1.0 - outside);
        }
    }
    (below.clamp(0.0, 1.0), above.clamp(0.0, 1.0))
}

/// Value and bound on the device for light along +Z into each direction.
fn on_device(phase: &PhaseFunction, directions: &[Vec3]) -> Vec<[f32; 2]> {
    let PhaseParameters { kind, parameters } = phase.parameters();
    let mut inputs: Vec<[f32; 4]> = Vec::new();
    for out in directions {
        inputs.push(with(Vec3::Z, kind as f32));
        inputs.push(with(*out, 0.0));
        inputs.push(with(parameters.into(), 0.0));
    }
    let count = directions.len() as u32;
    let bytes = probe::run(
        &DEVICE,
        probes::named("probe_phase"),
        0,
        &[("inputs", bytemuck::cast_slice(&inputs))],
        u64::from(count) * 8,
        count.div_ceil(64),
    )
    .expect("the probe runs");
    bytemuck::pod_collect_to_vec(&bytes)
}

#[test]
fn phase_values_match_f64_at_every_parameter_and_at_one_milliradian() {
    let angles = [0.0, 1e-3, 0.01, 0.1, 1.0, 2.0, 3.0, PI - 1e-3, PI];
    let directions = angles.map(|angle: f64| DVec3::new(angle.sin(), 0.0, angle.cos()).as_vec3());
    for phase in examples() {
        for ([found, _], angle) in on_device(&phase, &directions).into_iter().zip(angles) {
            let exact = value(&phase, angle.cos());
            assert!(
                gpu::relative_error(found, exact) < 2e-4,
                "{phase:?} at {angle}: {found} for {exact}"
            );
            assert!((phase.value(angle.cos()) / exact - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn phase_functions_integrate_to_one_with_their_mean_cosine() {
    let count = 40_000;
    let angles: Vec<f64> = (0..count)
        .map(|i| PI * (f64::from(i) + 0.5) / f64::from(count))
        .collect();
    let directions: Vec<Vec3> = angles
        .iter()
        .map(|angle| DVec3::new(angle.sin(), 0.0, angle.cos()).as_vec3())
        .collect();
    for phase in examples() {
        let (mut total, mut mean) = (0.0, 0.0);
        for ([found, _], angle) in on_device(&phase, &directions).into_iter().zip(&angles) {
            // Of a ring about the axis.
            let solid_angle = 2.0 * PI * angle.sin() * PI / f64::from(count);
            total += f64::from(found) * solid_angle;
            mean += f64::from(found) * solid_angle * angle.cos();
        }
        let exact: f64 = lobes(&phase).iter().map(|(share, g)| share * g).sum();
        // Directions in f32 lie up to 6e-8 off: up to 3e-4 of what a lobe of |g| = 0.999 sends there.
        let narrow = lobes(&phase).iter().any(|(_, g)| g.abs() > 0.9);
        let error = if narrow { 5e-4 } else { 1e-4 };
        assert!((total - 1.0).abs() < error, "{phase:?}: {total}");
        assert!(
            (mean - exact).abs() < error,
            "{phase:?}: mean cosine {mean}"
        );
        assert!((phase.mean_cosine() - exact).abs() < 1e-6, "{phase:?}");
    }
}

#[test]
fn no_value_of_a_phase_function_is_above_its_bound_and_the_peak_is_near_it() {
    let directions: Vec<Vec3> = (0..=256)
        .map(|i| f64::from(i) / 256.0 * PI)
        .map(|angle| DVec3::new(angle.sin(), 0.0, angle.cos()).as_vec3())
        .collect();
    for phase in examples() {
        let values = on_device(&phase, &directions);
        let bound = f64::from(values[0][1]) / (4.0 * PI);
        let most = values
            .iter()
            .fold(0.0_f64, |most, [p, _]| most.max((*p).into()));
        assert!(most <= bound * 1.0002, "{phase:?}: {most} above {bound}");
        assert!(bound <= 2.0 * most, "{phase:?}: {bound} far above {most}");
        assert!((phase.peak() / value(&phase, 1.0).max(value(&phase, -1.0)) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn sampled_directions_follow_the_phase_function_from_its_tips_to_its_tails() {
    for (seed, phase) in examples().into_iter().enumerate() {
        let PhaseParameters { kind, parameters } = phase.parameters();
        let inputs = [
            with(AXIS, kind as f32),
            with(parameters.into(), 0.0),
            [0.0; 4],
        ];
        let axis = AXIS.as_dvec3();
        let mut counts = vec![0; 512];
        // Bins of both tails: probabilities 1/2, 1/4, 1/8 and so on.
        let mut halvings = [vec![0; 13], vec![0; 13]];
        for [found, _] in sample(Which::Phase, 100 + seed as u32, inputs) {
            let v = direction(found);
            let from_axis = (0.5 * (v - axis).length_squared()).clamp(0.0, 2.0);
            let from_back = (0.5 * (v + axis).length_squared()).clamp(0.0, 2.0);
            let name = format!("{phase:?}");
            assert_density(&name, found[3], precise(&phase, from_axis, from_back), 2e-3);
            let (below, above) = below_and_above(&phase, from_axis, from_back);
            counts[32 * bin(below, 16) + bin(turn(axis, v), 32)] += 1;
            for (halvings, u) in halvings.iter_mut().zip([below, above]) {
                halvings[(-u.max(1e-30).log2()).floor().clamp(0.0, 12.0) as usize] += 1;
            }
        }
        assert_uniform(&format!("{phase:?}"), &counts);
        let share = |k: i32| 0.5_f64.powi(if k == 12 { 12 } else { k + 1 });
        let expected: Vec<f64> = (0..13).map(|k| share(k) * COUNT as f64).collect();
        for (end, halvings) in ["back", "front"].into_iter().zip(halvings) {
            assert_fits(&format!("{phase:?}, {end}"), &halvings, &expected);
        }
    }
}

/// The value at a direction that is `from_axis` = 1 − cosθ and `from_back` = 1 + cosθ away from both ends:
/// no difference of near values. Unit: sr⁻¹.
fn precise(phase: &PhaseFunction, from_axis: f64, from_back: f64) -> f64 {
    let lobe = |(share, g): &(f64, f64)| {
        let m = g.abs();
        let c = if *g < 0.0 { from_back } else { from_axis };
        let den = (1.0 - m) * (1.0 - m) + 2.0 * m * c;
        share * (1.0 - m * m) / (4.0 * PI * den * den.sqrt())
    };
    lobes(phase).iter().map(lobe).sum()
}
