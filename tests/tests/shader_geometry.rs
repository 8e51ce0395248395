//! Camera rays and BVH traversal on a device against f64.

use glam::{DVec3, DVec4};
use serde_json::json;
use tyndall_render::probe;
use tyndall_tests::{gpu, probes};

#[test]
fn the_rasterizer_and_the_rays_agree_on_where_a_pixel_looks() {
    let device = gpu::device();
    let scene = gpu::scene(&json!({
        "version": 1,
        "camera": { "position": [3, 2, 5], "target": [-1, 0.5, -2], "up": [0.1, 1, 0], "vertical_fov_degrees": 50 },
        "geometry": [{ "kind": "quad", "corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0] }],
    }));
    let (width, height) = (160_u32, 90_u32);
    let offset = [0.23_f32, 0.81];
    let frame = probe::frame_values(&scene, (width, height), offset);
    // The documented camera in f64.
    let forward = (DVec3::new(-1.0, 0.5, -2.0) - DVec3::new(3.0, 2.0, 5.0)).normalize_or(DVec3::X);
    let right = forward
        .cross(DVec3::new(0.1, 1.0, 0.0))
        .normalize_or(DVec3::X);
    let up = right.cross(forward);
    let tan_y = 25_f64.to_radians().tan();
    let tan_x = tan_y * f64::from(width) / f64::from(height);
    let pixels = [(0_u32, 0_u32), (159, 0), (80, 45), (17, 88)];
    let inputs: Vec<[f32; 4]> = pixels
        .iter()
        .map(|(x, y)| [*x as f32 + offset[0], *y as f32 + offset[1], 7.5, 0.0])
        .collect();
    let buffers: [(&'static str, &[u8]); 2] = [
        ("frame", bytemuck::bytes_of(&frame)),
        ("inputs", bytemuck::cast_slice(&inputs)),
    ];
    let outputs = gpu::probe_vec4(&device, "probe_camera", 0, &buffers, 2 * inputs.len());
    for ((x, y), pair) in pixels.iter().zip(outputs.chunks_exact(2)) {
        let ndc_x = 2.0 * (f64::from(*x) + f64::from(offset[0])) / f64::from(width) - 1.0;
        let ndc_y = 1.0 - 2.0 * (f64::from(*y) + f64::from(offset[1])) / f64::from(height);
        let point = (forward + right * (ndc_x * tan_x) + up * (ndc_y * tan_y)) * 7.5;
        let found = DVec3::new(pair[0][0].into(), pair[0][1].into(), pair[0][2].into());
        assert!(
            (found - point).length() < 1e-5,
            "pixel {x} {y}: ray to {found}, oracle {point}"
        );
        assert!(
            gpu::relative_error(pair[0][3], 7.5) < 1e-5,
            "view depth {}",
            pair[0][3]
        );
        // The rasterizer samples at the pixel's centre.
        let clip = DVec4::new(
            pair[1][0].into(),
            pair[1][1].into(),
            pair[1][2].into(),
            pair[1][3].into(),
        );
        let raster_x = (clip.x / clip.w + 1.0) * 0.5 * f64::from(width);
        let raster_y = (1.0 - clip.y / clip.w) * 0.5 * f64::from(height);
        assert!(
            (raster_x - f64::from(*x) - 0.5).abs() < 1e-3,
            "pixel {x}: rasterized at {raster_x}"
        );
        assert!(
            (raster_y - f64::from(*y) - 0.5).abs() < 1e-3,
            "pixel {y}: rasterized at {raster_y}"
        );
    }
}

#[test]
fn bvh_traversal_agrees_with_testing_every_triangle() {
    let device = gpu::device();
    let loaded = tyndall_scene::build(
        tyndall_scene::presets::description("fogged_hall").unwrap(),
        None,
    )
    .unwrap();
    let scene = loaded.scene;
    let (nodes, vertices) = probe::bvh_bytes(&scene).unwrap();
    let points: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&vertices);
    let triangles: Vec<[DVec3; 3]> = points
        .chunks_exact(3)
        .map(|t| [0, 1, 2].map(|i| DVec3::new(t[i][0].into(), t[i][1].into(), t[i][2].into())))
        .collect();
    let rays = gpu::random_segments(2000, 8.0);
    let inputs: Vec<[f32; 4]> = rays
        .iter()
        .flat_map(|(o, d, l)| {
            let (o, d) = (o.as_vec3(), d.as_vec3());
            [[o.x, o.y, o.z, *l as f32], [d.x, d.y, d.z, 0.0]]
        })
        .collect();
    let buffers: [(&'static str, &[u8]); 3] = [
        ("bvh_nodes", &nodes),
        ("bvh_vertices", &vertices),
        ("inputs", bytemuck::cast_slice(&inputs)),
    ];
    let bytes = probe::run(
        &device,
        probes::named("probe_bvh"),
        0,
        &buffers,
        rays.len() as u64 * 4,
        32,
    )
    .unwrap();
    let found: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
    let (mut differ, mut hits) = (0, 0);
    for ((origin, direction, limit), found) in rays.iter().zip(&found) {
        let expected = triangles
            .iter()
            .any(|t| hit(*t, *origin, *direction).is_some_and(|d| d > 0.0 && d < *limit));
        hits += u32::from(expected);
        differ += u32::from(expected != (*found != 0));
    }
    assert!(
        hits > 200 && hits < 1900,
        "{hits} of 2000 rays hit: the test needs both kinds"
    );
    // f32 against f64 may disagree at an edge or at the segment's end.
    assert!(differ <= 2, "{differ} of 2000 rays differ");
}

fn hit([a, b, c]: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
    let (e1, e2) = (b - a, c - a);
    let p = direction.cross(e2);
    let determinant = e1.dot(p);
    if determinant.abs() < 1e-14 {
        return None;
    }
    let s = origin - a;
    let u = s.dot(p) / determinant;
    let q = s.cross(e1);
    let v = direction.dot(q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| e2.dot(q) / determinant)
}
