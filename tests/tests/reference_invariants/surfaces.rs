//! Surfaces and emitters against closed forms and against one another.

use std::f64::consts::PI;

use serde_json::{Value, json};
use tyndall_tests::estimate::{self, Estimate};

fn render(camera: &Value, geometry: &Value, sky: f64, samples: u32, seed: u32) -> Estimate {
    Estimate::of_pixels(&estimate::render(&json!({
        "version": 1, "camera": camera, "geometry": geometry,
        "lights": [{ "kind": "environment", "radiance": sky }],
        "render": { "technique": "reference", "width": 16, "height": 16, "samples": samples, "seed": seed },
    })))
}

fn floor(material: &Value) -> Value {
    json!({ "kind": "quad", "corner": [-500, 0, 500], "edge_u": [1000, 0, 0], "edge_v": [0, 0, -1000], "material": material })
}

/// Onto the origin, `degrees` off the vertical.
fn onto_the_floor(degrees: f64) -> Value {
    let (sine, cosine) = degrees.to_radians().sin_cos();
    json!({ "position": [2.0 * sine, 2.0 * cosine, 0], "target": [0, 0, 0], "up": [0, 0, 1], "vertical_fov_degrees": 0.1 })
}

#[test]
fn white_ideal_diffusers_vanish_under_a_white_sky() {
    let white = json!({ "base_color": 1 });
    let camera = json!({ "position": [1, 2, 3], "target": [0, 0, 0], "vertical_fov_degrees": 45 });
    let cube = json!([{ "kind": "box", "min": [-1, -1, -1], "max": [1, 1, 1], "material": white }]);
    render(&camera, &cube, 1.0, 16, 1).assert_near("white box", 1.0, 1e-5);
    render(&onto_the_floor(30.0), &json!([floor(&white)]), 1.0, 16, 2).assert_near(
        "white floor",
        1.0,
        1e-5,
    );
    // A ball of facets loses what its smooth normals send below them: 6e-4 of 960 triangles.
    let ball = json!([{ "kind": "sphere", "center": [0, 0, 0], "radius": 1, "material": white }]);
    let found = render(&camera, &ball, 1.0, 64, 3);
    found.assert_near("white ball", 0.9994, 6e-4);
}

#[test]
fn a_white_metal_never_reflects_more_than_it_receives() {
    for roughness in [0.0, 0.2, 0.5, 1.0] {
        for degrees in [0.0, 60.0, 85.0] {
            let material = json!({ "base_color": 1, "metallic": 1, "roughness": roughness });
            let found = render(
                &onto_the_floor(degrees),
                &json!([floor(&material)]),
                1.0,
                64,
                3,
            );
            let name = format!("metal roughness {roughness} at {degrees}");
            println!("{name}: {:.5} ± {:.1e}", found.mean[1], found.error[1]);
            assert!(
                found.mean[1] <= 1.0 + 1e-5 + 4.0 * found.error[1],
                "{name}: {}",
                found.mean[1]
            );
            // What bounces twice between facets is lost: much at roughness 1, nothing in a mirror.
            let least = if roughness < 0.1 { 0.999 } else { 0.25 };
            assert!(found.mean[1] > least, "{name}: {}", found.mean[1]);
        }
    }
    // Roughness 1 at normal incidence: ∫ μ/(1 + μ) dμ.
    let material = json!({ "base_color": 1, "metallic": 1, "roughness": 1 });
    let found = render(
        &onto_the_floor(0.0),
        &json!([floor(&material)]),
        1.0,
        256,
        4,
    );
    found.assert_near("metal, closed form", 1.0 - 2.0_f64.ln(), 1e-5);
}

/// Share of a parallel rectangle's radiance that reaches a point below its corner, as irradiance/π.
fn corner_form_factor(width: f64, length: f64, height: f64) -> f64 {
    let (a, b) = (width / height, length / height);
    let (p, q) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / p * (b / p).atan() + b / q * (a / q).atan()) / (2.0 * PI)
}

#[test]
fn an_emissive_quad_lights_a_floor_by_its_form_factor() {
    for (width, length, height) in [
        (1.0, 1.0, 1.0),
        (4.0, 0.5, 0.7),
        (30.0, 30.0, 0.5),
        (0.05, 0.05, 2.0),
    ] {
        // Faces down; its corner is above the point that the camera looks at from beside it.
        let light = json!({ "kind": "quad", "corner": [0, height, 0], "edge_u": [-width, 0, 0], "edge_v": [0, 0, -length],
            "material": { "base_color": 0, "emission": 5, "double_sided": false } });
        let camera = json!({ "position": [0.8 * height, 0.6 * height, 0], "target": [0, 0, 0], "up": [0, 0, 1], "vertical_fov_degrees": 0.1 });
        let geometry = json!([floor(&json!({ "base_color": 0.5 })), light]);
        let expected = 5.0 * 0.5 * corner_form_factor(width, length, height);
        let name = format!("form factor {width} {length} {height}");
        render(&camera, &geometry, 0.0, 64, 4).assert_near(&name, expected, 1e-4 * expected);
    }
}

#[test]
fn emitters_all_around_light_a_surface_as_a_sky_does() {
    // The sky is found by scattering alone, the walls by scattering and by choice.
    for (roughness, metallic) in [(0.0, 1.0), (0.1, 1.0), (0.3, 0.5), (0.7, 0.0), (1.0, 1.0)] {
        let material = json!({ "base_color": 0.8, "metallic": metallic, "roughness": roughness });
        let plate = json!({ "kind": "quad", "corner": [-0.5, 0, 0.5], "edge_u": [1, 0, 0], "edge_v": [0, 0, -1], "material": material });
        let walls = json!({ "kind": "box", "min": [-3, -1, -3], "max": [3, 2.5, 3], "material": { "base_color": 0, "emission": 1 } });
        let camera = onto_the_floor(50.0);
        let sky = render(&camera, &json!([plate]), 1.0, 256, 5);
        let room = render(&camera, &json!([plate, walls]), 0.0, 256, 6);
        sky.assert_equals(
            &format!("sky or walls, roughness {roughness} metallic {metallic}"),
            &room,
            &[(1, 1)],
        );
    }
}

#[test]
fn a_small_bright_emitter_and_a_point_light_agree_from_afar() {
    // Front of 1 cm² with radiance L: intensity L·A·cosine, here straight above a rough metal.
    let side = 0.01;
    let material = json!({ "base_color": 0.9, "metallic": 0.6, "roughness": 0.5 });
    let light = json!({ "kind": "quad", "corner": [-0.5 * side, 3, -0.5 * side], "edge_u": [side, 0, 0], "edge_v": [0, 0, side],
        "material": { "base_color": 0, "emission": 1e5, "double_sided": false } });
    let camera = onto_the_floor(40.0);
    let quad = render(&camera, &json!([floor(&material), light]), 0.0, 256, 7);
    let point = Estimate::of_pixels(&estimate::render(&json!({
        "version": 1, "camera": camera, "geometry": [floor(&material)],
        "lights": [{ "kind": "point", "position": [0, 3, 0], "intensity": 1e5 * side * side }],
        "render": { "technique": "reference", "width": 16, "height": 16, "samples": 16 },
    })));
    // Not quite a point: 1e-5 of the angle.
    quad.assert_near("small emitter", point.mean[1], 1e-4 * point.mean[1]);
}
