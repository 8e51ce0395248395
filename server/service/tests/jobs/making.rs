//! How jobs are made: beside people, through faults, stopped, told of.

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tyndall_service::{DataFolder, ServeOptions};

use super::{fetch, finish, reach, results, status, still, submit, with};
use crate::support::{Client, SOON, hello, options, scene, start, start_with};

#[tokio::test(flavor = "multi_thread")]
async fn a_cancelled_job_stops_at_once_and_keeps_what_it_has() {
    let server = start(scene(1)).await;
    let id = submit(&server, &still(60_000)).await;
    let running = reach(&server, &id, |job| job["samples"].as_u64() > Some(3)).await;
    assert_eq!(running["state"], "running");
    assert!(running["eta_seconds"].as_f64() > Some(1.0), "{running}");
    let (code, _, picture) = fetch(&server, &format!("/v1/jobs/{id}/preview"), "").await;
    assert_eq!((code, &picture[..2]), (200, &[0xff, 0xd8][..]), "a JPEG");
    let asked = Instant::now();
    let (code, _, _) = server.http(&format!("DELETE /v1/jobs/{id}"), "").await;
    assert_eq!(code, 200);
    let partial = loop {
        let found = results(&server, &id).await;
        if let [partial] = &found[..] {
            break partial.clone();
        }
        assert!(asked.elapsed() < SOON);
        tokio::time::sleep(Duration::from_millis(2)).await;
    };
    // The slice itself is 2 ms; the rest is this machine's.
    assert!(
        asked.elapsed() < Duration::from_secs(2),
        "{:?}",
        asked.elapsed()
    );
    assert_eq!(partial["complete"], false);
    let (code, _, bytes) = fetch(&server, partial["url"].as_str().unwrap(), "").await;
    assert_eq!((code, &bytes[1..4]), (200, &b"PNG"[..]));
    let frames = server.script.frames.load(Ordering::SeqCst);
    tokio::time::sleep(Duration::from_millis(50)).await;
    assert_eq!(
        server.script.frames.load(Ordering::SeqCst),
        frames,
        "nothing is rendered any more"
    );
    assert_eq!(status(&server, &id).await["state"], "cancelled");
    assert_eq!(server.get(&format!("/v1/jobs/{id}/preview")).await.0, 404);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn events_tell_every_change_and_end_with_the_job() {
    let server = start(scene(1)).await;
    let id = submit(&server, &still(200)).await;
    let path = format!("/v1/jobs/{id}/events");
    let (code, head, body) = fetch(&server, &path, "").await;
    assert_eq!(code, 200);
    assert!(head.contains("content-type: text/event-stream"), "{head}");
    let text = String::from_utf8_lossy(&body).into_owned();
    let statuses: Vec<Value> = text
        .lines()
        .filter_map(|line| serde_json::from_str(line.strip_prefix("data: ")?).ok())
        .collect();
    let last = statuses.last().unwrap();
    assert_eq!(last["state"], "done");
    let fractions: Vec<f64> = statuses
        .iter()
        .filter_map(|job| job["fraction"].as_f64())
        .collect();
    assert!(
        fractions.is_sorted() && fractions.len() >= 2,
        "{fractions:?}"
    );
    let seen = format!("Last-Event-ID: {}\r\n", last["revision"]);
    assert_eq!(fetch(&server, &path, &seen).await.0, 204);
    let (code, _, again) = fetch(&server, &path, "Last-Event-ID: 1\r\n").await;
    assert_eq!(code, 200);
    assert!(String::from_utf8_lossy(&again).contains("\"done\""));
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_longer_animation_renders_only_the_missing_frames() {
    let server = start(scene(1)).await;
    let animation = |last: u32| with(still(2), &json!({"frames": {"last": last}}));
    let first = submit(&server, &animation(3)).await;
    finish(&server, &first).await;
    let made = server.script.frames.load(Ordering::SeqCst);
    assert_eq!(made, 8, "two samples each");
    let second = submit(&server, &animation(5)).await;
    finish(&server, &second).await;
    assert_eq!(server.script.frames.load(Ordering::SeqCst), made + 4);
    let names: Vec<Value> = results(&server, &second)
        .await
        .iter()
        .map(|one| one["name"].clone())
        .collect();
    assert_eq!(names[..2], ["frame_00000.png", "frame_00001.png"]);
    assert_eq!(names.len(), 6);
    // Pages and states of the list.
    let (_, _, page) = server.get("/v1/jobs?limit=1").await;
    let page: Value = serde_json::from_str(&page).unwrap();
    assert_eq!(page["jobs"][0]["id"], json!(second));
    let next = page["next"].as_str().unwrap();
    let (_, _, page) = server
        .get(&format!("/v1/jobs?limit=1&state=done&after={next}"))
        .await;
    let page: Value = serde_json::from_str(&page).unwrap();
    assert_eq!(
        (&page["jobs"][0]["id"], &page["next"]),
        (&json!(first), &Value::Null)
    );
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_job_that_loses_the_device_twice_has_failed_and_others_go_on() {
    let server = start(scene(1)).await;
    server.script.deadly_width.store(33, Ordering::SeqCst);
    let mut deadly = still(5);
    deadly["render"]["width"] = json!(33);
    let deadly = submit(&server, &deadly).await;
    let failed = finish(&server, &deadly).await;
    assert_eq!(failed["state"], "failed");
    assert!(
        failed["error"]
            .as_str()
            .unwrap()
            .contains("the test took it away"),
        "{failed}"
    );
    // It is told before another device is open.
    let began = Instant::now();
    while server.script.opened.load(Ordering::SeqCst) < 3 {
        assert!(began.elapsed() < SOON);
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    let fine = submit(&server, &still(2)).await;
    assert_eq!(finish(&server, &fine).await["state"], "done");
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn jobs_and_results_outlive_the_server() {
    let folder = tempfile::tempdir().unwrap();
    let kept = || ServeOptions {
        data: DataFolder::Named(folder.path().join("data")),
        ..options(scene(1))
    };
    let server = start_with(kept()).await;
    let second = start_with(ServeOptions {
        data: DataFolder::Usual(folder.path().join("data")),
        ..options(scene(1))
    })
    .await;
    second.stop().await;
    let done = submit(&server, &still(2)).await;
    finish(&server, &done).await;
    let running = submit(&server, &still(400)).await;
    reach(&server, &running, |job| job["samples"].as_u64() > Some(2)).await;
    server.stop().await;
    let server = start_with(kept()).await;
    assert_eq!(results(&server, &done).await.len(), 1);
    let finished = finish(&server, &running).await;
    assert_eq!(finished["state"], "done", "{finished}");
    assert_eq!(results(&server, &running).await[0]["complete"], true);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn people_get_their_frames_while_jobs_run() {
    let server = start(scene(60_000)).await;
    let jobs = [
        submit(&server, &still(60_000)).await,
        submit(&server, &still(60_000)).await,
    ];
    for id in &jobs {
        reach(&server, id, |job| job["samples"].as_u64() > Some(1)).await;
    }
    let (mut client, _) = Client::enter(&server, hello()).await;
    let began = Instant::now();
    for _ in 0..10 {
        client.frame().await;
    }
    assert!(
        began.elapsed() < Duration::from_secs(5),
        "{:?}",
        began.elapsed()
    );
    let mut samples = Vec::new();
    for id in &jobs {
        let before = status(&server, id).await["samples"].as_u64().unwrap();
        reach(&server, id, |job| {
            job["samples"].as_u64() > Some(before + 10)
        })
        .await;
        samples.push(status(&server, id).await["samples"].as_u64().unwrap() as f64);
    }
    let ratio = samples[0] / samples[1];
    assert!(
        (0.5..2.0).contains(&ratio),
        "they share the device: {samples:?}"
    );
    server.stop().await;
}
