//! Priority of compute threads: lower than that of the API and the heartbeat, so that these get a core when they need
//! one.

/// A tenth of the share of a processor that those which answer have when both want it.
const NICENESS: i32 = 10;

/// Lowers the priority of this thread and of those that it starts (Linux). A refusal by the system changes no result.
pub fn lower_priority() {
    let _ = rustix::process::nice(NICENESS);
}
