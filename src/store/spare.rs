//! Room in reserve beside the embedded database: a file that is given up where erasing, or starting, needs the space.

use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use rustix::fs::{FallocateFlags, fallocate, statvfs};
use rustix::io::Errno;

/// Two of the logs that SQLite writes to before it brings them into its file (1000 pages of 4 KiB).
const BYTES: u64 = 8 << 20;

/// The file. Bytes are only stored while it is there, so that what was given up for an erasure is not taken by the next
/// upload.
pub struct Spare {
    file: PathBuf,
    is_held: AtomicBool,
}

impl Spare {
    /// Of a data folder; given up at once where its disk is full, so that a database can be opened there.
    pub fn new(folder: &Path) -> Spare {
        let file = folder.join("spare");
        let is_held = std::fs::metadata(&file).is_ok_and(|found| found.len() == BYTES);
        let spare = Spare { file, is_held: AtomicBool::new(is_held) };
        spare.make_room();
        spare
    }

    /// Takes the room, unless it is taken. An error of a disk without as much space.
    pub fn hold(&self) -> std::io::Result<()> {
        if self.is_held.load(Ordering::Relaxed) {
            return Ok(());
        }
        if let Err(error) = self.take() {
            // A part of it would be of no use.
            let _ = std::fs::remove_file(&self.file);
            return Err(error);
        }
        self.is_held.store(true, Ordering::Relaxed);
        Ok(())
    }

    /// Gives the room up where there is no other. It is taken again before bytes are stored.
    pub fn make_room(&self) {
        let Some(folder) = self.file.parent() else { return };
        let is_scarce = statvfs(folder).is_ok_and(|disk| disk.f_bavail * disk.f_frsize < BYTES);
        if is_scarce && self.is_held.swap(false, Ordering::Relaxed) {
            let given = std::fs::remove_file(&self.file);
            tracing::warn!(?given, "the disk is full: the room in reserve is given up");
        }
    }

    fn take(&self) -> std::io::Result<()> {
        let file = OpenOptions::new().create(true).write(true).truncate(false).open(&self.file)?;
        match allocate(&file) {
            // Such a file system promises no space; what cannot be written there is told when it is written.
            Err(Errno::OPNOTSUPP) => file.set_len(BYTES),
            allocated => Ok(allocated?),
        }
    }
}

fn allocate(file: &File) -> Result<(), Errno> {
    loop {
        match fallocate(file, FallocateFlags::empty(), 0, BYTES) {
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
        assert!(!spare.is_held.load(Ordering::Relaxed));
        spare.hold().unwrap();
        spare.make_room();
        let found = std::fs::metadata(folder.path().join("spare")).unwrap();
        assert_eq!(found.len(), BYTES, "there is room without it");
        assert!(Spare::new(folder.path()).is_held.load(Ordering::Relaxed));
    }
}
