//! Ends the process when its time to go down is over, whatever still runs: a dispatch on the device and a
//! scene being built hear no signal.

use std::thread::Builder;
use std::time::Duration;

use tokio_util::sync::CancellationToken;

/// How long the system's own end of a process may take; drivers wait for their threads there.
const EXIT_WITHIN: Duration = Duration::from_secs(1);

/// Waits for shutdown, then starts the clock.
pub(crate) async fn watch(shutdown: CancellationToken, within: Duration) {
    shutdown.cancelled().await;
    let end = move || {
        std::thread::sleep(within);
        tracing::error!(?within, "something still runs: the process ends now");
        let exit = Builder::new().name("exit".to_owned());
        if exit.spawn(|| std::process::exit(1)).is_ok() {
            std::thread::sleep(EXIT_WITHIN);
        }
        std::process::abort();
    };
    if let Err(error) = Builder::new().name("watchdog".to_owned()).spawn(end) {
        tracing::error!(%error, "no watchdog could be started");
    }
}
