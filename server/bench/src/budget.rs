//! How the time of a quick run is divided: over its scenes, and over what is measured of each.
//!
//! All of it is wall time, so that a slow or busy machine measures less instead of taking longer.
//! Pipelines, warm-up frames and error measures come on top.

/// Time of a whole quick run, however many scenes it has. Unit: s.
const RUN: f64 = 170.0;
/// Longest time of one scene: a run over few scenes gives each as much as a run over seven would, so that
/// truths kept by one serve the other. Unit: s.
const SCENE: f64 = 24.0;
/// Shares of a scene's time. The rows' share is for the rows that use up their time: the others end
/// earlier.
const TRUTH: f64 = 0.20;
const ROWS: f64 = 0.35;
const FRAMES: f64 = 0.06;
const REST: f64 = 0.06;
const MOTION_TRUTH: f64 = 0.10;
/// How many rows of a scene use up their time.
const LONG_ROWS: f64 = 4.0;

/// Longest times of the measurements of one scene. Unit: s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// One truth: all paths, or those of at most one scattering.
    pub truth: f64,
    /// One row: a technique at one setting.
    pub row: f64,
    /// Frames of the moving camera.
    pub frames: f64,
    /// Samples at rest, taken after the frames.
    pub rest: f64,
    /// The converged picture that frames and samples at rest are judged by.
    pub motion_truth: f64,
}

impl Budget {
    /// Divides a quick run's time over so many scenes.
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

    /// Times of a thorough run, so long that most measurements end with their last sample instead.
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
