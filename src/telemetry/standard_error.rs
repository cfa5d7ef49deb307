//! Non-blocking log lines on standard error. Where a pipe is full because nobody reads it, one line waits for a moment;
//! it and those after it are dropped, and counted, until there is room again.

use std::io::{self, Write};
use std::sync::{Mutex, PoisonError};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::retry_on_intr;

use crate::metrics;

/// How long a reader may fall behind before lines are dropped.
const MOMENT: Timespec = Timespec { tv_sec: 0, tv_nsec: 100_000_000 };
const AT_ONCE: Timespec = Timespec { tv_sec: 0, tv_nsec: 0 };
/// A pipe that takes anything takes this much without waiting (PIPE_BUF of Linux).
const PIECE: usize = 4096;

/// Whether the last line was dropped. One line is written at a time, so that nobody takes the room that another has found.
static IS_FULL: Mutex<bool> = Mutex::new(false);

/// Takes a whole line with each write, and never fails: what logs could do nothing about it.
pub struct Lines;

impl Write for Lines {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        let mut is_full = IS_FULL.lock().unwrap_or_else(PoisonError::into_inner);
        let wait = if *is_full { AT_ONCE } else { MOMENT };
        let mut pieces = line.chunks(PIECE);
        *is_full = !pieces.all(|piece| has_room(&wait) && io::stderr().write_all(piece).is_ok());
        if *is_full {
            metrics::log_line_dropped();
        }
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn has_room(wait: &Timespec) -> bool {
    let standard_error = io::stderr();
    let mut asked = [PollFd::new(&standard_error, PollFlags::OUT)];
    // What cannot be asked does not make anybody wait.
    !matches!(retry_on_intr(|| poll(&mut asked, Some(wait))), Ok(0))
}
