//! Why a measurement failed.

use tyndall_metrics::MetricError;
use tyndall_render::RenderError;

/// Why a measurement failed.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The scene could not be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// Two pictures could not be compared.
    #[error(transparent)]
    Metric(#[from] MetricError),
}
