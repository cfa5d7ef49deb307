//! What the system tells of this process and its caches, where it tells it.

/// The largest resident size so far, in MB.
pub fn peak_mb() -> f64 {
    status("VmHWM:")
}

/// The resident size now, in MB.
pub fn resident_mb() -> f64 {
    status("VmRSS:")
}

/// Lets the largest resident size begin again at the present one (proc(5), clear_refs).
pub fn reset_peak() {
    // Where that is not allowed the peak includes what came before, which only looks worse.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Seconds that all threads of this process have had a processor for.
pub fn cpu_seconds() -> f64 {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return f64::NAN };
    let on_processor = tasks.flatten().filter_map(|task| {
        let times = std::fs::read_to_string(task.path().join("schedstat")).ok()?;
        times.split_whitespace().next()?.parse::<f64>().ok()
    });
    on_processor.sum::<f64>() / 1e9
}

/// Size of the last level of cache of the first processor, as the system writes it.
pub fn last_level_cache() -> String {
    let level = |index| format!("/sys/devices/system/cpu/cpu0/cache/index{index}/size");
    let sizes = (0..5).rev().map(|index| std::fs::read_to_string(level(index)));
    sizes.flatten().next().map_or("unknown".to_owned(), |size| size.trim().to_owned())
}

fn status(name: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(name));
    let kilobytes = line.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.unwrap_or(f64::NAN) / 1024.0
}
