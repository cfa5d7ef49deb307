//! Revision of the numerics, so that a result of another build is not taken for one of this build.

/// Part of the hash of every job and of the key of every response, beside the version of the package.
///
/// Raise it by one with every change after which the same input may give other bits anywhere in a result: another
/// formula, order of sums, tolerance, choice of solver, sampling rule or version of a numerical dependency. The test
/// `golden` of `tests/mechanics` holds it against the numbers of every method: it fails where they change and this
/// does not, and says how its table is written anew.
pub const NUMERICS_REVISION: u32 = 31;
