//! A processor that the API or the heartbeat wants is theirs: they need it for a moment, what computes for seconds.

/// A tenth of the share of a processor that those which answer have when both want it.
const NICENESS: i32 = 10;

/// Lets this thread, and those that it starts, give way (Linux). Whether the system agrees changes no result.
pub fn lower_priority() {
    let _ = rustix::process::nice(NICENESS);
}
