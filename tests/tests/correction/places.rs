//! Traced samples and the technique's lie at the same places in their pixels.

use serde_json::json;
use tyndall_tests::gpu;

/// What both see of the edges of a bright surface cancels, at any number of samples.
#[test]
fn edges_cancel_in_the_residual() {
    for samples in [1, 2, 4, 7] {
        let scene = gpu::scene(&json!({
            "version": 1,
            "camera": { "position": [0, 0, 0], "target": [0, 0, -1], "vertical_fov_degrees": 40 },
            "geometry": [{ "kind": "quad", "corner": [-1, -0.7, -4], "edge_u": [2, 0.3, 0],
                "edge_v": [-0.2, 1.4, 0], "material": { "base_color": 0, "emission": [100, 100, 100] } }],
            "lights": [{ "kind": "point", "position": [0, 2, -4], "intensity": 0.1 }],
            "media": [{ "kind": "homogeneous", "sigma_t": 1e-4, "albedo": 0.5 }],
            "render": { "width": 48, "height": 36, "samples": samples,
                "technique": "single_scattering", "correction": "always" },
        }));
        let still = gpu::render(&mut gpu::renderer(), scene);
        let traced = still.traced.expect("samples were traced");
        let base = still.base.expect("the technique has a picture");
        let partly = base.iter().filter(|p| p[0] > 5.0 && p[0] < 95.0).count();
        assert!(samples == 1 || partly > 10, "{partly} pixels of the edge");
        let apart = traced
            .iter()
            .zip(&base)
            .map(|(a, b)| (a[0] - b[0]).abs())
            .fold(0.0, f32::max);
        println!("{samples} samples: at most {apart} apart");
        assert!(apart < 1.0, "{samples} samples: {apart}");
    }
}
