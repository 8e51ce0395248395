//! `/`: the control page, embedded by `build.rs` from `web/dist`.

use axum::Router;
use memory_serve::CacheControl;

/// The page's files. Vite puts a hash into the names below `assets`, so only the HTML may change
/// under its name; it is revalidated each time, or a new server would get an old page.
#[allow(
    unused_qualifications,
    reason = "in the code that memory-serve generates"
)]
pub(super) fn router() -> Router {
    memory_serve::load!()
        .index_file(Some("/index.html"))
        .html_cache_control(CacheControl::NoCache)
        .cache_control(CacheControl::Medium)
        .enable_gzip(true)
        .enable_brotli(true)
        .into_router()
}
