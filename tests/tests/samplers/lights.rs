//! What a ray looks at: emissive triangles by power, directions of an environment map.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use glam::DVec3;
use serde_json::{Value, json};
use tyndall_render::probe;
use tyndall_scene::EnvironmentMap;
use tyndall_tests::chi_squared::{assert_fits, bin};
use tyndall_tests::{gpu, probes};

use super::{COUNT, DEVICE, assert_density, direction};

fn pairs(
    name: &str,
    emitters: u32,
    buffers: &[(&'static str, &[u8])],
    count: usize,
) -> Vec<[[f32; 4]; 2]> {
    let counts = probe::Counts { media: 0, emitters };
    let workgroups = (count as u32).div_ceil(64);
    let bytes = probe::run_for(
        &DEVICE,
        probes::named(name),
        counts,
        buffers,
        count as u64 * 32,
        workgroups,
    );
    bytemuck::pod_collect_to_vec(&bytes.expect("the probe runs"))
}

/// An emissive triangle in the plane x = `plane`, and what the test knows of it.
struct Lamp {
    plane: f64,
    /// Second and third corner from the first, (y, z). Unit: m.
    edges: [[f64; 2]; 2],
    emission: [f64; 3],
    double_sided: bool,
}

impl Lamp {
    fn area(&self) -> f64 {
        let [[a, b], [c, d]] = self.edges;
        0.5 * (a * d - b * c).abs()
    }

    /// Luminance over area and sides: what the choice follows.
    fn power(&self) -> f64 {
        let [r, g, b] = self.emission;
        let sides = if self.double_sided { 2.0 } else { 1.0 };
        sides * self.area() * (0.2126 * r + 0.7152 * g + 0.0722 * b)
    }

    fn json(&self) -> Value {
        let [[a, b], [c, d]] = self.edges;
        let x = self.plane;
        json!({ "kind": "mesh",
            "positions": [[x, 1.0, -2.0], [x, 1.0 + a, -2.0 + b], [x, 1.0 + c, -2.0 + d]], "indices": [[0, 1, 2]],
            "material": { "emission": self.emission, "double_sided": self.double_sided } })
    }

    /// Weights of the second and the third corner.
    fn weights(&self, position: DVec3) -> [f64; 2] {
        let [[a, b], [c, d]] = self.edges;
        let (y, z) = (position.y - 1.0, position.z + 2.0);
        let determinant = a * d - b * c;
        [(y * d - z * c) / determinant, (a * z - b * y) / determinant]
    }
}

/// Seven, with areas and powers of several orders of magnitude, one of them dark.
fn lamps() -> Vec<Lamp> {
    let sizes = [0.01, 3.0, 0.4, 1.0, 0.1, 2.0, 0.7];
    (0..7)
        .map(|i| Lamp {
            plane: f64::from(i) - 3.0,
            edges: [
                [sizes[i as usize], 0.3],
                [-0.2, sizes[6 - i as usize] + 0.2],
            ],
            emission: [
                [40.0, 20.0, 1.0],
                [0.1, 0.2, 0.3],
                // Shines not at all: never chosen.
                [0.0; 3],
                [1.0, 1.0, 1.0],
                // Blue alone counts for little, yet counts.
                [0.0, 0.0, 5.0],
                [0.3, 0.0, 0.0],
                [2.0, 2.0, 1.0],
            ][i as usize],
            double_sided: i % 2 == 0,
        })
        .collect()
}

#[test]
fn emissive_triangles_are_chosen_by_power_and_evenly_over_their_area() {
    let lamps = lamps();
    // What does not shine stands among them.
    let mut geometry: Vec<Value> = lamps.iter().map(Lamp::json).collect();
    geometry.insert(
        2,
        json!({ "kind": "box", "min": [5, 0, 0], "max": [6, 1, 1] }),
    );
    let scene = gpu::scene(&json!({ "version": 1,
        "camera": { "position": [0, 0, 0], "target": [0, 0, -1] }, "geometry": geometry }));
    let known = probe::emitter_bytes(&scene).unwrap();
    assert_eq!(known.emitters.len(), 6);
    let frame = [probe::frame_values(&scene, (64, 64), [0.5; 2])];
    let inputs = [[70.0_f32, 0.0, 0.0, 0.0]];
    let buffers: [(&'static str, &[u8]); 6] = [
        ("frame", bytemuck::cast_slice(&frame)),
        ("bvh_vertices", &known.vertices),
        ("triangle_surfaces", bytemuck::cast_slice(&known.surfaces)),
        ("materials", bytemuck::cast_slice(&known.materials)),
        ("emitters", bytemuck::cast_slice(&known.emitters)),
        ("inputs", bytemuck::cast_slice(&inputs)),
    ];
    let found = pairs("probe_emitters", 6, &buffers, COUNT);
    let total: f64 = lamps.iter().map(Lamp::power).sum();
    let mut chosen = vec![0; lamps.len()];
    let mut places = vec![vec![0; 64]; lamps.len()];
    let mut reported = vec![0.0; lamps.len()];
    for [first, second] in found {
        let position = direction(first);
        let index = (position.x + 3.0).round();
        assert!((0.0..7.0).contains(&index), "a point at {position}");
        let index = index as usize;
        let lamp = &lamps[index];
        assert!((position.x - lamp.plane).abs() < 1e-5);
        chosen[index] += 1;
        assert_density(
            "emitter",
            first[3],
            lamp.power() / total / lamp.area(),
            1e-4,
        );
        reported[index] = f64::from(first[3]);
        for (radiance, emission) in second.iter().zip(lamp.emission) {
            let found = f64::from(*radiance) * f64::from(first[3]);
            assert!(
                (found - emission).abs() <= 1e-5 * emission,
                "{found} of {emission}"
            );
        }
        assert_eq!(second[3] > 0.5, lamp.double_sided);
        // The share without the first corner is uniform squared, the place between the others even.
        let [a, b] = lamp.weights(position);
        assert!(
            a > -1e-4 && b > -1e-4 && a + b < 1.0 + 1e-4,
            "outside: {a} {b}"
        );
        let rest = (a + b).clamp(0.0, 1.0);
        let along = if rest > 1e-6 {
            (b / rest).clamp(0.0, 1.0)
        } else {
            0.0
        };
        places[index][8 * bin(rest * rest, 8) + bin(along, 8)] += 1;
    }
    // ∫ density dA over all that shines.
    let integral: f64 = lamps
        .iter()
        .zip(&reported)
        .map(|(lamp, density)| density * lamp.area())
        .sum();
    assert!(
        (integral - 1.0).abs() < 1e-5,
        "the density integrates to {integral}"
    );
    assert_eq!(chosen[2], 0, "chosen, and dark");
    let expected: Vec<f64> = lamps
        .iter()
        .zip(&reported)
        .map(|(lamp, density)| density * lamp.area() * COUNT as f64)
        .collect();
    assert_fits("emitters by power", &chosen, &expected);
    for (index, places) in places.iter().enumerate() {
        if chosen[index] >= 1000 {
            let even = f64::from(chosen[index]) / 64.0;
            assert_fits(&format!("emitter {index}"), places, &[even; 64]);
        }
    }
}

/// Coordinates are good to about 3e-7 of a turn, and beside the sun radiance rises by 150 a pixel,
/// 4,800 a turn: 1.4e-3 along each axis.
fn assert_radiance(name: &str, found: f32, exact: f64) {
    let error = (f64::from(found) - exact).abs();
    assert!(error <= 3e-3 + 1e-5 * exact, "{name}: {found} for {exact}");
}

/// An environment's map, its rotation in radians and its buffers.
struct Sky {
    map: EnvironmentMap,
    turn: f64,
    factor: [f32; 3],
    frame: Vec<u8>,
    pixels: Vec<[f32; 4]>,
    alias: Vec<[u32; 2]>,
}

impl Sky {
    /// The one of the surface truths: 32 × 16 pixels with a small sun, turned by 37°.
    fn load() -> Self {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/data/surface_truths"));
        let scene = tyndall_scene::load(&folder.join("environment.json"))
            .expect("the scene is here")
            .scene;
        let frame = [probe::frame_values(&scene, (64, 64), [0.5; 2])];
        let environment = scene.environment.expect("the scene has one");
        let map = environment.map.expect("it has a map");
        let (pixels, alias) = probe::environment_values(&map);
        Self {
            map,
            turn: 37_f64.to_radians(),
            factor: environment.radiance,
            frame: bytemuck::cast_slice(&frame).to_vec(),
            pixels,
            alias,
        }
    }

    fn ask(&self, inputs: &[[f32; 4]], count: usize) -> Vec<[[f32; 4]; 2]> {
        let buffers: [(&'static str, &[u8]); 4] = [
            ("frame", &self.frame),
            ("environment_pixels", bytemuck::cast_slice(&self.pixels)),
            ("environment_alias", bytemuck::cast_slice(&self.alias)),
            ("inputs", bytemuck::cast_slice(inputs)),
        ];
        pairs("probe_environment", 0, &buffers, count)
    }

    /// About +Y, counter-clockwise seen from above.
    fn turned(&self, v: DVec3, turns: f64) -> DVec3 {
        let (sin, cos) = (turns * self.turn).sin_cos();
        DVec3::new(cos * v.x + sin * v.z, v.y, cos * v.z - sin * v.x)
    }

    /// Bilinear between pixel centres.
    fn radiance(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let (width, height) = (self.map.width as i64, self.map.height as i64);
        let (x, y) = (u * width as f64 - 0.5, v * height as f64 - 0.5);
        let mut sum = [0.0; 3];
        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (column, row) = (x.floor() as i64 + i, y.floor() as i64 + j);
            let weight = (1.0 - (x - column as f64).abs()) * (1.0 - (y - row as f64).abs());
            let at = row.clamp(0, height - 1) * width + column.rem_euclid(width);
            for (sum, (pixel, factor)) in sum
                .iter_mut()
                .zip(self.map.pixels[at as usize].iter().zip(self.factor))
            {
                *sum += weight * f64::from(*pixel) * f64::from(factor);
            }
        }
        sum
    }
}

#[test]
fn environment_directions_follow_the_density_that_rays_find_which_integrates_to_one() {
    let sky = Sky::load();
    let (width, height) = (sky.map.width as usize, sky.map.height as usize);
    // Four cells a pixel, equal in solid angle: what a pixel's density says of each.
    let cell = |u: f64, cosine: f64, row: usize| {
        let edge = |row: usize| (PI * row as f64 / height as f64).cos();
        let down = (edge(row) - cosine) / (edge(row) - edge(row + 1));
        let across = u * width as f64;
        let x = (across as usize).min(width - 1);
        4 * (row * width + x)
            + 2 * bin(down.clamp(0.0, 1.0), 2)
            + bin((across - x as f64).clamp(0.0, 1.0), 2)
    };
    let mut inputs = Vec::new();
    for row in 0..height {
        let edge = |row: usize| (PI * row as f64 / height as f64).cos();
        for x in 0..width {
            for k in 0..4_u32 {
                let (down, across) = (f64::from(k / 2) * 0.5 + 0.25, f64::from(k % 2) * 0.5 + 0.25);
                let cosine = edge(row) + (edge(row + 1) - edge(row)) * down;
                let phi = TAU * ((x as f64 + across) / width as f64 - 0.5);
                let sine = (1.0 - cosine * cosine).sqrt();
                let local = DVec3::new(sine * phi.sin(), cosine, -sine * phi.cos());
                inputs.push(sky.turned(local, 1.0).as_vec3().extend(0.0).to_array());
            }
        }
    }
    let seen = sky.ask(&inputs, inputs.len());
    let mut expected = Vec::new();
    let mut integral = 0.0;
    for (index, [first, second]) in seen.iter().enumerate() {
        let share = f64::from(first[3]) * sky.map.solid_angle((index / 4 / width) as u32) / 4.0;
        integral += share;
        expected.push(share * COUNT as f64);
        let coordinates = EnvironmentMap::coordinates(sky.turned(direction(*first), -1.0));
        for (found, exact) in second.iter().zip(sky.radiance(coordinates)) {
            assert_radiance("seen", *found, exact);
        }
    }
    assert!(
        (integral - 1.0).abs() < 1e-5,
        "the density integrates to {integral}"
    );
    let mut counts = vec![0; expected.len()];
    let mut strays = 0;
    for [first, second] in sky.ask(&[[71.0, 0.0, 0.0, 0.0]], COUNT) {
        let v = direction(first);
        assert!((v.length() - 1.0).abs() < 1e-5, "length of {v}");
        let local = sky.turned(v, -1.0);
        let [u, down] = EnvironmentMap::coordinates(local);
        let row = ((down * height as f64) as usize).min(height - 1);
        counts[cell(u, local.y, row)] += 1;
        for (found, exact) in second.iter().zip(sky.radiance([u, down])) {
            assert_radiance("sampled", *found, exact);
        }
        // On the edge of a pixel rounding may find its neighbour's.
        let [x, y] = [u * width as f64, down * height as f64].map(|p| (p - p.round()).abs());
        if x > 1e-4 && y > 1e-4 {
            assert_density("found", second[3], f64::from(first[3]), 1e-6);
        } else {
            strays += 1;
        }
    }
    // 4e-4 of the directions are so near to an edge: 52 of 131,072.
    assert!(strays < 200, "{strays} directions on edges");
    assert_fits("environment directions", &counts, &expected);
}
