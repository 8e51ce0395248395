//! The shop window: every preset is valid, small, framed, and survives its own JSON.

use glam::DVec3;
use tyndall_scene::{Light, MediumShape, SceneDescription, build, facts, presets};

#[test]
fn there_are_four_presets_and_the_hall_comes_first() {
    let names: Vec<&str> = presets::names().iter().map(|preset| preset.name).collect();
    assert_eq!(
        names,
        ["fogged_hall", "light_shafts", "cornell_fog", "street_night"]
    );
    assert_eq!(presets::DEFAULT, names[0]);
    assert!(presets::description("nothing").is_none());
}

#[test]
fn every_preset_builds_without_warnings_and_round_trips() {
    for preset in presets::names() {
        let description = presets::description(preset.name).unwrap();
        let text = description.to_json().unwrap();
        let again = SceneDescription::from_json(&text).unwrap();
        assert_eq!(again, description, "{}", preset.name);
        let loaded = build(description, None).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let facts = facts(&loaded.scene);
        let compact = serde_json::to_string(&again).unwrap().len();
        println!("{}: {compact} bytes of JSON, {facts:?}", preset.name);
        assert!(facts.triangles <= 3000, "{}", preset.name);
        assert!(facts.scatters, "{}", preset.name);
        assert!(
            (0.1..10.0).contains(&facts.optical_thickness),
            "{}",
            preset.name
        );
    }
}

#[test]
fn every_camera_stands_in_fog_and_sees_a_light() {
    for preset in presets::names() {
        let loaded = build(presets::description(preset.name).unwrap(), None).unwrap();
        let scene = &loaded.scene;
        let bounds = scene.media.iter().find_map(|medium| match medium.shape {
            MediumShape::Homogeneous { bounds } | MediumShape::HeightFog { bounds, .. } => bounds,
            _ => None,
        });
        let bounds = bounds.unwrap();
        let eye = scene.camera.position;
        let inside = eye.cmpge(bounds.min).all() && eye.cmple(bounds.max).all();
        assert!(inside || preset.name == "cornell_fog", "{}", preset.name);
        let view = scene.camera.target - eye;
        let ahead = |position: DVec3| (position - eye).dot(view) > 0.0;
        let sees = scene.lights.iter().any(|light| match light {
            Light::Point(light) => ahead(light.position),
            Light::Spot(light) => ahead(light.position),
            Light::Directional(_) => true,
        });
        assert!(sees, "{}", preset.name);
    }
}
