//! What one client or one picture does to the others: plans, large edits, panics, sizes, the end.

use std::process::{Command, Stdio};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tokio::io::AsyncWriteExt as _;
use tokio::net::TcpStream;

use crate::support::{Client, camera, hello, options, scene, start, start_with};

const ENDLESS: u32 = 60_000;

/// A scene of as many clouds of the largest size, each with another seed.
fn clouds(count: u64) -> String {
    let cloud = |seed: u64| {
        json!({"kind": "procedural", "pattern": "cloud", "resolution": 256, "octaves": 8,
            "seed": seed, "sigma_s": 1, "sigma_a": 0})
    };
    let media: Vec<Value> = (0..count).map(cloud).collect();
    json!({"version": 1, "camera": {"position": [0, 0, 5], "target": [0, 0, 0]}, "media": media})
        .to_string()
}

const POST: &str = "POST /v1/plan\nContent-Type: application/json";

#[tokio::test]
async fn planning_makes_no_grids() {
    let server = start(scene(1)).await;
    let start = Instant::now();
    // As voxels they would take minutes to make.
    let (status, _, body) = server.http(POST, &clouds(200)).await;
    assert_eq!(status, 200, "{body}");
    let reply: Value = serde_json::from_str(&body).unwrap();
    assert_eq!(reply["facts"]["media"], 200);
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "{:?}",
        start.elapsed()
    );
    let (status, _, body) = server.get("/v1/plan?preset=cloud").await;
    assert_eq!(status, 200, "{body}");
    server.stop().await;
}

#[tokio::test]
async fn plans_keep_no_session_waiting_and_end_in_their_time() {
    let mut quick = options(scene(ENDLESS));
    quick.limits.plan_within = Duration::from_millis(1);
    let server = start_with(quick).await;
    let spheres: Vec<Value> = (0..1000)
        .map(|i| json!({"kind": "sphere", "center": [i, 0, 0], "radius": 1}))
        .collect();
    let text = json!({"version": 1, "camera": {"position": [0, 0, 5], "target": [0, 0, 0]},
        "geometry": spheres})
    .to_string();
    // Many who post and leave at once, and one who waits.
    for _ in 0..50 {
        let mut stream = TcpStream::connect(server.address).await.unwrap();
        let head = format!(
            "POST /v1/plan HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n",
            text.len()
        );
        stream.write_all(head.as_bytes()).await.unwrap();
        stream.write_all(text.as_bytes()).await.unwrap();
    }
    let (status, head, body) = server.http(POST, &text).await;
    assert_eq!(status, 503, "{body}");
    assert!(
        body.contains("took_too_long") && head.contains("retry-after"),
        "{body}"
    );
    let start = Instant::now();
    let (mut client, _) = Client::enter(&server, hello()).await;
    client
        .say(json!({"type": "open_preset", "input": 1, "name": "cornell_fog"}))
        .await;
    client.frame_where(|frame| frame.applied_input == 1).await;
    assert!(
        start.elapsed() < Duration::from_secs(5),
        "{:?}",
        start.elapsed()
    );
    server.stop().await;
}

#[tokio::test]
async fn plans_are_for_the_device_that_renders() {
    let server = start(scene(1)).await;
    let plan = async || server.get("/v1/plan?preset=street_night").await.2;
    let unbounded = plan().await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.frame().await;
    // Another device has another driver.
    server.script.loop_cap.store(64, Ordering::SeqCst);
    server.script.lose.store(true, Ordering::SeqCst);
    client.say(camera(1, 2.0)).await;
    client.json("error").await;
    client.say(camera(2, 3.0)).await;
    client.frame_where(|frame| frame.applied_input == 2).await;
    assert_ne!(plan().await, unbounded);
    server.stop().await;
}

/// An edit of so many lights, some 180 kB.
fn large_edit(input: u64) -> Value {
    let light = json!({"kind": "point", "position": [0.25, 3.5, 3.125], "intensity": [1, 2, 3],
        "radius": 0.0125, "name": "one of very many lights"});
    json!({"type": "edit", "input": input, "edit": {"lights": vec![light; 1300]}})
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn large_edits_of_some_keep_others_frames_coming() {
    let server = start(scene(ENDLESS)).await;
    let (mut other, _) = Client::enter(&server, hello()).await;
    other.frame().await;
    let mut floods = Vec::new();
    for _ in 0..4 {
        let (mut client, _) = Client::enter(&server, hello()).await;
        client.polite = false;
        floods.push(tokio::spawn(async move {
            for input in 1..=100 {
                client.say(large_edit(input)).await;
            }
            client
        }));
    }
    let mut slowest = Duration::ZERO;
    for input in 1..=60 {
        let start = Instant::now();
        other.say(camera(input, 1.0 + input as f64)).await;
        other
            .frame_where(|frame| frame.applied_input == input)
            .await;
        slowest = slowest.max(start.elapsed());
    }
    println!("the slowest answer beside four who edit took {slowest:?}");
    assert!(slowest < Duration::from_millis(1500), "{slowest:?}");
    for flood in floods {
        flood.abort();
    }
    server.stop().await;
}

#[tokio::test]
async fn edits_of_a_session_wait_for_their_share_of_time() {
    let mut options = options(scene(1));
    options.limits.edit_percent = 1;
    let server = start_with(options).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.say(large_edit(1)).await;
    client.frame_where(|frame| frame.applied_input == 1).await;
    let start = Instant::now();
    client.say(large_edit(2)).await;
    client.frame_where(|frame| frame.applied_input == 2).await;
    let waited = start.elapsed();
    assert!(waited > Duration::from_millis(50), "{waited:?}");
    server.stop().await;
}

#[tokio::test]
async fn of_edits_that_come_faster_than_they_are_made_the_newest_wins() {
    const EDITS: u64 = 400;
    let mut options = options(scene(1));
    options.limits.edit_percent = 1;
    let server = start_with(options).await;
    let (mut client, welcome) = Client::enter(&server, hello()).await;
    client.say(large_edit(1)).await;
    client.frame_where(|frame| frame.applied_input == 1).await;
    let start = Instant::now();
    client.say(large_edit(2)).await;
    client.frame_where(|frame| frame.applied_input == 2).await;
    let one = start.elapsed();
    let start = Instant::now();
    for input in 3..=EDITS {
        let exposure = input as f64 / EDITS as f64;
        client
            .say(json!({"type": "edit", "input": input, "edit": {"exposure_ev": exposure}}))
            .await;
    }
    client.say(camera(EDITS + 1, 5.0)).await;
    client
        .frame_where(|frame| frame.applied_input == EDITS + 1)
        .await;
    let all = start.elapsed();
    println!("one large edit took {one:?}, {EDITS} small ones {all:?}");
    // Each of them alone would have rested for a hundred times as long as it takes.
    assert!(all < 4 * one + Duration::from_secs(1), "{all:?}");
    let mut again = hello();
    again["resume"] = welcome["session"].clone();
    let (mut client, _) = Client::enter(&server, again).await;
    let scene = client.json("scene").await;
    assert_eq!(scene["description"]["camera"]["exposure_ev"], 1.0);
    server.stop().await;
}

#[tokio::test]
async fn a_picture_that_makes_the_renderer_panic_is_refused_and_others_go_on() {
    // A report with all its frames takes seconds on a busy machine.
    std::panic::set_hook(Box::new(|info| println!("{info}")));
    let server = start(scene(ENDLESS)).await;
    let (mut other, _) = Client::enter(&server, hello()).await;
    other.frame().await;
    server.script.panic_width.store(48, Ordering::SeqCst);
    let mut wish = hello();
    (wish["width"], wish["height"]) = (json!(48), json!(32));
    let (mut client, _) = Client::enter(&server, wish).await;
    loop {
        let error = client.json("error").await;
        assert_eq!(error["code"], "render_failed");
        let message = error["message"].as_str().unwrap();
        assert!(message.contains("the renderer panicked"), "{message}");
        if message.contains("not tried again") {
            break;
        }
    }
    other.say(camera(1, 9.0)).await;
    other.frame_where(|frame| frame.applied_input == 1).await;
    let (status, _, text) = server.get("/readyz").await;
    assert_eq!(status, 200);
    assert!(
        text.contains("given up after a panic of the renderer"),
        "{text}"
    );
    let (_, _, metrics) = server.get("/metrics").await;
    let counted = "tyndall_panics_total{thread=\"render\"}";
    let line = metrics
        .lines()
        .find(|line| line.starts_with(counted))
        .unwrap();
    assert_ne!(line, format!("{counted} 0"));
    client
        .say(json!({"type": "resize", "input": 1, "width": 64, "height": 32}))
        .await;
    client.frame_where(|frame| frame.applied_input == 1).await;
    server.stop().await;
}

#[tokio::test]
async fn a_size_above_the_limits_is_answered_with_one_within_them() {
    let mut options = options(scene(1));
    options.limits.max_pixels = 320 * 180;
    let server = start_with(options).await;
    let mut wish = hello();
    (wish["width"], wish["height"]) = (json!(1280), json!(720));
    let (mut client, _) = Client::enter(&server, wish).await;
    let notice = client.json("notice").await;
    let message = notice["message"].as_str().unwrap();
    assert!(
        message.contains("320×180 pixels instead of 1280×720"),
        "{message}"
    );
    // A moving picture has fewer pixels yet.
    client
        .frame_where(|frame| (frame.width, frame.height) == (320, 180))
        .await;
    client
        .say(json!({"type": "resize", "input": 3, "width": 4_000_000_000_u32, "height": 1}))
        .await;
    client
        .frame_where(|frame| frame.applied_input == 3 && (frame.width, frame.height) == (8192, 1))
        .await;
    server.stop().await;
}

#[tokio::test]
async fn sockets_that_are_cut_off_are_told_from_those_that_say_goodbye() {
    let server = start(scene(1)).await;
    let (cut, _) = Client::enter(&server, hello()).await;
    drop(cut);
    let (mut polite, _) = Client::enter(&server, hello()).await;
    polite.socket.close(None).await.unwrap();
    let count = async |reason: &str| {
        let (_, _, metrics) = server.get("/metrics").await;
        let label = format!("tyndall_sockets_closed_total{{reason=\"{reason}\"}} ");
        let line = metrics.lines().find_map(|line| line.strip_prefix(&label));
        line.map_or(0, |count| count.parse::<u32>().unwrap())
    };
    for _ in 0..100 {
        if count("the client left").await == 1 && count("the connection was aborted").await == 1 {
            return server.stop().await;
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    panic!("{}", server.get("/metrics").await.2);
}

/// Set in the process that serves and is told to end.
const CHILD: &str = "TYNDALL_TEST_SERVES";

/// As its own child this test serves with a renderer that hangs; as the parent it sends SIGTERM and waits.
#[test]
fn sigterm_ends_a_process_whose_renderer_hangs_within_its_time() {
    let within = Duration::from_secs(2);
    if let Some(port_file) = std::env::var_os(CHILD) {
        let mut options = options(scene(ENDLESS));
        options.limits.drain_within = within;
        options.end_process = true;
        let runtime = tokio::runtime::Runtime::new().unwrap();
        runtime.block_on(async {
            let server = start_with(options).await;
            server.script.stuck_width.store(96, Ordering::SeqCst);
            let (mut client, _) = Client::enter(&server, hello()).await;
            client.json("scene").await;
            tokio::time::sleep(Duration::from_millis(300)).await;
            std::fs::write(port_file, "busy").unwrap();
            server.ended.await.unwrap().unwrap_err();
        });
        // Waits for ever, as a scene being built would make it: only the watchdog ends this.
        std::thread::park();
        unreachable!("nobody wakes it");
    }
    let folder = tempfile::tempdir().unwrap();
    let ready = folder.path().join("ready");
    let name = "load::sigterm_ends_a_process_whose_renderer_hangs_within_its_time";
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", name, "--nocapture"])
        .env(CHILD, &ready)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !ready.exists() {
        assert!(
            begun.elapsed() < Duration::from_secs(30),
            "it does not start"
        );
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        std::thread::sleep(Duration::from_millis(20));
    }
    let told = Instant::now();
    let kill = Command::new("kill").arg(child.id().to_string()).status();
    assert!(kill.unwrap().success());
    let ended = loop {
        if let Some(ended) = child.try_wait().unwrap() {
            break ended;
        }
        let late = told.elapsed() > within + Duration::from_secs(3);
        if late {
            child.kill().unwrap();
        }
        assert!(!late, "it still lives after {:?}", told.elapsed());
        std::thread::sleep(Duration::from_millis(20));
    };
    println!("ended after {:?}: {ended}", told.elapsed());
    assert!(!ended.success());
}
