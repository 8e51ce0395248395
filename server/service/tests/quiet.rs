//! A converged session costs nothing. Alone in its file, since it measures this process.

mod support;

use std::sync::atomic::Ordering;
use std::time::Duration;

use support::{Client, hello, scene, start};

/// Processor time of the render thread. Unit: ns. `None` where the system does not tell.
fn render_thread_time() -> Option<u64> {
    for task in std::fs::read_dir("/proc/self/task").ok()? {
        let task = task.ok()?.path();
        if std::fs::read_to_string(task.join("comm")).ok()?.trim() == "render" {
            let statistics = std::fs::read_to_string(task.join("schedstat")).ok()?;
            return statistics.split(' ').next()?.parse().ok();
        }
    }
    None
}

#[tokio::test]
async fn converged_session_is_quiet() {
    let server = start(scene(3)).await;
    let (mut client, _) = Client::enter(&server, hello()).await;
    client.frame_where(|frame| frame.converged).await;
    client.json("stats").await;
    client.during(Duration::from_millis(300)).await;
    let (calls, time) = (
        server.script.calls.load(Ordering::SeqCst),
        render_thread_time(),
    );
    let received = client.during(Duration::from_secs(2)).await;
    assert!(received.is_empty(), "{received:?}");
    assert_eq!(
        server.script.calls.load(Ordering::SeqCst),
        calls,
        "the renderer was called"
    );
    match (time, render_thread_time()) {
        (Some(before), Some(after)) => {
            assert_eq!(
                after,
                before,
                "the render thread ran for {} ns",
                after - before
            );
        }
        _ => println!("skipped: this system does not tell a thread's processor time"),
    }
    server.stop().await;
}
