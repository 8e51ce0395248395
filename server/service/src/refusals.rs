//! Says in the log why requests are refused, at most once a second, so that nobody can fill the disk.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use crate::bell::lock;

/// Rest between two lines.
const EVERY: Duration = Duration::from_secs(1);

/// When the next refusal is logged, and how many were not since the last one.
#[derive(Debug, Default)]
pub(crate) struct Refusals {
    state: Mutex<(Option<Instant>, u64)>,
}

impl Refusals {
    /// Logs a refusal, or counts it for the next line.
    pub(crate) fn log(&self, why: &str) {
        if let Some(others) = self.admit(Instant::now()) {
            tracing::warn!(others, "a request was refused: {why}");
        }
    }

    /// How many refusals went unsaid before one that may be logged now.
    fn admit(&self, now: Instant) -> Option<u64> {
        let mut state = lock(&self.state);
        let (next, unsaid) = &mut *state;
        if next.is_some_and(|next| now < next) {
            *unsaid += 1;
            return None;
        }
        *next = Some(now + EVERY);
        Some(std::mem::take(unsaid))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_refusal_a_second_is_logged_and_the_others_are_counted() {
        let refusals = Refusals::default();
        let start = Instant::now();
        assert_eq!(refusals.admit(start), Some(0));
        for _ in 0..1000 {
            assert_eq!(refusals.admit(start + EVERY / 2), None);
        }
        assert_eq!(refusals.admit(start + EVERY), Some(1000));
    }
}
