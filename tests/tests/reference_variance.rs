//! The variance that the path tracer reports of a pixel against how pictures of different seeds
//! really scatter: a lamp, a wall, a metal block and fog.
//!
//! Of two samples a pixel each comes from its own scrambled sequence, so they are independent and the
//! report has the right expectation: both sides are held to 4 standard errors. Of more samples each
//! half is better spread than independent ones. Then the report may be too high, by how much depends
//! on the integrand, so only a report that is too low is a fault. Standard errors come from how the
//! differences vary from pixel to pixel, which counts heavy tails and overlooks nothing: pixels are
//! independent, and that their expectations differ only adds. A false alarm is 6e-5 a comparison (of
//! whole pictures; in blocks of 64 pixels, by Student's t, 2e-4), below 1 % for the file.

#![allow(clippy::print_stdout, reason = "tests print what they measure")]

use serde_json::{Value, json};
use tyndall_tests::estimate::{self, SIGMAS};

const WIDTH: usize = 32;
const HEIGHT: usize = 24;
const SEEDS: u32 = 48;
/// Side of a block. Unit: pixel.
const BLOCK: usize = 8;

/// The lamp is out of the picture: pixels on its edge would outweigh all others.
fn scene(samples: u32, seed: u32) -> Value {
    json!({
        "version": 1,
        "camera": { "position": [0, 1.2, 4], "target": [0, 0.7, 0], "vertical_fov_degrees": 28 },
        "geometry": [
            { "kind": "quad", "corner": [-2, 0, 2], "edge_u": [4, 0, 0], "edge_v": [0, 0, -4] },
            { "kind": "quad", "corner": [-2, 0, -2], "edge_u": [4, 0, 0], "edge_v": [0, 3, 0],
              "material": { "base_color": [0.7, 0.5, 0.3] } },
            { "kind": "box", "min": [-0.9, 0, -0.6], "max": [-0.1, 1, 0.2],
              "material": { "base_color": [0.9, 0.8, 0.6], "metallic": 1, "roughness": 0.6 } },
            { "kind": "quad", "corner": [-0.4, 2.4, -0.4], "edge_u": [0.8, 0, 0], "edge_v": [0, 0, 0.8],
              "material": { "base_color": 0, "emission": [9, 8, 6], "double_sided": false } },
        ],
        "media": [{ "kind": "homogeneous", "sigma_t": 0.3, "albedo": 0.8, "g": 0.3,
            "bounds": { "min": [-2, 0, -2], "max": [2, 3, 2] } }],
        "render": { "technique": "reference", "width": WIDTH, "height": HEIGHT, "samples": samples, "seed": seed },
    })
}

/// Variance of a pixel's mean in one channel: as it scatters between seeds, and as reported, mean
/// over the seeds.
#[derive(Clone, Copy, Default)]
struct Variances {
    real: f64,
    reported: f64,
}

/// Of all pixels of the green channel.
fn measure(samples: u32) -> Vec<Variances> {
    let n = f64::from(SEEDS);
    let mut sums = vec![[0.0_f64; 3]; WIDTH * HEIGHT];
    for seed in 0..SEEDS {
        let still = estimate::render(&scene(samples, seed));
        let variance = still.variance.as_ref().expect("the reference knows it");
        for ((sum, value), variance) in sums.iter_mut().zip(&still.radiance).zip(variance) {
            let value = f64::from(value[1]);
            *sum = [
                sum[0] + value,
                sum[1] + value * value,
                sum[2] + f64::from(variance[1]),
            ];
        }
    }
    let variances = |[values, squares, reported]: [f64; 3]| Variances {
        real: ((squares - values * values / n) / (n - 1.0)).max(0.0),
        reported: reported / n,
    };
    sums.into_iter().map(variances).collect()
}

/// How far real variances lie above the reported ones.
struct Excess {
    /// Of the sums: real over reported.
    ratio: f64,
    /// Of the mean difference, in standard errors.
    sigmas: f64,
}

fn excess(pixels: &[Variances]) -> Excess {
    let n = pixels.len() as f64;
    let real: f64 = pixels.iter().map(|p| p.real).sum();
    let reported: f64 = pixels.iter().map(|p| p.reported).sum();
    let mean = (real - reported) / n;
    let squares = pixels
        .iter()
        .map(|p| (p.real - p.reported - mean).powi(2))
        .sum::<f64>();
    Excess {
        ratio: real / reported,
        sigmas: mean / (squares / (n * (n - 1.0))).sqrt().max(1e-30),
    }
}

fn blocks(pixels: &[Variances]) -> Vec<Vec<Variances>> {
    let mut blocks = vec![Vec::new(); (WIDTH / BLOCK) * (HEIGHT / BLOCK)];
    for (i, pixel) in pixels.iter().enumerate() {
        let (x, y) = (i % WIDTH / BLOCK, i / WIDTH / BLOCK);
        blocks[y * (WIDTH / BLOCK) + x].push(*pixel);
    }
    blocks
}

#[test]
fn two_independent_samples_report_the_variance_of_their_mean() {
    let found = excess(&measure(2));
    println!(
        "2 samples: real over reported {:.4} ({:+.2} sigma)",
        found.ratio, found.sigmas
    );
    assert!(
        found.sigmas.abs() < SIGMAS,
        "{} ({} sigma)",
        found.ratio,
        found.sigmas
    );
}

#[test]
fn no_more_scatter_than_reported_where_samples_are_spread() {
    for samples in [16, 64] {
        let pixels = measure(samples);
        let whole = excess(&pixels);
        println!(
            "{samples} samples: real over reported {:.4} ({:+.2} sigma)",
            whole.ratio, whole.sigmas
        );
        assert!(
            whole.sigmas < SIGMAS,
            "{samples} samples: {} ({} sigma)",
            whole.ratio,
            whole.sigmas
        );
        for (i, block) in blocks(&pixels).iter().enumerate() {
            let found = excess(block);
            println!(
                "  block {i}: {:.3} ({:+.2} sigma)",
                found.ratio, found.sigmas
            );
            assert!(
                found.sigmas < SIGMAS,
                "{samples} samples, block {i}: {} ({} sigma)",
                found.ratio,
                found.sigmas
            );
        }
    }
}
