//! How the time of a quick run is divided: over its scenes, and over what is measured of each.
//!
//! All of it is wall time, so that a slow or busy machine measures less instead of taking longer.
//! Pipelines, warm-up frames and error measures come on top.

/// Of a whole run. Unit: s.
const RUN: f64 = 170.0;
/// Of one scene at most: few scenes are measured as many are, by the same kept truths. Unit: s.
const SCENE: f64 = 24.0;
/// Shares of a scene's time. The rows' share is what the longest of them take: most need less.
const TRUTH: f64 = 0.20;
const ROWS: f64 = 0.35;
const FRAMES: f64 = 0.06;
const REST: f64 = 0.06;
const MOTION_TRUTH: f64 = 0.10;
/// Rows of a scene that take all of their time.
const LONG_ROWS: f64 = 4.0;

/// Times of one scene. Unit: s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// One truth; there are two.
    pub truth: f64,
    /// One row.
    pub row: f64,
    /// Frames of the moving camera.
    pub frames: f64,
    /// Samples at rest that follow them.
    pub rest: f64,
    /// What those are judged by.
    pub motion_truth: f64,
}

impl Budget {
    /// Of a quick run over so many scenes.
    pub fn quick(scenes: usize) -> Self {
        let scene = (RUN / scenes.max(1) as f64).min(SCENE);
        Self {
            truth: TRUTH * scene,
            row: ROWS / LONG_ROWS * scene,
            frames: FRAMES * scene,
            rest: REST * scene,
            motion_truth: MOTION_TRUTH * scene,
        }
    }

    /// Of a thorough run: settings, not time, end most of it.
    pub fn thorough() -> Self {
        Self {
            truth: 600.0,
            row: 60.0,
            frames: 600.0,
            rest: 60.0,
            motion_truth: 240.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quick_run_keeps_to_its_time_however_many_scenes_it_has() {
        for scenes in [0, 1, 7, 40] {
            let b = Budget::quick(scenes);
            let scene = 2.0 * b.truth + LONG_ROWS * b.row + b.frames + b.rest + b.motion_truth;
            assert!(scene <= SCENE && scene * scenes as f64 <= RUN, "{scenes}");
            assert!(scene > 0.0);
        }
    }
}
