//! Processes as the system sees them.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::helpers::{Server, serve};

/// A condition that does not come true within this time fails its test.
const PATIENCE: Duration = Duration::from_secs(60);

/// A server whose processes break themselves as `FACIES_FAULT` says.
pub fn faulty(fault: &str, arguments: &[&str]) -> Server {
    faulty_in(TempDir::new().unwrap(), fault, arguments)
}

/// The same on what another server left.
pub fn faulty_in(folder: TempDir, fault: &str, arguments: &[&str]) -> Server {
    let mut command = serve(folder.path());
    command.args(arguments).env("FACIES_FAULT", fault);
    Server::start_command(command, folder)
}

/// The same with its log in a file.
pub fn faulty_with_log(fault: &str, arguments: &[&str], log: &Path) -> Server {
    let folder = TempDir::new().unwrap();
    let mut command = serve(folder.path());
    let log = std::fs::File::create(log).unwrap();
    command.args(arguments).env("FACIES_FAULT", fault).stderr(Stdio::from(log));
    Server::start_command(command, folder)
}

/// Waits until a condition holds.
pub async fn until<T>(what: &str, mut condition: impl AsyncFnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = condition().await {
            return found;
        }
        assert!(begun.elapsed() < PATIENCE, "{what} did not happen");
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
}

/// Whether something is done within a time, in one of five attempts: on a machine with other things to do it is late now and
/// then, and what waits for somebody who does not come is late each time.
pub async fn is_quick(within: Duration, mut attempt: impl AsyncFnMut()) -> bool {
    for _ in 0..5 {
        let begun = Instant::now();
        attempt().await;
        if begun.elapsed() < within {
            return true;
        }
    }
    false
}

/// A field of `/proc/PROCESS/status`, while the process is there.
fn status(process: u32, field: &str) -> Option<String> {
    let text = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(field)?.strip_prefix(':'));
    line.map(|value| value.trim().to_owned())
}

/// The memory of a process that is in use, in bytes.
pub fn resident(process: u32) -> f64 {
    let told = status(process, "VmRSS").unwrap();
    told.trim_end_matches(" kB").parse::<f64>().unwrap() * 1024.0
}

/// The processes of the slots of a server.
pub fn slots(server: &Server) -> Vec<u32> {
    slots_of(server.process())
}

/// The same of any process with workers.
pub fn slots_of(process: u32) -> Vec<u32> {
    let parent = process.to_string();
    let processes = std::fs::read_dir("/proc").unwrap().filter_map(|entry| {
        let process: u32 = entry.ok()?.file_name().to_str()?.parse().ok()?;
        let is_child = status(process, "PPid").as_deref() == Some(parent.as_str());
        (is_child && !is_gone(process)).then_some(process)
    });
    processes.collect()
}

/// The slot of a process with workers that stands still, once one does.
pub async fn stopped_slot(process: u32) -> u32 {
    until("a slot stands still", async || {
        slots_of(process).into_iter().find(|slot| is_stopped(*slot))
    })
    .await
}

/// What the descriptors of a process lead to.
pub fn descriptors(process: u32) -> Vec<String> {
    let files = std::fs::read_dir(format!("/proc/{process}/fd")).unwrap();
    let files = files.filter_map(|file| std::fs::read_link(file.ok()?.path()).ok());
    files.map(|file| file.to_string_lossy().into_owned()).collect()
}

pub fn is_gone(process: u32) -> bool {
    status(process, "State").is_none_or(|state| state.starts_with('Z'))
}

pub fn is_stopped(process: u32) -> bool {
    status(process, "State").is_some_and(|state| state.starts_with('T'))
}

/// Sends a signal by its name.
pub fn signal(process: u32, name: &str) {
    let sent = Command::new("kill").args([&format!("-{name}"), &process.to_string()]).status();
    assert!(sent.unwrap().success());
}
