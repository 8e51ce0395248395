//! Hostile pictures.

use tyndall_tests::gpu;

#[test]
fn hostile_pictures_stay_finite() {
    for (width, height) in [(1, 1), (1, 7), (17, 5), (33, 64)] {
        for samples in [1, 5] {
            for (label, media) in [
                (
                    "thin",
                    serde_json::json!([{"kind": "homogeneous", "sigma_s": [1e-9, 1e-9, 1e-9], "sigma_a": [0.0, 0.0, 0.0]}]),
                ),
                (
                    "dense",
                    serde_json::json!([{"kind": "homogeneous", "sigma_s": [100.0, 10.0, 1e4], "sigma_a": [20.0, 5.0, 2e3], "g": 0.99}]),
                ),
                ("none", serde_json::json!([])),
            ] {
                for technique in ["single_scattering", "reference"] {
                    let scene = gpu::scene(&serde_json::json!({
                        "version": 1,
                        "camera": {"position": [0.0, 0.0, 3.0], "target": [0.0, 0.0, 0.0]},
                        "lights": [{"kind": "point", "position": [0.0, 0.1, 0.0], "intensity": [1e9, 1.0, 1e-9]}],
                        "media": media,
                        "render": {"technique": technique, "correction": "always", "width": width, "height": height, "samples": samples}
                    }));
                    let still = gpu::render(&mut gpu::renderer(), scene);
                    let finite = still.radiance.iter().flatten().all(|v| v.is_finite());
                    assert!(finite, "{label} {technique} {width}×{height} {samples}");
                }
            }
        }
    }
}
