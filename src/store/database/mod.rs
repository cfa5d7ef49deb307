//! Database access for two engines. The SQL text of the other files is shared; what differs between SQLite and
//! PostgreSQL is in one file each, and only connections, the `clock` and error codes do.
//!
//! Text for both: `$1` placeholders, TEXT, BIGINT and DOUBLE PRECISION, RETURNING, ON CONFLICT, row values and
//! `string_agg`, which SQLite has since 3.44. A row that is read in order to be changed is read with
//! `FOR UPDATE`, and one that has to stay with `FOR KEY SHARE`: PostgreSQL locks it, SQLite, whose transactions exclude each other, is handed the text without it.

mod errors;
mod file;
mod handle;
mod postgres;
mod run;
pub(crate) mod schema;
mod sqlite;
mod sqlite_codes;
mod value;

pub use errors::{
    is_damaged, is_duplicate, is_full, is_read_only, is_reference, is_refused, is_unavailable,
};
pub(super) use file::PlacedFile;
pub use file::{FileFault, fault_of};
pub(super) use handle::{Address, BeforeWriting, Database, EarlierSchema};
use run::Pool;
pub(super) use run::{Executor, Transaction};
pub(super) use schema::Column;
pub use schema::{Migrated, newest as newest_step};
pub(super) use value::{Row, RowSink, Statement, Value, query, query_of};
