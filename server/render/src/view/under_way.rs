//! A frame that is submitted part by part.

use std::collections::VecDeque;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::engine::{Device, FrameTiming, Recorded};
use crate::error::RenderError;
use crate::picture::{Share, Work};

/// A frame of which parts are not submitted yet.
pub(crate) struct UnderWay {
    /// What the caller of the frame named it.
    pub tag: u64,
    pub started: Instant,
    pub work: Work,
    pub share: Share,
    pub timing: FrameTiming,
    left: VecDeque<wgpu::CommandBuffer>,
    /// The part that was submitted last, and whether the device is done with it.
    last: Option<(wgpu::SubmissionIndex, Arc<AtomicBool>)>,
}

impl fmt::Debug for UnderWay {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("UnderWay")
            .field("tag", &self.tag)
            .field("left", &self.left.len())
            .finish_non_exhaustive()
    }
}

impl UnderWay {
    /// A recorded frame of which nothing is submitted.
    pub fn new(tag: u64, started: Instant, (work, share): (Work, Share), frame: Recorded) -> Self {
        Self {
            tag,
            started,
            work,
            share,
            timing: frame.timing,
            left: frame.parts,
            last: None,
        }
    }

    /// Submits the next part, unless the device still works on the one before; returns the submission of
    /// the last part once that is submitted.
    pub fn go_on(&mut self, device: &Device) -> Option<wgpu::SubmissionIndex> {
        let is_done = |(_, done): &(_, Arc<AtomicBool>)| done.load(Ordering::Acquire);
        if !self.last.as_ref().is_none_or(is_done) {
            return None;
        }
        let part = self.left.pop_front()?;
        let submission = device.queue.submit([part]);
        if self.left.is_empty() {
            return Some(submission);
        }
        let done = Arc::new(AtomicBool::new(false));
        let told = Arc::clone(&done);
        device
            .queue
            .on_submitted_work_done(move || told.store(true, Ordering::Release));
        self.last = Some((submission, done));
        None
    }

    /// Submits all that is left, and returns the submission of the last part.
    pub fn submit_all(&mut self, device: &Device) -> Result<wgpu::SubmissionIndex, RenderError> {
        let submission = device.queue.submit(self.left.drain(..));
        device.check()?;
        Ok(submission)
    }

    /// The part that was submitted last.
    pub fn submission(&self) -> Option<wgpu::SubmissionIndex> {
        self.last.as_ref().map(|(submission, _)| submission.clone())
    }
}
