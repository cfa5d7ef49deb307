//! Memory of the machine and of a process, and the bound that a slot puts on itself.

use std::path::Path;

use rustix::process::{Resource, Rlimit, setrlimit};
use serde::{Deserialize, Serialize};

use crate::config::Config;

/// How many times its budget a job may take: the memory of matrix and solver is estimated to within a third, and results stand
/// beside them.
pub const ROOM: f64 = 1.5;

const MIB: u64 = 1 << 20;
/// Where the machine does not tell.
const UNKNOWN_MACHINE: u64 = 4096 * MIB;
/// Below this not even a small job runs.
const LEAST: u64 = 256 * MIB;

/// The memory of a process.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Usage {
    pub now_bytes: u64,
    /// The most since it began, or since a study forgot it.
    pub peak_bytes: u64,
}

/// The most memory of one slot: as set, or an equal share of three quarters of what there is. The rest is for the
/// API, its caches and the file system.
pub fn slot_bytes(config: &Config) -> u64 {
    let share = || {
        let there = available().unwrap_or(UNKNOWN_MACHINE);
        (there / 4 * 3 / config.workers.max(1) as u64).max(LEAST)
    };
    config.slot_memory_bytes.unwrap_or_else(share)
}

/// Bytes of memory that this process may use: those of the machine, or of its control group.
fn available() -> Option<u64> {
    let memory = std::fs::read_to_string("/proc/meminfo").ok()?;
    let machine = kilobytes(&memory, "MemTotal:")?;
    let groups = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    Some(group_limits(&groups).fold(machine, u64::min))
}

/// The limits of the control groups that a process is in, and of those around them.
fn group_limits(groups: &str) -> impl Iterator<Item = u64> {
    let unified = groups.lines().find_map(|line| line.strip_prefix("0::")).unwrap_or("/");
    let path = Path::new("/sys/fs/cgroup").join(unified.trim_start_matches('/'));
    let limits: Vec<u64> = path
        .ancestors()
        .take_while(|folder| folder.starts_with("/sys/fs/cgroup"))
        .map(|folder| folder.join("memory.max"))
        .chain([Path::new("/sys/fs/cgroup/memory/memory.limit_in_bytes").to_owned()])
        .filter_map(|file| std::fs::read_to_string(file).ok()?.trim().parse().ok())
        .collect();
    limits.into_iter()
}

/// What a process takes, where the system tells; `self` or a number names it.
pub fn usage(process: &str) -> Option<Usage> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    Some(Usage {
        now_bytes: kilobytes(&status, "VmRSS:")?,
        peak_bytes: kilobytes(&status, "VmHWM:")?,
    })
}

/// The value of a line `NAME: n kB`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let count: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(count * 1024)
}

/// Bounds the memory of this process: an allocation beyond it fails, and the process ends with a message. The bound
/// is on memory that is its own and may be written, since that is what a solver asks for; addresses that are only
/// reserved cost nothing. No dump of a process that ends badly reaches a disk: it would hold a patient's face. Of all
/// processes the system takes this one first when the machine runs out.
pub fn bound(bytes: u64) -> std::io::Result<()> {
    let at_most = |bytes: u64| Rlimit { current: Some(bytes), maximum: Some(bytes) };
    setrlimit(Resource::Data, at_most(bytes))?;
    setrlimit(Resource::Core, at_most(0))?;
    // Only Linux knows it, and there it may be forbidden; the bound holds all the same.
    let _ = std::fs::write("/proc/self/oom_score_adj", "800");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slot_gets_an_equal_share_unless_it_is_set() {
        let config = |given: &'static [(&str, &str)]| {
            let value = |name: &str| given.iter().find(|(key, _)| *key == name);
            Config::new(|name| value(name).map(|(_, value)| (*value).to_owned())).unwrap()
        };
        let of = |workers| slot_bytes(&config(workers));
        let (one, four) = (of(&[("workers", "1")]), of(&[("workers", "4")]));
        assert!(four == LEAST || one.abs_diff(4 * four) < 16, "{one} {four}");
        assert_eq!(of(&[("slot-memory-mib", "300")]), 300 * MIB);
    }

    #[test]
    fn a_process_tells_what_it_takes() {
        let Some(usage) = usage("self") else { return };
        assert!(usage.now_bytes > MIB && usage.peak_bytes >= usage.now_bytes);
        assert_eq!(kilobytes("VmRSS:\t  12 kB\n", "VmRSS:"), Some(12 * 1024));
        assert_eq!(kilobytes("VmRSS:\t  12\n", "VmRSS:"), None);
    }
}
