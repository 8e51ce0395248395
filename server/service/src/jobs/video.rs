//! Frames to MP4 by ffmpeg, where there is one.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::process::Command;
use tyndall_jobs::{Results, ResultsError};
use tyndall_still::Progress;

use crate::stills::StillWatch;

/// How long ffmpeg may take for one frame, and for the end.
const FRAME_WITHIN: Duration = Duration::from_mins(1);
/// Longest part of ffmpeg's complaint that is kept. Unit: byte.
const COMPLAINT: u64 = 2000;

/// Why there is no video.
#[derive(Debug, thiserror::Error)]
pub(super) enum VideoError {
    #[error(transparent)]
    Results(#[from] ResultsError),
    #[error("ffmpeg cannot be run: {0}")]
    Io(#[from] io::Error),
    #[error("ffmpeg failed: {0}")]
    Failed(String),
    #[error("ffmpeg took longer than {} s for a frame", FRAME_WITHIN.as_secs())]
    TookTooLong,
}

/// The ffmpeg of the search path.
pub(super) fn find_ffmpeg() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let mut candidates = std::env::split_paths(&path).map(|folder| folder.join("ffmpeg"));
    candidates.find(|candidate| candidate.is_file())
}

/// The video of stored frames; `None` if it was stopped.
pub(super) async fn encode(
    ffmpeg: &Path,
    folder: &Path,
    results: &Results,
    frames: &[String],
    per_second: f64,
    watch: &StillWatch,
) -> Result<Option<Vec<u8>>, VideoError> {
    let file = tempfile::Builder::new()
        .suffix(".mp4")
        .tempfile_in(folder)?;
    let mut child = Command::new(ffmpeg)
        .args([
            "-v",
            "error",
            "-nostdin",
            "-y",
            "-f",
            "image2pipe",
            "-framerate",
        ])
        .arg(per_second.to_string())
        .args(["-i", "pipe:0", "-c:v", "libx264", "-pix_fmt", "yuv420p"])
        // The format takes even sides only.
        .args([
            "-vf",
            "pad=ceil(iw/2)*2:ceil(ih/2)*2",
            "-movflags",
            "+faststart",
            "-f",
            "mp4",
        ])
        .arg(file.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .kill_on_drop(true)
        .spawn()?;
    let (stdin, stderr) = (child.stdin.take(), child.stderr.take());
    let complaint = tokio::spawn(async move {
        let mut text = String::new();
        if let Some(stderr) = stderr {
            let mut start = stderr.take(COMPLAINT);
            // What cannot be read is left out of the message.
            start.read_to_string(&mut text).await.unwrap_or_default();
            let mut rest = start.into_inner();
            tokio::io::copy(&mut rest, &mut tokio::io::sink())
                .await
                .unwrap_or_default();
        }
        text
    });
    if let Some(mut stdin) = stdin {
        for (done, key) in (1_u64..).zip(frames) {
            if watch.is_stopped() {
                return Ok(None);
            }
            let bytes = results.get(key).await?;
            let written = tokio::time::timeout(FRAME_WITHIN, stdin.write_all(&bytes)).await;
            match written {
                Ok(Ok(())) => {}
                // It ended early and says why below.
                Ok(Err(_closed)) => break,
                Err(_elapsed) => return Err(VideoError::TookTooLong),
            }
            watch.set_progress(Progress {
                fraction: done as f32 / frames.len() as f32,
                frames: done,
                ..Progress::default()
            });
        }
    }
    let status = tokio::time::timeout(FRAME_WITHIN, child.wait()).await;
    let status = status.map_err(|_elapsed| VideoError::TookTooLong)??;
    if !status.success() {
        let text = complaint.await.unwrap_or_default();
        let one_line = text.split_whitespace().collect::<Vec<_>>().join(" ");
        return Err(VideoError::Failed(format!("{status}: {one_line}")));
    }
    Ok(Some(tokio::fs::read(file.path()).await?))
}
