//! Child process of a slot: start, messages, kill and exit status.

use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Write};
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use bytes::Bytes;

use super::memory::{self, Usage};
use super::protocol::{Order, Report, Settings, encode, read_message};
use crate::worker::fail_point;

/// Lines of standard error that are kept to tell how a process died.
const LAST_LINES: usize = 20;
/// A longer line is cut in the log.
const LONGEST_LINE: usize = 2000;

/// How to start the process of a slot.
#[derive(Clone, Debug)]
pub struct Program {
    pub file: std::path::PathBuf,
    pub arguments: Vec<String>,
}

impl Program {
    /// This program itself, with the command that makes it a slot. The link that Linux keeps stays with the program
    /// that runs, even when another version has been put in its place.
    pub fn this(log_filter: &str) -> io::Result<Program> {
        let link = std::path::Path::new("/proc/self/exe");
        let file = if link.exists() { link.to_owned() } else { std::env::current_exe()? };
        let arguments = ["slot", "--log-level", log_filter].map(str::to_owned).to_vec();
        Ok(Program { file, arguments })
    }
}

/// Cause of an unexpected end of a process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Death {
    /// An allocation of so many bytes was refused.
    OutOfMemory {
        asked_bytes: u64,
    },
    StackOverflow,
    Signal(i32),
    Exit(i32),
    Unknown,
}

impl Death {
    /// Rust ends a process with SIGABRT after one line on standard error, for lack of memory as for a full stack.
    fn read(status: Option<ExitStatus>, last_lines: &VecDeque<String>) -> Death {
        let asked = last_lines.iter().rev().find_map(|line| {
            let rest = line.split("memory allocation of ").nth(1)?;
            rest.strip_suffix(" failed")?.strip_suffix(" bytes")?.parse().ok()
        });
        let overflowed = last_lines.iter().any(|line| line.ends_with("has overflowed its stack"));
        match (status.and_then(|status| status.signal()), asked) {
            (Some(_), Some(asked_bytes)) => Death::OutOfMemory { asked_bytes },
            (Some(_), None) if overflowed => Death::StackOverflow,
            (Some(signal), None) => Death::Signal(signal),
            (None, _) => {
                status.and_then(|status| status.code()).map_or(Death::Unknown, Death::Exit)
            }
        }
    }

    /// A word for counters.
    pub fn name(&self) -> &'static str {
        match self {
            Death::OutOfMemory { .. } => "out-of-memory",
            Death::StackOverflow => "stack-overflow",
            Death::Signal(_) => "signal",
            Death::Exit(_) | Death::Unknown => "exit",
        }
    }
}

impl std::fmt::Display for Death {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Death::OutOfMemory { asked_bytes } => {
                write!(formatter, "an allocation of {asked_bytes} bytes was refused")
            }
            Death::StackOverflow => formatter.write_str("its stack was full"),
            Death::Signal(signal) => write!(formatter, "signal {signal} ended it"),
            Death::Exit(code) => write!(formatter, "it ended with exit code {code}"),
            Death::Unknown => formatter.write_str("it ended"),
        }
    }
}

/// Output of a process within some time.
pub enum Output {
    Report(Report),
    Nothing,
    /// It has ended, or closed its output.
    Gone,
}

/// The last lines of standard error, and whose they are.
#[derive(Default)]
struct Log {
    job: Option<(String, i64)>,
    last_lines: VecDeque<String>,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A process that runs. It is killed when this is dropped.
pub struct Process {
    child: Child,
    orders: Option<Sender<Bytes>>,
    reports: Receiver<Report>,
    log: Arc<Mutex<Log>>,
    threads: Vec<JoinHandle<()>>,
    /// Jobs that ended in it.
    pub jobs: usize,
}

impl Process {
    /// Starts it on the calling thread, with which the system lets it end. Of the environment, which may hold keys, it
    /// gets no more than what is named here; not the wish for traces of failures either, for which a process that has
    /// just used up its memory has none.
    pub fn start(program: &Program, settings: &Settings) -> io::Result<Process> {
        let passed = std::env::var_os(fail_point::VARIABLE);
        let passed = passed.map(|faults| (fail_point::VARIABLE, faults));
        let mut child = Command::new(&program.file)
            .arg0("facies")
            .args(&program.arguments)
            .env_clear()
            .envs(passed)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let (orders, to_write) = channel();
        let (heard, reports) = channel();
        let log = Arc::new(Mutex::new(Log::default()));
        let mut process =
            Process { child, orders: Some(orders), reports, log, threads: Vec::new(), jobs: 0 };
        let (Some(stdin), Some(stdout), Some(stderr)) = pipes else {
            return Err(io::Error::other("a process without pipes"));
        };
        let log = process.log.clone();
        process.spawn("slot-orders", move || write_orders(stdin, &to_write))?;
        process.spawn("slot-reports", move || read_reports(stdout, &heard))?;
        process.spawn("slot-log", move || read_log(stderr, &log))?;
        process.tell(&Order::Start(Box::new(settings.clone())))?;
        Ok(process)
    }

    fn spawn(&mut self, name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
        self.threads.push(std::thread::Builder::new().name(name.to_owned()).spawn(work)?);
        Ok(())
    }

    /// Sends an order. One that does not arrive is noticed by the silence that follows.
    pub fn tell(&self, order: &Order) -> io::Result<()> {
        self.give(encode(order)?.into());
        Ok(())
    }

    /// Sends bytes as they are.
    pub fn give(&self, bytes: Bytes) {
        if let Some(orders) = &self.orders {
            // A writer that is gone has met a closed pipe.
            let _ = orders.send(bytes);
        }
    }

    pub fn receive(&self, wait: Duration) -> Output {
        match self.reports.recv_timeout(wait) {
            Ok(report) => Output::Report(report),
            Err(RecvTimeoutError::Timeout) => Output::Nothing,
            Err(RecvTimeoutError::Disconnected) => Output::Gone,
        }
    }

    /// Asks it, while it has no job, whether it can take one: it says [`Report::Ready`], or dies or stands still.
    pub fn ping(&self, wait: Duration) -> Output {
        // Where it cannot be asked it does not answer.
        let _ = self.tell(&Order::Ping);
        self.receive(wait)
    }

    /// Assigns the lines on standard error from here on to a job.
    pub fn set_log_owner(&self, job: Option<(&str, i64)>) {
        lock(&self.log).job = job.map(|(job, attempt)| (job.to_owned(), attempt));
    }

    pub fn usage(&self) -> Option<Usage> {
        memory::usage(&self.child.id().to_string())
    }

    /// Kills it if it still runs, and says how it ended.
    pub fn end(mut self) -> Death {
        let status = self.kill();
        Death::read(status, &lock(&self.log).last_lines)
    }

    fn kill(&mut self) -> Option<ExitStatus> {
        // An output that is closed is the last that a dying process does: its own death is reported, not ours.
        let mut ended = self.child.try_wait().ok().flatten();
        for _ in 0..50 {
            if ended.is_some() || !matches!(self.receive(Duration::ZERO), Output::Gone) {
                break;
            }
            std::thread::sleep(Duration::from_millis(2));
            ended = self.child.try_wait().ok().flatten();
        }
        if ended.is_none() {
            // It may have ended in between.
            let _ = self.child.kill();
            ended = self.child.wait().ok();
        }
        self.orders.take();
        for thread in self.threads.drain(..) {
            // A panic of the thread has been reported where it happened.
            let _ = thread.join();
        }
        ended
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

/// Writes on a thread of its own: a process that does not read never holds up the worker that has to kill it.
fn write_orders(mut to: ChildStdin, orders: &Receiver<Bytes>) {
    while let Ok(bytes) = orders.recv() {
        if to.write_all(&bytes).and_then(|()| to.flush()).is_err() {
            return;
        }
    }
}

fn read_reports(from: ChildStdout, heard: &Sender<Report>) {
    let mut from = BufReader::new(from);
    while let Ok(Some(report)) = read_message(&mut from) {
        if heard.send(report).is_err() {
            return;
        }
    }
}

/// Every line goes to the log of the worker under the job that wrote it.
fn read_log(from: ChildStderr, log: &Mutex<Log>) {
    let mut from = BufReader::new(from);
    let mut bytes = Vec::new();
    while matches!(from.read_until(b'\n', &mut bytes), Ok(count) if count > 0) {
        let text = String::from_utf8_lossy(&bytes);
        let line: String = text.trim_end().chars().take(LONGEST_LINE).collect();
        bytes.clear();
        if line.is_empty() {
            continue;
        }
        let mut log = lock(log);
        match &log.job {
            Some((job, attempt)) => {
                tracing::warn!(job.id = %job, attempt, line, "a slot says");
            }
            None => tracing::warn!(line, "a slot says"),
        }
        log.last_lines.push_back(line);
        if log.last_lines.len() > LAST_LINES {
            log.last_lines.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn death(raw: i32, line: &str) -> Death {
        Death::read(Some(ExitStatus::from_raw(raw)), &VecDeque::from([line.to_owned()]))
    }

    #[test]
    fn a_death_is_read_from_its_signal_and_its_last_words() {
        const ABORT: i32 = 6;
        let asked = death(ABORT, "memory allocation of 65536 bytes failed");
        assert_eq!(asked, Death::OutOfMemory { asked_bytes: 65536 });
        let full = death(ABORT, "thread 'solver-0' (7) has overflowed its stack");
        assert_eq!(full, Death::StackOverflow);
        assert_eq!(death(ABORT, "assertion failed"), Death::Signal(ABORT));
        assert_eq!(death(9, ""), Death::Signal(9));
        // A process that goes on after such a line did not die of it.
        assert_eq!(death(3 << 8, "memory allocation of 1 bytes failed"), Death::Exit(3));
    }
}
