//! What is counted, under names that dashboards rely on. No session ids as labels: their number
//! has no bound.

use std::sync::OnceLock;
use std::time::Duration;

use metrics::{counter, describe_counter, describe_gauge, describe_histogram, gauge, histogram};
use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};
use tyndall_jobs::Counts;
use tyndall_render::FinishedFrame;

use crate::options::ServeError;

/// Bounds of the time histograms, 0.1 ms to 10 s. Unit: s.
const TIME_BUCKETS: &[f64] = &[
    0.0001, 0.0003, 0.001, 0.002, 0.005, 0.01, 0.02, 0.035, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0,
    10.0,
];

/// How often samples are folded into the histograms' buckets.
pub(crate) const UPKEEP_EVERY: Duration = Duration::from_secs(5);

/// The recorder is global to the process, so that services of one process share it.
static RECORDER: OnceLock<Result<PrometheusHandle, String>> = OnceLock::new();

/// Installs the recorder once and returns the handle that prints it.
pub(crate) fn install() -> Result<PrometheusHandle, ServeError> {
    let installed = RECORDER.get_or_init(|| {
        let builder = PrometheusBuilder::new()
            .set_buckets_for_metric(Matcher::Suffix("_seconds".to_owned()), TIME_BUCKETS)
            .map_err(|error| error.to_string())?;
        let handle = builder
            .install_recorder()
            .map_err(|error| error.to_string())?;
        describe();
        Ok(handle)
    });
    installed.clone().map_err(ServeError::Metrics)
}

fn describe() {
    describe_counter!(
        "tyndall_tasks_ended_total",
        "Tasks of jobs by how they ended"
    );
    describe_histogram!("tyndall_task_seconds", "Time of a task of a job");
    describe_gauge!("tyndall_jobs_open", "Jobs that are not over");
    describe_gauge!("tyndall_tasks_queued", "Tasks that wait to be taken");
    describe_gauge!("tyndall_tasks_leased", "Tasks that are being made");
    describe_gauge!("tyndall_tasks_dead", "Tasks that failed for good");
    describe_counter!(
        "tyndall_frames_rendered_total",
        "Frames the device has finished"
    );
    describe_counter!("tyndall_frames_sent_total", "Frames handed to a socket");
    describe_counter!(
        "tyndall_frames_dropped_total",
        "Frames replaced by newer ones before sending"
    );
    describe_counter!(
        "tyndall_bytes_sent_total",
        "Bytes of frames handed to a socket"
    );
    describe_counter!(
        "tyndall_non_finite_pixels_total",
        "Pixels that were not finite: a fault"
    );
    describe_counter!(
        "tyndall_negative_pixels_total",
        "Pixels that were negative: a fault"
    );
    describe_counter!(
        "tyndall_clamped_pixels_total",
        "Pixels that a named clamp changed"
    );
    describe_counter!(
        "tyndall_render_errors_total",
        "Frames or pictures the renderer refused"
    );
    describe_counter!("tyndall_device_lost_total", "Times the device was lost");
    describe_counter!(
        "tyndall_malformed_messages_total",
        "Messages of clients that were refused"
    );
    describe_counter!(
        "tyndall_connections_refused_total",
        "Connections that got no place, or lost theirs to a newcomer"
    );
    describe_counter!(
        "tyndall_sockets_closed_total",
        "WebSockets that ended, by the reason"
    );
    describe_counter!(
        "tyndall_panics_total",
        "Pictures given up after a panic of this thread: a fault"
    );
    describe_gauge!("tyndall_connections", "HTTP connections that are open");
    describe_gauge!(
        "tyndall_sessions",
        "Sessions connected or waiting to be resumed"
    );
    describe_gauge!("tyndall_ready", "1 while the renderer works");
    describe_histogram!(
        "tyndall_frame_render_seconds",
        "Time of a frame on the device"
    );
    describe_histogram!("tyndall_encode_seconds", "Time of compressing a frame");
    describe_histogram!("tyndall_pass_seconds", "Time of a pass on the device");
    describe_histogram!(
        "tyndall_round_trip_seconds",
        "From sending a frame to its acknowledgement"
    );
    // Present from the start, so that a rate over them exists before the first event.
    for name in [
        "tyndall_frames_rendered_total",
        "tyndall_frames_sent_total",
        "tyndall_frames_dropped_total",
        "tyndall_bytes_sent_total",
        "tyndall_non_finite_pixels_total",
        "tyndall_negative_pixels_total",
        "tyndall_clamped_pixels_total",
        "tyndall_render_errors_total",
        "tyndall_device_lost_total",
        "tyndall_malformed_messages_total",
    ] {
        counter!(name).absolute(0);
    }
    for thread in ["render", "encoder"] {
        counter!("tyndall_panics_total", "thread" => thread).absolute(0);
    }
    gauge!("tyndall_connections").set(0.0);
    gauge!("tyndall_sessions").set(0.0);
    gauge!("tyndall_ready").set(0.0);
}

pub(crate) fn connections(count: usize) {
    gauge!("tyndall_connections").set(count as f64);
}

pub(crate) fn connection_refused(why: &'static str) {
    counter!("tyndall_connections_refused_total", "why" => why).increment(1);
}

/// `reason` is one of a few: labels are kept for ever.
pub(crate) fn socket_closed(reason: &'static str) {
    counter!("tyndall_sockets_closed_total", "reason" => reason).increment(1);
}

pub(crate) fn panicked(thread: &'static str) {
    counter!("tyndall_panics_total", "thread" => thread).increment(1);
}

pub(crate) fn sessions(count: usize) {
    gauge!("tyndall_sessions").set(count as f64);
}

pub(crate) fn ready(ready: bool) {
    gauge!("tyndall_ready").set(if ready { 1.0 } else { 0.0 });
}

pub(crate) fn frame_rendered(frame: &FinishedFrame) {
    counter!("tyndall_frames_rendered_total").increment(1);
    let stats = &frame.stats;
    counter!("tyndall_non_finite_pixels_total").increment(u64::from(stats.non_finite));
    counter!("tyndall_negative_pixels_total").increment(u64::from(stats.negative));
    counter!("tyndall_clamped_pixels_total").increment(u64::from(stats.clamped));
    histogram!("tyndall_frame_render_seconds").record(f64::from(frame.render_micros) * 1e-6);
    for pass in &frame.pass_times {
        histogram!("tyndall_pass_seconds", "pass" => pass.name.to_string())
            .record(f64::from(pass.micros) * 1e-6);
    }
}

pub(crate) fn frame_encoded(time: Duration) {
    histogram!("tyndall_encode_seconds").record(time.as_secs_f64());
}

pub(crate) fn frame_sent(bytes: usize) {
    counter!("tyndall_frames_sent_total").increment(1);
    counter!("tyndall_bytes_sent_total").increment(bytes as u64);
}

pub(crate) fn frame_dropped() {
    counter!("tyndall_frames_dropped_total").increment(1);
}

pub(crate) fn render_error() {
    counter!("tyndall_render_errors_total").increment(1);
}

pub(crate) fn device_lost() {
    counter!("tyndall_device_lost_total").increment(1);
}

pub(crate) fn malformed_message() {
    counter!("tyndall_malformed_messages_total").increment(1);
}

pub(crate) fn round_trip(time: Duration) {
    histogram!("tyndall_round_trip_seconds").record(time.as_secs_f64());
}

/// A task of a job ended so after a time.
pub(crate) fn task_ended(outcome: &'static str, took: Duration) {
    counter!("tyndall_tasks_ended_total", "outcome" => outcome).increment(1);
    histogram!("tyndall_task_seconds").record(took.as_secs_f64());
}

/// What the queue of jobs holds.
pub(crate) fn queue(counts: Counts) {
    let whole = |count: u64| count as f64;
    gauge!("tyndall_jobs_open").set(whole(counts.open_jobs));
    gauge!("tyndall_tasks_queued").set(whole(counts.queued_tasks));
    gauge!("tyndall_tasks_leased").set(whole(counts.leased_tasks));
    gauge!("tyndall_tasks_dead").set(whole(counts.dead_tasks));
}
