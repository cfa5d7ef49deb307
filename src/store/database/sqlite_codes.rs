//! Error codes of SQLite.

/// The disk is full.
pub const FULL: &str = "13";
/// The file cannot be written.
const READ_ONLY: u32 = 8;
/// Another process writes, the disk errs, the file cannot be written or opened.
const PASSING: [u32; 4] = [5, READ_ONLY, 10, 14];
/// The file is damaged, or is none of SQLite.
const DAMAGED: [u32; 2] = [11, 26];
/// A page ends before its length (SQLITE_IOERR_SHORT_READ): the file or its log was cut.
const SHORT_READ: &str = "522";

/// What SQLite says of a damaged file, where the error tells of one.
pub fn damage(error: &sqlx::Error) -> Option<String> {
    let sqlx::Error::Database(error) = error else { return None };
    let is_damaged =
        |code: &str| code == SHORT_READ || kind(code).is_some_and(|kind| DAMAGED.contains(&kind));
    error.code().filter(|code| is_damaged(code)).map(|_| error.message().to_owned())
}

pub fn is_transient(code: &str) -> bool {
    kind(code).is_some_and(|kind| PASSING.contains(&kind))
}

pub fn is_read_only(code: &str) -> bool {
    kind(code) == Some(READ_ONLY)
}

/// Codes say more in their upper bytes; those of PostgreSQL have five characters.
fn kind(code: &str) -> Option<u32> {
    let code: u32 = code.parse().ok().filter(|_| code.len() < 5)?;
    Some(code & 0xff)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_cannot_be_written_may_be_so_again_and_codes_of_servers_are_none_of_sqlite() {
        // Moved away, and plain.
        for code in ["1032", "8"] {
            assert!(is_read_only(code) && is_transient(code), "{code}");
        }
        assert!(is_transient("5") && !is_read_only("5"));
        assert!(!is_read_only("25006") && !is_transient("08006") && !is_transient("1"));
    }
}
