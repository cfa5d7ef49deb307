//! Minimum transfer rate of clients, in windows of time: a fast start does not excuse a later stall.

use std::io;
use std::pin::Pin;
use std::task::{Context, Poll, ready};
use std::time::{Duration, Instant};

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::time::Sleep;

/// Bytes a second.
const LEAST_RATE: f64 = 16.0 * 1024.0;

/// Bytes in the open window. Only time in which the service waited for the client counts.
#[derive(Debug)]
pub struct Pace {
    window: Duration,
    waited: Duration,
    moved: usize,
}

impl Pace {
    pub fn new(window: Duration) -> Pace {
        Pace { window, waited: Duration::ZERO, moved: 0 }
    }

    /// Counts bytes transferred after a wait; false if a window with too few is over.
    pub fn keeps(&mut self, bytes: usize, waited: Duration) -> bool {
        self.moved += bytes;
        self.waited += waited;
        if self.waited < self.window {
            return true;
        }
        let keeps = self.moved as f64 >= LEAST_RATE * self.waited.as_secs_f64();
        *self = Pace::new(self.window);
        keeps
    }

    /// How long the window stays open.
    fn left(&self) -> Duration {
        self.window.saturating_sub(self.waited)
    }
}

/// A connection whose client has to read at a minimum rate.
pub struct Paced<S> {
    stream: S,
    pace: Pace,
    /// Since when nothing more could be sent, and the end of the window.
    blocked: Option<(Instant, Pin<Box<Sleep>>)>,
}

impl<S> Paced<S> {
    pub fn new(stream: S, window: Duration) -> Paced<S> {
        Paced { stream, pace: Pace::new(window), blocked: None }
    }

    /// The result of an attempt to send: an error if the client has read too slowly.
    fn sent(
        &mut self,
        context: &mut Context<'_>,
        sent: Poll<io::Result<usize>>,
    ) -> Poll<io::Result<usize>> {
        let bytes = match &sent {
            Poll::Ready(Ok(bytes)) => *bytes,
            Poll::Ready(Err(_)) => return sent,
            Poll::Pending => return self.wait(context),
        };
        let waited = self.blocked.take().map_or(Duration::ZERO, |(since, _)| since.elapsed());
        if self.pace.keeps(bytes, waited) { sent } else { Poll::Ready(Err(too_slow())) }
    }

    fn wait(&mut self, context: &mut Context<'_>) -> Poll<io::Result<usize>> {
        let left = self.pace.left();
        let begin = || (Instant::now(), Box::pin(tokio::time::sleep(left)));
        let (since, over) = self.blocked.get_or_insert_with(begin);
        ready!(over.as_mut().poll(context));
        let waited = since.elapsed();
        self.blocked = None;
        match self.pace.keeps(0, waited) {
            // A new window begins at once.
            true => self.wait(context),
            false => Poll::Ready(Err(too_slow())),
        }
    }
}

fn too_slow() -> io::Error {
    io::Error::new(io::ErrorKind::TimedOut, "the client reads its response too slowly")
}

impl<S: AsyncRead + Unpin> AsyncRead for Paced<S> {
    fn poll_read(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().stream).poll_read(context, buffer)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Paced<S> {
    fn poll_write(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let own = self.get_mut();
        let sent = Pin::new(&mut own.stream).poll_write(context, bytes);
        own.sent(context, sent)
    }

    fn poll_write_vectored(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let own = self.get_mut();
        let sent = Pin::new(&mut own.stream).poll_write_vectored(context, parts);
        own.sent(context, sent)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().stream).poll_flush(context)
    }

    fn poll_shutdown(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().stream).poll_shutdown(context)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Duration = Duration::from_secs(30);

    fn ends_after(mut pace: Pace, bytes: usize, every: Duration) -> Option<Duration> {
        let waits = (1..1000).map(|number| every * number);
        waits.into_iter().find(|_| !pace.keeps(bytes, every))
    }

    #[test]
    fn what_came_at_once_is_no_excuse_for_what_trickles_after_it() {
        let mut pace = Pace::new(WINDOW);
        assert!(pace.keeps(200 << 20, Duration::from_secs(1)));
        let seconds = ends_after(pace, 1, Duration::from_secs(5)).map(|time| time.as_secs());
        assert_eq!(seconds, Some(60), "the first window passes, the second does not");
    }

    #[test]
    fn the_least_pace_is_enough_and_less_is_not() {
        let second = Duration::from_secs(1);
        assert_eq!(ends_after(Pace::new(WINDOW), 16 << 10, second), None);
        assert_eq!(ends_after(Pace::new(WINDOW), 15 << 10, second), Some(WINDOW));
    }
}
