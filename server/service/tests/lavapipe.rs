//! The whole path with the real renderer on whatever Vulkan driver there is, tiny and few.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that unwraps says where it failed, and prints what it measures"
)]

use std::time::{Duration, Instant};

use crate::support::{Client, camera, hello, scene, start_real};
use serde_json::json;
use tyndall_scene::SceneDescription;
use tyndall_stream::header::Codec;

/// Mean of the red channel of a PNG.
fn mean_red(bytes: &[u8]) -> f64 {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (96, 64));
    let channels = info.color_type.samples();
    let sum: u64 = pixels
        .iter()
        .step_by(channels)
        .map(|&red| u64::from(red))
        .sum();
    sum as f64 * channels as f64 / pixels.len() as f64
}

/// Whether a Vulkan driver is there; says aloud where it is not.
fn has_driver() -> bool {
    let there = !tyndall_render::Device::adapters().is_empty();
    if !there {
        assert!(
            std::env::var_os("CI").is_none(),
            "CI must have a Vulkan driver"
        );
        println!("skipped: there is no Vulkan driver");
    }
    there
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_small_picture_does_not_wait_for_the_whole_of_anothers_long_frame() {
    if !has_driver() {
        return;
    }
    // A frame of the large picture has 4e9 loop iterations: seconds on two cores.
    let mut heavy = scene(65_536);
    let march = &mut heavy.description.render.single_scattering;
    (march.steps, march.interleave) = (512, 1);
    let heavy = tyndall_scene::build(SceneDescription::clone(&heavy.description), None).unwrap();
    let server = start_real(heavy).await;
    let mut large = hello();
    (large["width"], large["height"]) = (json!(1920), json!(1080));
    let (mut greedy, _) = Client::enter(&server, large).await;
    greedy.frame().await;
    let (mut small, _) = Client::enter(&server, hello()).await;
    small.frame().await;
    // Long enough at rest for the large picture to climb to its full size.
    tokio::time::sleep(Duration::from_secs(1)).await;
    let mut waits = Vec::new();
    for input in 1..=12 {
        let asked = Instant::now();
        small
            .say(camera(input, f64::from(input as u32) * 0.02))
            .await;
        small
            .frame_where(|frame| frame.applied_input == input)
            .await;
        waits.push(asked.elapsed());
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    waits.sort_unstable();
    println!("waits: {waits:?}");
    // Alone on two cores 0.4 s and 1.1 s, where 0.3 s is the goal; the whole frame takes 9 s.
    assert!(waits[6] < Duration::from_secs(2), "{waits:?}");
    assert!(waits[11] < Duration::from_secs(5), "{waits:?}");
    drop(greedy);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn real_frames_converge_react_and_survive_a_reconnection() {
    if !has_driver() {
        return;
    }
    let server = start_real(scene(4)).await;
    let (mut client, welcome) = Client::enter(&server, hello()).await;
    assert!(!welcome["adapter"]["name"].as_str().unwrap().is_empty());
    let plan = client.json("plan").await;
    assert!(!plan["plan"]["passes"].as_array().unwrap().is_empty());
    let picture = loop {
        let (frame, payload) = client.frame().await;
        if frame.converged {
            assert_eq!((frame.codec, frame.samples), (Codec::Png, 4));
            break payload;
        }
    };
    assert!(mean_red(&picture) > 1.0, "the picture is black");
    let clear = client.json("stats").await;
    assert_eq!(
        (&clear["non_finite"], &clear["negative"]),
        (&json!(0), &json!(0))
    );

    let thick = json!([{"kind": "homogeneous", "sigma_s": 0.5, "sigma_a": 0.1}]);
    client
        .say(json!({"type": "edit", "input": 1, "edit": {"media": thick}}))
        .await;
    client
        .frame_where(|frame| frame.applied_input == 1 && frame.converged)
        .await;
    let foggy = client.json("stats").await;
    let transmittance = |stats: &serde_json::Value| stats["mean_transmittance"].as_f64().unwrap();
    assert!(
        transmittance(&foggy) < transmittance(&clear),
        "{foggy} {clear}"
    );

    for input in 2..=60 {
        client
            .say(camera(input, f64::from(input as u32) * 0.02))
            .await;
    }
    client
        .frame_where(|frame| frame.applied_input == 60 && frame.converged)
        .await;
    drop(client);
    let mut again = hello();
    again["resume"] = welcome["session"].clone();
    let (mut client, welcome) = Client::enter(&server, again).await;
    assert_eq!(welcome["resumed"], true);
    let (frame, _) = client.frame().await;
    assert_eq!((frame.applied_input, frame.converged), (60, true));
    let (_, _, metrics) = server.get("/metrics").await;
    assert!(metrics.contains("tyndall_pass_seconds_bucket"), "{metrics}");
    server.stop().await;
}
