//! Protocol between a worker and the process of its slot: frames over standard input and output.
//!
//! A frame is its length in eight bytes, little-endian, and a message in JSON. [`Answer::Bytes`] is followed by
//! one more frame, which holds the bytes of a blob as they are.

use std::io::{self, ErrorKind, Read, Write};
use std::path::PathBuf;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::memory::Usage;
use crate::library::meshes::MeshCard;
use crate::schema::Limits;
use crate::schema::predict::keep::MadeName;

/// The longest frame that is believed: a blob is a file that was accepted or made here.
const LONGEST: u64 = 1 << 36;

/// From the worker to the process.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    /// Comes first, once.
    Start(Box<Settings>),
    Work(Assignment),
    /// Asks whether work may come: [`Report::Ready`] is the answer of a process without work.
    Ping,
    /// Ends the work at its next check.
    Stop,
    Answer(Answer),
}

/// Settings of a process for its whole life.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Settings {
    pub limits: Limits,
    /// The most memory it may take.
    pub memory_bytes: u64,
    /// For parsed meshes that it keeps from job to job.
    pub cache_bytes: usize,
    pub threads: usize,
}

/// One attempt at a job.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Assignment {
    pub job: String,
    pub attempt: i64,
    /// From acceptance to start.
    pub queue_s: f64,
    /// The document of the job as it was queued.
    pub document: String,
    /// Where the files of the result go.
    pub folder: PathBuf,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    Mesh(MeshCard),
    /// The blob of a predicted skin, or of a model.
    Skin(String),
    /// The bytes follow.
    Bytes,
    /// There is nothing of that name.
    Unknown,
    /// Why, as clients are told it.
    Unreadable(String),
}

/// From the process to the worker.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Report {
    /// The settings are in force; work may come.
    Ready,
    /// A phase begins, by its name.
    Phase(String),
    /// A number that is not finite has no word in JSON.
    Iteration {
        iteration: usize,
        residual: Option<f64>,
        wanted: f64,
    },
    Step {
        done: usize,
        of: usize,
    },
    /// The work begins, and stops by itself after so many seconds.
    Budget {
        wall_s: f64,
    },
    Ask(Question),
    Ended(Box<AttemptReport>),
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Question {
    Mesh(String),
    /// The predicted skin of a job.
    Skin(String),
    /// What a job learned.
    Model(String),
    Blob(String),
}

/// How an attempt ended, and what the process takes now.
#[derive(Debug, Serialize, Deserialize)]
pub struct AttemptReport {
    pub outcome: Outcome,
    pub memory: Option<Usage>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    Done(Products),
    /// The job's own fault: JSON with `type` and `detail`.
    Failed(Value),
    Cancelled,
    /// The fault of a disk or of what is stored: JSON with `type` and `detail`, and the reason for the log.
    Storage {
        error: Value,
        reason: String,
    },
    /// A bug: the process is not to be used again.
    Panicked(String),
}

/// The result of an attempt; its files stand in the folder of the assignment.
#[derive(Debug, Serialize, Deserialize)]
pub struct Products {
    /// The manifest, JSON.
    pub result: String,
    pub files: Vec<MadeFile>,
    pub meshes: Vec<MeshFile>,
    pub effort: Effort,
}

#[derive(Debug, Serialize, Deserialize)]
pub struct MadeFile {
    pub name: String,
    pub media_type: String,
}

/// A mesh to be stored: its row as for an upload, and the file with its bytes as they are to be stored.
#[derive(Debug, Serialize, Deserialize)]
pub struct MeshFile {
    pub what: MadeName,
    pub name: Option<String>,
    pub file: String,
    pub id: String,
    /// Of the bytes before they were read and written anew.
    pub sha256: String,
    pub options: String,
    /// JSON.
    pub report: String,
}

/// Kind, time and memory of a job, for metrics.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Effort {
    pub method: Option<String>,
    pub unknowns: u64,
    pub iterations: u64,
}

/// A message as the bytes of its frame.
pub fn encode(message: &impl Serialize) -> io::Result<Vec<u8>> {
    let text = serde_json::to_vec(message)?;
    let mut frame = Vec::with_capacity(text.len() + 8);
    write_frame(&mut frame, &text)?;
    Ok(frame)
}

pub fn write_frame(to: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    to.write_all(&(bytes.len() as u64).to_le_bytes())?;
    to.write_all(bytes)
}

/// The next frame; `None` where the other side has closed its end between two frames.
pub fn read_frame(from: &mut impl Read) -> io::Result<Option<Vec<u8>>> {
    let mut length = [0; 8];
    let mut filled = 0;
    while filled < length.len() {
        match from.read(&mut length[filled..]) {
            Ok(0) if filled == 0 => return Ok(None),
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            Ok(count) => filled += count,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    let length = u64::from_le_bytes(length);
    if length > LONGEST {
        return Err(io::Error::new(ErrorKind::InvalidData, format!("a frame of {length} bytes")));
    }
    let mut bytes = vec![0; length as usize];
    from.read_exact(&mut bytes)?;
    Ok(Some(bytes))
}

/// The next message.
pub fn read_message<T: DeserializeOwned>(from: &mut impl Read) -> io::Result<Option<T>> {
    let Some(frame) = read_frame(from)? else { return Ok(None) };
    Ok(Some(serde_json::from_slice(&frame)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_and_bytes_come_out_as_they_went_in() {
        let mut wire = encode(&Order::Stop).unwrap();
        wire.extend(encode(&Order::Answer(Answer::Bytes)).unwrap());
        write_frame(&mut wire, b"\0mesh").unwrap();
        let mut from = wire.as_slice();
        assert!(matches!(read_message(&mut from), Ok(Some(Order::Stop))));
        assert!(matches!(read_message(&mut from), Ok(Some(Order::Answer(Answer::Bytes)))));
        assert_eq!(read_frame(&mut from).unwrap().unwrap(), b"\0mesh");
        assert!(read_frame(&mut from).unwrap().is_none());
    }

    #[test]
    fn a_frame_that_breaks_off_or_promises_too_much_is_an_error() {
        let whole = encode(&Order::Stop).unwrap();
        assert!(read_frame(&mut &whole[..whole.len() - 1]).is_err());
        assert!(read_frame(&mut &whole[..3]).is_err());
        assert!(read_frame(&mut [0xff; 16].as_slice()).is_err());
    }
}
