//! The signal of a write beyond the limit on the size of files (RLIMIT_FSIZE).

use tokio::signal::unix::{SignalKind, signal};

/// Turns such a write into an error of that write, as on a full disk, and not the end of the process: a signal with a
/// listener does not kill. What listens stays when the runtime that it needs is gone.
pub fn ignore_file_size_signal() -> std::io::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let _inside = runtime.enter();
    signal(SignalKind::from_raw(rustix::process::Signal::XFSZ.as_raw())).map(drop)
}
