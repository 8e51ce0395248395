//! Reflectance and transmittance of slabs and half-spaces.

use serde_json::{Value, json};
use tyndall_tests::estimate::{self, Estimate};

/// Half the slab's width: what leaves it sideways has met an optical depth of hundreds.
const HALF_WIDTH: f64 = 2000.0;

/// A slab of unit thickness, y from 0 to 1, over a black ground at `ground`, under a uniform sky.
fn slab(
    tau: f64,
    albedo: f64,
    g: f64,
    ground: f64,
    camera: &Value,
    (samples, seed): (u32, usize),
) -> Value {
    let w = HALF_WIDTH;
    json!({
        "version": 1,
        "camera": camera,
        "geometry": [{ "kind": "quad", "corner": [-2.0 * w, ground, 2.0 * w],
            "edge_u": [4.0 * w, 0, 0], "edge_v": [0, 0, -4.0 * w], "material": { "base_color": 0 } }],
        "lights": [{ "kind": "environment", "radiance": 1 }],
        "media": [{ "kind": "homogeneous", "sigma_t": tau, "albedo": albedo, "g": g,
            "bounds": { "min": [-w, 0, -w], "max": [w, 1, w] } }],
        "render": { "technique": "reference", "width": 32, "height": 32, "samples": samples,
            "seed": seed },
    })
}

fn looking(from: [f64; 3], to: [f64; 3]) -> Value {
    json!({ "position": from, "target": to, "up": [0, 0, -1], "vertical_fov_degrees": 0.1 })
}

fn reflectance(tau: f64, albedo: f64, g: f64, paths: (u32, usize)) -> Estimate {
    let camera = looking([0.0, 1.5, 0.0], [0.0, 0.0, 0.0]);
    let still = estimate::render(&slab(tau, albedo, g, -1e-3, &camera, paths));
    Estimate::of_equal_pixels(&still)
}

fn transmittance(tau: f64, albedo: f64, g: f64, paths: (u32, usize)) -> Estimate {
    let camera = looking([0.0, -0.5, 0.0], [0.0, 1.0, 0.0]);
    let still = estimate::render(&slab(tau, albedo, g, -1.0, &camera, paths));
    Estimate::of_equal_pixels(&still)
}

/// (g, albedo) and, for optical depths 1, 4, 16, reflectance and transmittance.
type Row = ((f64, f64), [(f64, f64); 3]);

/// Normal collimated incidence, by adding and doubling.
const TABLE: [Row; 7] = [
    (
        (0.0, 1.0),
        [(0.34133, 0.65867), (0.69093, 0.30907), (0.90363, 0.09637)],
    ),
    (
        (0.0, 0.9),
        [(0.26741, 0.59163), (0.40814, 0.12852), (0.41495, 0.00024)],
    ),
    (
        (0.5, 1.0),
        [(0.17611, 0.82388), (0.50897, 0.49103), (0.82098, 0.17902)],
    ),
    (
        (0.75, 0.9),
        [(0.05595, 0.82792), (0.14157, 0.39732), (0.16549, 0.01313)],
    ),
    (
        (0.9, 1.0),
        [(0.02609, 0.97391), (0.12211, 0.87789), (0.44055, 0.55945)],
    ),
    (
        (0.9, 0.9),
        [(0.01819, 0.87788), (0.05044, 0.55072), (0.06841, 0.05413)],
    ),
    (
        (0.9, 0.5),
        [(0.00496, 0.59072), (0.00643, 0.11109), (0.00646, 0.00008)],
    ),
];

#[test]
fn slabs_reflect_and_transmit_what_adding_and_doubling_says() {
    let mut seed = 0;
    for ((g, albedo), row) in TABLE {
        for (tau, (reflected, transmitted)) in [1.0, 4.0, 16.0].into_iter().zip(row) {
            let name = format!("g {g} albedo {albedo} tau {tau}");
            seed += 2;
            // The tables' last digit.
            reflectance(tau, albedo, g, (64, seed)).assert_near(
                &format!("R {name}"),
                reflected,
                1e-5,
            );
            transmittance(tau, albedo, g, (64, seed + 1)).assert_near(
                &format!("T {name}"),
                transmitted,
                1e-5,
            );
        }
    }
}

#[test]
fn slabs_reflect_diffuse_light_as_tabulated() {
    // A small white ideal diffuser above the slab and facing it, seen from between them, averages the
    // slab's radiance by cosine. It hides 1e-6 of the sky.
    for (seed, (g, albedo, tau, expected)) in [
        (0.0, 1.0, 1.0, 0.44659),
        (0.0, 0.9, 1.0, 0.35271),
        (0.5, 1.0, 1.0, 0.30133),
        (0.9, 1.0, 4.0, 0.26577),
    ]
    .into_iter()
    .enumerate()
    {
        let camera = looking([0.0, 1.9, 0.0], [0.0, 2.0, 0.0]);
        let mut scene = slab(tau, albedo, g, -1e-3, &camera, (64, 100 + seed));
        let patch = json!({ "kind": "quad", "corner": [-5e-4, 2, -5e-4], "edge_u": [1e-3, 0, 0],
            "edge_v": [0, 0, 1e-3], "material": { "base_color": 1 } });
        scene["geometry"]
            .as_array_mut()
            .expect("a list")
            .push(patch);
        let found = Estimate::of_equal_pixels(&estimate::render(&scene));
        let name = format!("d g {g} albedo {albedo} tau {tau}");
        found.assert_near(&name, expected, 2e-5);
    }
}

#[test]
fn a_half_space_has_the_plane_albedo_of_its_h_function() {
    // 1 − H(μ)·√(1 − albedo), isotropic.
    for (seed, (albedo, cosine, h)) in [
        (0.5, 1.0, 1.251_260),
        (0.9, 1.0, 1.850_099),
        (0.99, 1.0, 2.472_793),
        (0.5, 0.5, 1.187_735),
        (0.9, 0.5, 1.556_034),
        (0.9, 0.1, 1.172_143),
    ]
    .into_iter()
    .enumerate()
    {
        let cosine: f64 = cosine;
        let across = (1.0 - cosine * cosine).sqrt();
        let camera = looking([0.0, 1.1, 0.0], [across, 1.1 - cosine, 0.0]);
        // Optical depth 300: nothing comes back from below.
        let scene = slab(300.0, albedo, 0.0, -1e-3, &camera, (64, 200 + seed));
        let found = Estimate::of_equal_pixels(&estimate::render(&scene));
        let expected = 1.0 - h * f64::sqrt(1.0 - albedo);
        found.assert_near(
            &format!("half-space albedo {albedo} mu {cosine}"),
            expected,
            1e-5,
        );
    }
}
