//! The limits of `tyndall serve`, an option each.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use clap::Args;
use tyndall_render::MemoryBudget;
use tyndall_service::{JobLimits, ServiceLimits};

use crate::scene_argument;

/// How much of everything there may be.
#[derive(Debug, Clone, Args)]
pub struct LimitArguments {
    /// Connected sessions.
    #[arg(long, default_value_t = ServiceLimits::default().max_sessions, value_parser = at_least_one)]
    max_sessions: usize,
    /// HTTP connections open at once, besides WebSockets.
    #[arg(long, default_value_t = ServiceLimits::default().max_connections, value_parser = at_least_one)]
    max_connections: usize,
    /// Pixels of the largest picture.
    #[arg(long, default_value_t = ServiceLimits::default().max_pixels, value_parser = clap::value_parser!(u64).range(1..))]
    max_pixels: u64,
    /// Longest side of a picture in pixels.
    #[arg(long, default_value_t = ServiceLimits::default().max_side, value_parser = clap::value_parser!(u32).range(1..))]
    max_side: u32,
    /// Longest message of a client in bytes.
    #[arg(long, default_value_t = ServiceLimits::default().max_message_bytes, value_parser = at_least_one)]
    max_message_bytes: usize,
    /// Longest body of a request in bytes.
    #[arg(long, default_value_t = ServiceLimits::default().max_body_bytes, value_parser = at_least_one)]
    max_body_bytes: usize,
    /// How long a dropped session can be resumed.
    #[arg(long, value_name = "TIME", default_value_t = Time(ServiceLimits::default().resume_for))]
    resume_for: Time,
    /// How long the head of a request may take, and a connection may rest between two.
    #[arg(long, value_name = "TIME", default_value_t = Time(ServiceLimits::default().header_within))]
    header_within: Time,
    /// How long the body of a request may take.
    #[arg(long, value_name = "TIME", default_value_t = Time(ServiceLimits::default().body_within))]
    body_within: Time,
    /// How long planning a posted scene may take.
    #[arg(long, value_name = "TIME", default_value_t = Time(ServiceLimits::default().plan_within))]
    plan_within: Time,
    /// How long a new socket may take to say hello.
    #[arg(long, value_name = "TIME", default_value_t = Time(ServiceLimits::default().hello_within))]
    hello_within: Time,
    /// How often a silent socket is probed; after three probes without an answer it is closed.
    #[arg(long, value_name = "TIME", default_value_t = Time(ServiceLimits::default().ping_every))]
    ping_every: Time,
    /// How long a client may take nothing of what it is sent.
    #[arg(long, value_name = "TIME", default_value_t = Time(ServiceLimits::default().send_within))]
    send_within: Time,
    /// How long going down may take; then the process ends, whatever still runs.
    #[arg(long, value_name = "TIME", default_value_t = Time(ServiceLimits::default().drain_within))]
    drain_within: Time,
    /// Share of its time that the edits of one session may take of a processor core, in percent.
    #[arg(long, default_value_t = ServiceLimits::default().edit_percent, value_parser = clap::value_parser!(u32).range(1..=100))]
    edit_percent: u32,
    /// Threads that compress pictures.
    #[arg(long, default_value_t = ServiceLimits::default().encoder_threads, value_parser = at_least_one)]
    encoder_threads: usize,
    /// What a frame of a moving picture may take: its size follows. 33ms on a GPU, 100ms without one.
    #[arg(long, value_name = "TIME")]
    frame_budget: Option<Time>,
    /// Jobs that are not over.
    #[arg(long, default_value_t = JobLimits::default().max_open_jobs, value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    max_open_jobs: u64,
    /// Bytes of all files that come with a job.
    #[arg(long, default_value_t = JobLimits::default().max_upload_bytes, value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    max_upload_bytes: u64,
    /// How long jobs that are over are kept, in hours.
    #[arg(long, value_name = "HOURS", default_value_t = JobLimits::default().keep_for.as_secs() / 3600, value_parser = clap::value_parser!(u64).range(1..=1 << 20))]
    keep_jobs: u64,
    /// Device memory that one picture may take, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = MemoryBudget::default().per_view >> 20, value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    picture_memory: u64,
    /// Device memory that all pictures, geometry and grids together may take, in MiB.
    #[arg(long, value_name = "MIB", default_value_t = MemoryBudget::default().in_all >> 20, value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    device_memory: u64,
}

impl LimitArguments {
    /// The service's limits.
    pub fn limits(&self) -> ServiceLimits {
        ServiceLimits {
            max_sessions: self.max_sessions,
            max_connections: self.max_connections,
            max_pixels: self.max_pixels,
            max_side: self.max_side,
            max_message_bytes: self.max_message_bytes,
            max_body_bytes: self.max_body_bytes,
            resume_for: self.resume_for.0,
            header_within: self.header_within.0,
            body_within: self.body_within.0,
            plan_within: self.plan_within.0,
            hello_within: self.hello_within.0,
            ping_every: self.ping_every.0,
            send_within: self.send_within.0,
            drain_within: self.drain_within.0,
            edit_percent: self.edit_percent,
            encoder_threads: self.encoder_threads,
            frame_budget: self.frame_budget.map(|budget| budget.0),
        }
    }

    /// The bounds of jobs.
    pub fn jobs(&self) -> JobLimits {
        JobLimits {
            max_open_jobs: self.max_open_jobs,
            max_upload_bytes: self.max_upload_bytes,
            keep_for: Duration::from_secs(3600 * self.keep_jobs),
        }
    }

    /// The device's memory.
    pub fn memory(&self) -> MemoryBudget {
        MemoryBudget {
            per_view: self.picture_memory << 20,
            in_all: self.device_memory << 20,
        }
    }
}

fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) => Err("allowed are 1 and more".to_owned()),
        Ok(number) => Ok(number),
        Err(error) => Err(format!("{error}: allowed are 1 and more")),
    }
}

/// A time of at least a millisecond and at most a day, as it is written on the command line.
#[derive(Debug, Clone, Copy)]
struct Time(Duration);

impl fmt::Display for Time {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}s", self.0.as_secs_f64())
    }
}

impl FromStr for Time {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let seconds = scene_argument::seconds(text)?;
        if !(1e-3..=86_400.0).contains(&seconds) {
            return Err(format!("{text}: allowed are 1ms to 1440m"));
        }
        Ok(Self(Duration::from_secs_f64(seconds)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        limits: LimitArguments,
    }

    #[test]
    fn without_options_the_defaults_hold_and_each_option_changes_one() {
        let line = Line::parse_from(["serve"]).limits;
        assert_eq!(line.limits(), ServiceLimits::default());
        assert_eq!(line.memory(), MemoryBudget::default());
        assert_eq!(line.jobs(), JobLimits::default());
        let line = Line::parse_from(["serve", "--drain-within", "500ms", "--max-side", "64"]);
        let expected = ServiceLimits {
            drain_within: Duration::from_millis(500),
            max_side: 64,
            ..ServiceLimits::default()
        };
        assert_eq!(line.limits.limits(), expected);
        for wrong in [
            ["--max-sessions", "0"],
            ["--ping-every", "0s"],
            ["--edit-percent", "101"],
        ] {
            assert!(Line::try_parse_from([["serve"].as_slice(), &wrong].concat()).is_err());
        }
    }
}
