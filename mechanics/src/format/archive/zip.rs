//! Zip archives in memory, stored or deflated, with every length and place checked before it is used.
//!
//! Source: APPNOTE 6.3, PKWARE. The central directory has the last word; encryption, several disks and the sizes of
//! zip64 are refused, as are links, places that overlap, and names that lead out of the archive.

use std::borrow::Cow;
use std::collections::HashMap;
use std::io::Read;

use flate2::Crc;
use flate2::read::DeflateDecoder;

use crate::format::cursor::Cursor;
use crate::format::error::{FilePosition, FormatError};
use crate::format::limits::{MOST_BYTES_OF_ONE, ReadLimits, room_for};

const FORMAT: &str = "zip";
const LOCAL: &[u8] = b"PK\x03\x04";
const CENTRAL: [u8; 4] = *b"PK\x01\x02";
const END: &[u8] = b"PK\x05\x06";
/// Bytes of the end record without its comment, which has at most 65535.
const END_BYTES: usize = 22;
const LOCAL_BYTES: u64 = 30;
const MOST_FILES: u64 = 4096;
/// Of bytes that only begin as an archive does.
const NO_DIRECTORY: FormatError =
    FormatError::UnsupportedFormat { detail: "it is a zip archive that ends before its directory" };
/// What stands for a number that only zip64 holds.
const IN_ZIP64: u32 = u32::MAX;

pub(in crate::format) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(LOCAL) || bytes.starts_with(END)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Method {
    Stored,
    Deflated,
}

/// A file of the archive.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    /// From 1, in the order of the archive.
    pub number: usize,
    /// Without empty parts and `.`.
    name: Vec<u8>,
    is_folder: bool,
    method: Method,
    crc: u32,
    /// Bytes in the archive and out of it.
    stored: u64,
    bytes: u64,
    /// Where its local header begins.
    at: u64,
}

pub(super) struct Archive<'a> {
    bytes: &'a [u8],
    /// Files without folders.
    pub entries: Vec<Entry>,
}

/// The end of the archive: where its directory is.
struct End {
    files: u64,
    directory: u64,
    directory_bytes: u64,
}

fn bad(at: u64, detail: impl Into<String>) -> FormatError {
    FormatError::Parse { format: FORMAT, place: FilePosition::Offset(at), detail: detail.into() }
}

impl Entry {
    pub fn bad(&self, detail: &str) -> FormatError {
        bad(self.at, format!("file {}: {detail}", self.number))
    }

    /// An error within this file, with its number.
    pub fn placed(&self, error: FormatError) -> FormatError {
        match error {
            FormatError::Parse { format, place, detail } => {
                let detail = format!("{detail} (file {} of the archive)", self.number);
                FormatError::Parse { format, place, detail }
            }
            other => other,
        }
    }

    /// Whether this is the file of that name in the folder of the other.
    pub fn is_beside(&self, other: &Entry, name: &str) -> bool {
        let folder = other.name.iter().rposition(|&byte| byte == b'/').map_or(0, |at| at + 1);
        self.name.strip_prefix(&other.name[..folder]) == Some(name.as_bytes())
    }
}

impl<'a> Archive<'a> {
    /// Reads the directory and checks all of it.
    pub fn open(bytes: &'a [u8], limits: &ReadLimits) -> Result<Archive<'a>, FormatError> {
        let end = End::find(bytes)?;
        if end.files > MOST_FILES {
            let what = "files in an archive";
            return Err(FormatError::Limits { what, declared: end.files, limit: MOST_FILES });
        }
        let within = bytes.get(end.directory as usize..);
        let directory = within.and_then(|within| within.get(..end.directory_bytes as usize));
        let directory = directory.ok_or_else(|| {
            bad(end.directory, "the directory reaches beyond the end of the archive")
        })?;
        let mut cursor = Cursor::new(FORMAT, directory);
        let mut entries = Vec::new();
        let mut budget = limits.image_budget(bytes.len());
        for number in 1..=end.files as usize {
            let entry = Entry::read(&mut cursor, number)?;
            budget.charge(entry.bytes)?;
            if entry.bytes / MOST_BYTES_OF_ONE > entry.stored {
                return Err(entry.bad("it promises more than its compressed bytes can hold"));
            }
            if !entry.is_folder {
                entries.push(entry);
            }
        }
        let archive = Archive { bytes: &bytes[..end.directory as usize], entries };
        archive.check_names()?;
        archive.check_places()?;
        Ok(archive)
    }

    /// Refuses files of the same name: programs differ in which of them they unpack.
    fn check_names(&self) -> Result<(), FormatError> {
        let mut numbers = HashMap::new();
        for entry in &self.entries {
            if let Some(other) = numbers.insert(entry.name.as_slice(), entry.number) {
                return Err(entry.bad(&format!("file {other} has the same name")));
            }
        }
        Ok(())
    }

    pub fn bad(&self, detail: String) -> FormatError {
        bad(0, detail)
    }

    /// Refuses files that share bytes: with these few bytes make many.
    fn check_places(&self) -> Result<(), FormatError> {
        let mut places = Vec::new();
        for entry in &self.entries {
            places.push((entry.at, self.stored_at(entry)? + entry.stored, entry));
        }
        places.sort_by_key(|(from, to, _)| (*from, *to));
        match places.windows(2).find(|pair| pair[0].1 > pair[1].0) {
            Some(pair) => Err(pair[1].2.bad("it shares bytes with another file of the archive")),
            None => Ok(()),
        }
    }

    /// Where the bytes of a file begin, behind its local header.
    fn stored_at(&self, entry: &Entry) -> Result<u64, FormatError> {
        let header =
            self.bytes.get(entry.at as usize..).and_then(|rest| rest.get(..LOCAL_BYTES as usize));
        let header = header.filter(|header| header.starts_with(LOCAL));
        let header = header.ok_or_else(|| entry.bad("it has no header of its own"))?;
        let length = |at: usize| u64::from(u16::from_le_bytes([header[at], header[at + 1]]));
        let start = entry.at + LOCAL_BYTES + length(26) + length(28);
        if start + entry.stored > self.bytes.len() as u64 {
            return Err(entry.bad("it reaches beyond the end of the archive"));
        }
        Ok(start)
    }

    fn stored(&self, entry: &Entry) -> Result<&'a [u8], FormatError> {
        let start = self.stored_at(entry)? as usize;
        Ok(&self.bytes[start..start + entry.stored as usize])
    }

    /// The first bytes of a file.
    pub fn start(&self, entry: &Entry, most: usize) -> Result<Vec<u8>, FormatError> {
        let stored = self.stored(entry)?;
        let mut start = Vec::new();
        let read = match entry.method {
            Method::Stored => stored.take(most as u64).read_to_end(&mut start),
            Method::Deflated => {
                DeflateDecoder::new(stored).take(most as u64).read_to_end(&mut start)
            }
        };
        read.map_err(|error| entry.bad(&error.to_string()))?;
        Ok(start)
    }

    /// All bytes of a file, as many as promised and with the check sum that was promised.
    pub fn bytes(&self, entry: &Entry) -> Result<Cow<'a, [u8]>, FormatError> {
        let stored = self.stored(entry)?;
        let bytes = match entry.method {
            Method::Stored => Cow::Borrowed(stored),
            Method::Deflated => Cow::Owned(inflate(stored, entry)?),
        };
        let mut crc = Crc::new();
        crc.update(&bytes);
        if bytes.len() as u64 != entry.bytes || crc.sum() != entry.crc {
            return Err(entry.bad("its bytes are not those that the directory promises"));
        }
        Ok(bytes)
    }
}

fn inflate(stored: &[u8], entry: &Entry) -> Result<Vec<u8>, FormatError> {
    let mut bytes = room_for(entry.bytes as usize)?;
    let mut inflater = DeflateDecoder::new(stored).take(entry.bytes + 1);
    inflater.read_to_end(&mut bytes).map_err(|error| entry.bad(&error.to_string()))?;
    Ok(bytes)
}

impl End {
    /// The last record that reaches to the end of the bytes with its comment.
    fn find(bytes: &[u8]) -> Result<End, FormatError> {
        let latest = bytes.len().checked_sub(END_BYTES);
        let latest = latest.ok_or(NO_DIRECTORY)?;
        let earliest = latest.saturating_sub(usize::from(u16::MAX));
        let at = (earliest..=latest).rev().find(|&at| {
            let record = &bytes[at..];
            let comment = usize::from(u16::from_le_bytes([record[20], record[21]]));
            record.starts_with(END) && record.len() == END_BYTES + comment
        });
        let at = at.ok_or(NO_DIRECTORY)?;
        let mut cursor = Cursor::new(FORMAT, &bytes[at + 4..]);
        let numbers = [u16_of(&mut cursor)?, u16_of(&mut cursor)?];
        let [here, files] = [u16_of(&mut cursor)?, u16_of(&mut cursor)?];
        if numbers != [0, 0] || here != files {
            return Err(bad(at as u64, "an archive of several disks is not read"));
        }
        let [length, offset] = [u32_of(&mut cursor)?, u32_of(&mut cursor)?];
        if files == u16::MAX || length == IN_ZIP64 || offset == IN_ZIP64 {
            return Err(bad(at as u64, "an archive in zip64 is not read"));
        }
        Ok(End {
            files: u64::from(files),
            directory: u64::from(offset),
            directory_bytes: u64::from(length),
        })
    }
}

impl Entry {
    fn read(cursor: &mut Cursor<'_>, number: usize) -> Result<Entry, FormatError> {
        if cursor.take_array::<4>()? != CENTRAL {
            return Err(cursor.bad_bytes(format!("file {number} is not in the directory")));
        }
        let made_by = u16_of(cursor)?;
        cursor.take(2)?;
        let [flags, method] = [u16_of(cursor)?, u16_of(cursor)?];
        cursor.take(4)?;
        let [crc, stored, bytes] = [u32_of(cursor)?, u32_of(cursor)?, u32_of(cursor)?];
        let lengths = [u16_of(cursor)?, u16_of(cursor)?, u16_of(cursor)?];
        cursor.take(4)?;
        let [attributes, at] = [u32_of(cursor)?, u32_of(cursor)?];
        let name = cursor.take(u64::from(lengths[0]))?.to_vec();
        cursor.take(u64::from(lengths[1]) + u64::from(lengths[2]))?;
        let refuse = |detail: &str| Err(bad(u64::from(at), format!("file {number}: {detail}")));
        if [stored, bytes, at].contains(&IN_ZIP64) {
            return refuse("its size is in zip64, which is not read");
        }
        if flags & 1 != 0 {
            return refuse("it is encrypted");
        }
        // Unix attributes: the upper half, with the type of file in its first four bits.
        if made_by >> 8 == 3 && attributes >> 28 == 0o12 {
            return refuse("it is a link");
        }
        if escapes_folder(&name) {
            return refuse("its name leads out of the archive");
        }
        let method = match method {
            0 if stored == bytes => Method::Stored,
            8 => Method::Deflated,
            other => {
                return refuse(&format!("compression method {other} is not read; 0 and 8 are"));
            }
        };
        let (stored, bytes, at) = (stored.into(), bytes.into(), at.into());
        let is_folder = name.ends_with(b"/");
        let parts = name.split(|&byte| byte == b'/');
        let parts: Vec<&[u8]> = parts.filter(|part| !matches!(*part, b"" | b".")).collect();
        let name = parts.join(&b'/');
        Ok(Entry { number, name, is_folder, method, crc, stored, bytes, at })
    }
}

/// Whether a name leaves its folder. Names are never used as paths, but such a name is an attack.
fn escapes_folder(name: &[u8]) -> bool {
    let is_up = |part: &[u8]| part == b"..";
    name.starts_with(b"/")
        || name.contains(&b'\\')
        || name.contains(&0)
        || name.get(1) == Some(&b':')
        || name.split(|&byte| byte == b'/').any(is_up)
}

fn u16_of(cursor: &mut Cursor<'_>) -> Result<u16, FormatError> {
    Ok(u16::from_le_bytes(cursor.take_array()?))
}

fn u32_of(cursor: &mut Cursor<'_>) -> Result<u32, FormatError> {
    Ok(u32::from_le_bytes(cursor.take_array()?))
}
