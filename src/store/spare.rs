//! Reserved disk space beside the embedded database: a file that is removed when erasing, or starting, needs the space.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use rustix::fs::{FallocateFlags, fallocate, statvfs};
use rustix::io::Errno;

/// Two of the logs that SQLite writes to before it brings them into its file (1000 pages of 4 KiB).
const BYTES: u64 = 8 << 20;

/// Less than this is not worth keeping, and so much is left to the rows that are written meanwhile.
const LEAST: u64 = 1 << 20;

/// The file. Bytes are only stored while all of it is there, so that what was given up for an erasure is not taken by the
/// next upload.
pub struct Spare {
    file: PathBuf,
    /// How much of it is there.
    held: AtomicU64,
}

impl Spare {
    /// Of a data folder; given up at once where its disk is full, so that a database can be opened there.
    pub fn new(folder: &Path) -> Spare {
        let file = folder.join("spare");
        let held = std::fs::metadata(&file).map_or(0, |found| found.len());
        let spare = Spare { file, held: AtomicU64::new(held) };
        spare.release_reserve();
        spare
    }

    /// Takes the room, unless it is taken. An error of a disk without as much space and some more for what is to be stored.
    pub fn hold(&self) -> std::io::Result<()> {
        match self.is_whole() {
            true => Ok(()),
            false if !self.has_room() => Err(Errno::NOSPC.into()),
            false => self.take(BYTES),
        }
    }

    /// Takes as much of it as there is, for the next erasure.
    pub fn fill_reserve(&self) {
        let held = self.held.load(Ordering::Relaxed);
        let there = (self.free() + held).saturating_sub(LEAST).min(BYTES);
        if there >= LEAST.max(held)
            && let Err(error) = self.take(there)
        {
            tracing::debug!(%error, "there is no room in reserve");
        }
    }

    /// Gives the room up where there is no other. It is taken again once there is some. False where the disk is full all
    /// the same.
    pub fn release_reserve(&self) -> bool {
        if self.free() >= BYTES {
            return true;
        }
        if self.held.swap(0, Ordering::Relaxed) == 0 {
            return false;
        }
        let given = std::fs::remove_file(&self.file);
        tracing::warn!(?given, "the disk is full: the room in reserve is given up");
        true
    }

    /// Whether bytes can be stored as far as this is concerned.
    pub fn has_room(&self) -> bool {
        self.held.load(Ordering::Relaxed) + self.free() >= BYTES + LEAST
    }

    pub fn is_whole(&self) -> bool {
        self.held.load(Ordering::Relaxed) >= BYTES
    }

    /// Bytes free on its disk; as many as there can be where that is not told.
    fn free(&self) -> u64 {
        self.file.parent().and_then(|folder| free_bytes(folder).ok()).unwrap_or(BYTES)
    }

    fn take(&self, bytes: u64) -> std::io::Result<()> {
        let file = OpenOptions::new().create(true).write(true).truncate(false).open(&self.file)?;
        let taken = match allocate(&file, bytes) {
            // Such a file system promises no space; what cannot be written there is reported when it is written.
            Err(Errno::OPNOTSUPP) => file.set_len(bytes),
            allocated => allocated.map_err(Into::into),
        };
        let held = self.held.load(Ordering::Relaxed);
        match taken {
            Ok(()) => self.held.store(bytes, Ordering::Relaxed),
            // What was taken before stays; a part of the rest would be lost to everybody.
            Err(_) if held > 0 => file.set_len(held)?,
            Err(_) => std::fs::remove_file(&self.file)?,
        }
        taken
    }
}

/// Bytes free for this user on the disk of a folder.
pub fn free_bytes(folder: &Path) -> std::io::Result<u64> {
    let disk = statvfs(folder)?;
    Ok(disk.f_bavail.saturating_mul(disk.f_frsize))
}

fn allocate(file: &File, bytes: u64) -> Result<(), Errno> {
    loop {
        match fallocate(file, FallocateFlags::empty(), 0, bytes) {
            Err(Errno::INTR) => {}
            ended => return ended,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_room_is_taken_once_and_known_again() {
        let folder = tempfile::TempDir::new().unwrap();
        let spare = Spare::new(folder.path());
        assert!(!spare.is_whole());
        spare.hold().unwrap();
        spare.release_reserve();
        let found = std::fs::metadata(folder.path().join("spare")).unwrap();
        assert_eq!(found.len(), BYTES, "there is room without it");
        assert!(Spare::new(folder.path()).is_whole());
    }
}
