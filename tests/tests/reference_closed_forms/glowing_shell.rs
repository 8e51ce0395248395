//! Fluence about a point source by reciprocity: what a shell that glows brings to its centre. It has no
//! rays that pass a point, whose variance no number of samples settles under forward scattering, so it
//! reaches far and forward where `point_source.rs` does not.
//!
//! The shell is a density grid that glows and extinguishes nothing, as thick as its profile: 1 at r,
//! falling to 0 at r ± half width. Its centre sees the same from everywhere.

use std::f64::consts::PI;

use serde_json::json;
use tyndall_tests::estimate::{self, Estimate, SIGMAS};
use tyndall_tests::gpu;
use tyndall_tests::grid_file::folder;

/// Voxels over half of the profile, and across the grid at least: near the source 1/r² must be resolved.
const FINENESS: f64 = 4.0;
const LEAST_SIDE: f64 = 96.0;
/// Pixels a side; each sees the whole of it.
const SIZE: u32 = 16;

/// 4πr²φ of a source of 1 W, all of its light, over the shell's profile.
fn fluence(r: f64, half_width: f64, albedo: f64, g: f64, samples: u32) -> Estimate {
    let reach = r + half_width;
    let side = (2.0 * reach * FINENESS / half_width).ceil().max(LEAST_SIDE) as usize;
    let voxel = 2.0 * reach / side as f64;
    let place = |i: usize| (i as f64 + 0.5) * voxel - reach;
    let distance = |i: usize| {
        let (x, y, z) = (
            place(i % side),
            place(i / side % side),
            place(i / side / side),
        );
        (x * x + y * y + z * z).sqrt()
    };
    let profile = |i: usize| (1.0 - (distance(i) - r).abs() / half_width).max(0.0);
    // Denser and dimmer: a walk meets a glowing grid as often as its density says.
    let density = 4.0 * reach / half_width;
    let grid = folder(&format!("shell-{r}-{albedo}-{g}"), side, |i| {
        (density * profile(i)) as f32
    });
    // Power of a profile that would bring its fluence undiminished: ∫ profile/(4πr²) dV.
    let undiminished: f64 = (0..side.pow(3))
        .map(|i| profile(i) / (4.0 * PI * distance(i).powi(2).max(1e-12)))
        .sum::<f64>()
        * voxel.powi(3);
    let scene = json!({
        "version": 1,
        "camera": { "position": [0, 0, 0], "target": [1, 2, 2], "vertical_fov_degrees": 90 },
        "media": [
            { "kind": "homogeneous", "sigma_t": 1, "albedo": albedo, "g": g },
            // An emission of ε W·m⁻³·sr⁻¹ is a source of 4πε W·m⁻³.
            { "kind": "grid", "path": "grid.npy", "sigma_s": 0, "sigma_a": 0,
              "emission": 1.0 / (4.0 * PI * density),
              "transform": { "scale": 2.0 * reach, "translation": [-reach, -reach, -reach] } },
        ],
        "render": { "technique": "reference", "width": SIZE, "height": SIZE, "samples": samples },
    });
    let description =
        tyndall_scene::SceneDescription::from_json(&scene.to_string()).expect("the scene parses");
    let built = tyndall_scene::build(description, Some(grid.path())).expect("the scene is valid");
    let still = estimate::with_renderer(|renderer| gpu::render(renderer, built.scene));
    assert_eq!(still.truncated, 0, "truncated paths");
    Estimate::of_equal_pixels(&still).scaled(4.0 * PI / undiminished)
}

/// Middle of a bin of 0.1, half width of the shell, samples, tabulated value.
type Bin = (f64, f64, u32, f64);

/// Holds a row of algorithms §7.5 to its own accuracy, what the shells' thickness and voxels may change,
/// and noise, which must itself be small.
fn holds(albedo: f64, g: f64, accuracy: f64, bins: &[Bin]) {
    for (r, half_width, samples, expected) in bins {
        let found = fluence(*r, *half_width, albedo, g, *samples);
        let name = format!("fluence albedo {albedo} g {g} r {r}");
        assert!(
            SIGMAS * found.error[1] < 0.05 * expected,
            "{name}: ± {:.1e} says little",
            found.error[1]
        );
        found.assert_near(&name, *expected, accuracy * expected);
    }
}

#[test]
fn isotropic_fluence_is_tabulated_out_to_ten_mean_free_paths() {
    let bins = [
        (0.05, 0.05, 128, 1.059),
        (0.95, 0.1, 128, 1.782),
        (1.95, 0.2, 256, 1.876),
        (4.95, 0.4, 1024, 0.932),
        (9.95, 0.5, 1536, 0.1347),
    ];
    holds(0.9, 0.0, 5e-3, &bins);
}

#[test]
fn forward_fluence_is_tabulated_out_to_ten_mean_free_paths() {
    let bins = [
        (0.05, 0.05, 512, 0.998),
        (0.95, 0.1, 512, 0.960),
        (1.95, 0.2, 512, 0.908),
        (4.95, 0.4, 512, 0.716),
        (9.95, 0.5, 512, 0.416),
    ];
    holds(0.9, 0.9, 5e-3, &bins);
}

#[test]
fn forward_fluence_of_a_bright_medium_is_tabulated_out_to_ten_mean_free_paths() {
    let bins = [
        (0.05, 0.05, 128, 1.008),
        (0.95, 0.1, 128, 1.069),
        (1.95, 0.2, 128, 1.166),
        (4.95, 0.4, 128, 1.42),
        (9.95, 0.5, 128, 1.79),
    ];
    holds(0.99, 0.9, 0.02, &bins);
}
