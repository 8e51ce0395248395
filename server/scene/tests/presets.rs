//! The shop window: every preset is valid, small, framed, and survives its own JSON.

use glam::DVec3;
use tyndall_scene::{Light, MediumShape, SceneDescription, build, facts, presets};

#[test]
fn there_are_seven_presets_and_the_hall_comes_first() {
    let names: Vec<&str> = presets::names().iter().map(|preset| preset.name).collect();
    assert_eq!(
        names,
        [
            "fogged_hall",
            "light_shafts",
            "cornell_fog",
            "street_night",
            "swinging_lamp",
            "smoke_plume",
            "cloud"
        ]
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
            (0.1..20.0).contains(&facts.optical_thickness),
            "{}",
            preset.name
        );
    }
}

#[test]
fn every_camera_stands_in_fog_or_looks_at_it_and_sees_a_light() {
    for preset in presets::names() {
        let loaded = build(presets::description(preset.name).unwrap(), None).unwrap();
        let scene = &loaded.scene;
        let eye = scene.camera.position;
        let view = scene.camera.target - eye;
        let bounds = scene.media.iter().find_map(|medium| match medium.shape {
            MediumShape::Homogeneous { bounds } | MediumShape::HeightFog { bounds, .. } => bounds,
            _ => None,
        });
        if let Some(bounds) = bounds {
            let inside = eye.cmpge(bounds.min).all() && eye.cmple(bounds.max).all();
            assert!(inside || preset.name == "cornell_fog", "{}", preset.name);
        }
        for medium in &scene.media {
            if let MediumShape::Grid {
                grid,
                world_from_lattice,
            } = &medium.shape
            {
                // The middle of the picture shows the grid, and its highest point is in it.
                let middle = 0.5 * (grid.clip[0] + grid.clip[1]);
                let middle = world_from_lattice.transform_point3(middle);
                let half = 0.5 * f64::from(scene.camera.vertical_fov);
                assert!(
                    view.angle_between(middle - eye) < 0.3 * half,
                    "{}",
                    preset.name
                );
                let target = world_from_lattice
                    .inverse()
                    .transform_point3(scene.camera.target);
                let along = world_from_lattice
                    .inverse()
                    .transform_vector3(view / view.length());
                let most = (-20..=20).map(|i| grid.sample(target + f64::from(i) * 0.5 * along));
                assert!(most.fold(0.0, f64::max) > 0.1, "{}", preset.name);
                let top = grid.clip[1]
                    .with_x(0.5 * grid.clip[1].x)
                    .with_z(0.5 * grid.clip[1].z);
                let top = world_from_lattice.transform_point3(top);
                assert!(view.angle_between(top - eye) < half, "{}", preset.name);
            }
        }
        let ahead = |position: DVec3| (position - eye).dot(view) > 0.0;
        let sees = scene.lights.iter().any(|light| match light {
            Light::Point(light) => ahead(light.position),
            Light::Spot(light) => ahead(light.position),
            Light::Directional(_) => true,
        });
        assert!(sees, "{}", preset.name);
    }
}
