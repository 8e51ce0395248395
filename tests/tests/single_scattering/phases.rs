//! A phase function of two lobes against plain lobes: light that is scattered once is linear in it.

use serde_json::{Value, json};
use tyndall_render::Still;
use tyndall_tests::estimate::{self, Estimate};
use tyndall_tests::gpu;

const G_FORWARD: f64 = 0.8;
const G_BACKWARD: f64 = -0.3;
const FORWARD_SHARE: f64 = 0.7;

/// Media that leave the phase function open: fog, a ball, and a cloud if asked for.
fn media(phase: &Value, cloud: bool) -> Value {
    let mut media = vec![
        json!({ "kind": "height_fog", "sigma_t": [0.1, 0.2, 0.15], "albedo": 0.9, "falloff": 0.2, "phase": phase }),
        // Its own phase function stays plain.
        json!({ "kind": "sphere", "sigma_t": 0.5, "albedo": 0.8, "g": 0.4, "center": [0.5, 1, 0], "radius": 0.7 }),
    ];
    if cloud {
        media.push(json!({ "kind": "procedural", "pattern": "cloud", "resolution": 16, "sigma_t": 3, "albedo": 0.8,
            "phase": phase, "transform": { "scale": 2, "translation": [-0.5, 0.2, 0] } }));
    }
    json!(media)
}

fn plain(g: f64) -> Value {
    json!({ "kind": "henyey_greenstein", "g": g })
}

fn two_lobes(g_forward: f64, g_backward: f64, forward_share: f64) -> Value {
    json!({ "kind": "two_lobes", "g_forward": g_forward, "g_backward": g_backward, "forward_share": forward_share })
}

/// A block on a floor under these lights.
fn scene(media: &Value, lights: &Value, render: &Value) -> Value {
    json!({
        "version": 1,
        "camera": { "position": [0, 1.5, 5], "target": [0, 1, 0] },
        "geometry": [
            { "kind": "box", "min": [-1.5, 0, -1], "max": [-0.5, 1.2, 0], "material": { "base_color": 0.5 } },
            { "kind": "quad", "corner": [-4, 0, 4], "edge_u": [8, 0, 0], "edge_v": [0, 0, -8] },
        ],
        "lights": lights, "media": media, "render": render,
    })
}

fn lamps() -> Value {
    json!([
        { "kind": "point", "position": [0, 3, 0], "intensity": 10 },
        { "kind": "spot", "position": [2, 3, 1], "direction": [-1, -2, 0], "intensity": [10, 20, 30], "outer_angle_degrees": 30 },
        { "kind": "directional", "direction": [0.3, -1, -0.2], "irradiance": 1 },
    ])
}

fn marched(phase: &Value, cloud: bool, lights: &Value, samples: u32) -> Still {
    let render = json!({ "width": 48, "height": 32, "samples": samples,
        "single_scattering": { "steps": 16, "interleave": 1 } });
    estimate::render(&scene(&media(phase, cloud), lights, &render))
}

/// Largest difference of any channel of any pixel from `expected`, over the picture's mean.
fn farthest(still: &Still, expected: impl Fn(usize, usize) -> f64) -> f64 {
    let mean = gpu::mean_rgb(still).iter().sum::<f64>() / 3.0;
    let mut farthest = 0.0_f64;
    for (i, pixel) in still.radiance.iter().enumerate() {
        for (c, channel) in pixel.iter().take(3).enumerate() {
            farthest = farthest.max((f64::from(*channel) - expected(i, c)).abs() / mean);
        }
    }
    farthest
}

#[test]
fn two_lobes_of_one_mean_cosine_are_the_plain_lobe() {
    for cloud in [false, true] {
        let plain = marched(&plain(0.6), cloud, &lamps(), 2);
        let both = marched(&two_lobes(0.6, 0.6, 0.3), cloud, &lamps(), 2);
        let farthest = farthest(&both, |i, c| plain.radiance[i][c].into());
        println!("cloud {cloud}: {farthest:.1e}");
        assert!(farthest < 3e-5, "cloud {cloud}: {farthest}");
    }
}

#[test]
fn a_march_through_two_lobes_is_the_weighted_sum_of_marches_through_each() {
    for cloud in [false, true] {
        let [forward, backward] =
            [G_FORWARD, G_BACKWARD].map(|g| marched(&plain(g), cloud, &lamps(), 2));
        let phase = two_lobes(G_FORWARD, G_BACKWARD, FORWARD_SHARE);
        let both = marched(&phase, cloud, &lamps(), 2);
        let sum = |i: usize, c: usize| {
            FORWARD_SHARE * f64::from(forward.radiance[i][c])
                + (1.0 - FORWARD_SHARE) * f64::from(backward.radiance[i][c])
        };
        let apart = farthest(&forward, |i, c| backward.radiance[i][c].into());
        let farthest = farthest(&both, sum);
        println!("cloud {cloud}: {farthest:.1e}, the lobes alone {apart:.1e} apart");
        assert!(farthest < 3e-5, "cloud {cloud}: {farthest}");
        assert!(apart > 0.05, "the lobes make no difference");
    }
}

// Fog and cloud are tests of their own: each builds kernels for a minute or two where none are kept.

#[test]
fn light_of_a_sky_scattered_by_two_lobes_of_fog_is_the_weighted_sum_of_each() {
    light_of_a_sky(false);
}

#[test]
fn light_of_a_sky_scattered_by_two_lobes_of_a_cloud_is_the_weighted_sum_of_each() {
    light_of_a_sky(true);
}

fn light_of_a_sky(cloud: bool) {
    let sky = json!([{ "kind": "environment", "radiance": [1, 0.5, 0.2] }]);
    let mean = |phase: &Value| gpu::mean_rgb(&marched(phase, cloud, &sky, 16))[1];
    let forward = mean(&plain(G_FORWARD));
    let backward = mean(&plain(G_BACKWARD));
    let both = mean(&two_lobes(G_FORWARD, G_BACKWARD, FORWARD_SHARE));
    let sum = FORWARD_SHARE * forward + (1.0 - FORWARD_SHARE) * backward;
    println!("cloud {cloud}: {both:.5} for {sum:.5} of {forward:.5} and {backward:.5}");
    assert!((both / sum - 1.0).abs() < 0.01, "{both} for {sum}");
}

#[test]
fn paths_through_two_lobes_of_fog_bring_once_scattered_the_weighted_sum_of_each() {
    paths(false);
}

#[test]
fn paths_through_two_lobes_of_a_cloud_bring_once_scattered_the_weighted_sum_of_each() {
    paths(true);
}

fn paths(cloud: bool) {
    let estimate = |phase: &Value, seed: u32| {
        let render = json!({ "technique": "reference", "width": 24, "height": 16, "samples": 64, "seed": seed,
            "reference": { "max_scatterings": 1 } });
        let still = estimate::render(&scene(&media(phase, cloud), &lamps(), &render));
        Estimate::of_pixels(&still)
    };
    let forward = estimate(&plain(G_FORWARD), 1).scaled(FORWARD_SHARE);
    let backward = estimate(&plain(G_BACKWARD), 2).scaled(1.0 - FORWARD_SHARE);
    let both = estimate(&two_lobes(G_FORWARD, G_BACKWARD, FORWARD_SHARE), 3);
    let name = format!("paths, cloud {cloud}");
    both.assert_equals(&name, &forward.plus(backward), &[(0, 0), (1, 1), (2, 2)]);
}
