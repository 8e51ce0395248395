//! Reads any text as a scene's description, and outlines it where it is one.

#![no_main]

use libfuzzer_sys::fuzz_target;
use tyndall_scene::{Limits, SceneDescription, facts, outline};

fuzz_target!(|text: &str| {
    let limits = Limits {
        triangles: 100_000,
        vertices: 100_000,
        grid_bytes: 4 << 20,
        ..Limits::default()
    };
    if let Ok(description) = SceneDescription::from_json(text)
        && let Ok(outlined) = outline(description, &limits)
    {
        assert!(facts(&outlined.scene).optical_thickness.is_finite());
    }
});
