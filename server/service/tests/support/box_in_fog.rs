//! The scene that most conversations are about.

use serde_json::json;
use tyndall_scene::{Loaded, SceneDescription, build};

/// A box in fog that is finished after `samples` samples.
pub fn scene(samples: u32) -> Loaded {
    let text = json!({
        "version": 1,
        "name": "test",
        "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
        "geometry": [{"kind": "box", "min": [-1, -1, -1], "max": [1, 1, 1]}],
        "lights": [{"kind": "point", "position": [0, 3, 3], "intensity": 50}],
        "media": [{"kind": "homogeneous", "sigma_s": 0.05, "sigma_a": 0.01}],
        "render": {"width": 96, "height": 64, "samples": samples,
            "single_scattering": {"steps": 4, "jitter": true},
            "shadows": {"mode": "mapped", "resolution": 64}},
    });
    build(
        SceneDescription::from_json(&text.to_string()).unwrap(),
        None,
    )
    .unwrap()
}
