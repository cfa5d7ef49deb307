//! Database handle for either engine: connections, migration, queries.

use super::file::{DatabaseFile, PlacedFile};
use super::run::{Open, Pool, Transaction, Writer};
use super::schema::{Column, Migrated};
use super::{postgres, schema, sqlite};
use crate::fair_semaphore::{FairSemaphore, Full, Permit};
use crate::store::error::StoreError;
use futures::future::BoxFuture;
use sqlx::postgres::PgConnectOptions;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Where the rows are.
#[derive(Clone)]
pub(in crate::store) enum Address {
    /// A file of SQLite, which one process has to itself by the lock of its folder.
    File { path: PathBuf, lock: PlacedFile },
    /// A PostgreSQL that many processes share.
    Server { options: Box<PgConnectOptions>, connections: u32 },
}

impl Address {
    /// The server that an address names, `postgres://…`.
    pub fn server(address: &str, connections: u32) -> Result<Address, sqlx::Error> {
        let options: PgConnectOptions = address.parse()?;
        let options = Box::new(options.application_name("facies"));
        Ok(Address::Server { options, connections })
    }

    /// Concurrent writers; on a server some connections are left to readers.
    fn writers(&self) -> usize {
        match self {
            Address::File { .. } => 1,
            Address::Server { connections, .. } => {
                let readers = (connections / 4).max(1);
                connections.saturating_sub(readers).max(1) as usize
            }
        }
    }

    /// Time after which a waiting writer gives up and its client gets `Retry-After`.
    fn patience(&self) -> Duration {
        match self {
            Address::File { .. } => sqlite::ACQUIRE_TIMEOUT,
            Address::Server { .. } => postgres::ACQUIRE_TIMEOUT,
        }
    }
}

/// What becomes of an embedded database of an earlier schema step as it is opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::store) enum EarlierSchema {
    /// It is brought up to date; the program that made it cannot open it any more.
    Migrate,
    /// It stays as it is.
    Refuse,
}

/// A step before the first write of a request.
pub(in crate::store) trait BeforeWriting: Send + Sync {
    fn prepare(&self) -> BoxFuture<'_, Result<(), StoreError>>;
}

/// The connections of this process, for readers and for writers. Writers take turns: the tenants of requests, the audit
/// log, and the service's own work.
#[derive(Clone)]
pub(in crate::store) struct Database {
    address: Address,
    writer: Arc<Pool>,
    reader: Arc<Pool>,
    turns: FairSemaphore,
    /// The queue of writers that it waits in.
    line: Arc<str>,
    first: Option<Arc<dyn BeforeWriting>>,
}

/// The queue of the service's own work.
const OWN_LINE: &str = "";

impl Database {
    /// Opens the database. The embedded one is created where it is not there, and brought up to date where that is asked for. One
    /// that many share is refused unless its schema fits: none of them changes it under the others.
    pub async fn open(address: Address, earlier: EarlierSchema) -> Result<Database, StoreError> {
        let database = Database::connect(address, None, "write").await?;
        let pool = &database.writer;
        match (&database.address, earlier) {
            (Address::File { path, .. }, EarlierSchema::Migrate) => {
                let Migrated { from, to } =
                    schema::migrate(pool).await.map_err(|error| error.of_file(path))?;
                if (1..to).contains(&from) {
                    tracing::info!(from, to, "the database was brought to another schema step");
                }
            }
            (Address::File { path, .. }, EarlierSchema::Refuse) => {
                schema::make(pool).await.map_err(|error| error.of_file(path))?;
            }
            (Address::Server { .. }, _) => schema::check(pool).await?,
        }
        Ok(database)
    }

    /// Brings the schema up to date, each step in a transaction of its own.
    pub async fn migrate(address: Address) -> Result<Migrated, StoreError> {
        let database = match address {
            Address::File { .. } => Database::connect(address, None, "write").await?,
            // A step may take longer than any request is allowed to.
            Address::Server { options, .. } => {
                let connected = postgres::unlimited(&options).await;
                let pool = connected.map_err(|source| StoreError::CannotConnect {
                    server: postgres::name(&options),
                    source,
                })?;
                let pool = Arc::new(Pool::Postgres(pool));
                let address = Address::Server { options, connections: 1 };
                Database::of_pools(address, (pool.clone(), pool), "write")
            }
        };
        let migrated = schema::migrate(&database.writer).await;
        database.close().await;
        migrated
    }

    /// A few connections of their own to the same database.
    pub async fn again(&self) -> Result<Database, StoreError> {
        let address = match &self.address {
            Address::Server { options, .. } => {
                Address::Server { options: options.clone(), connections: 2 }
            }
            file @ Address::File { .. } => file.clone(),
        };
        Database::connect(address, self.file().cloned(), "write again").await
    }

    /// The file of an embedded database.
    fn file(&self) -> Option<&Arc<DatabaseFile>> {
        match &*self.writer {
            Pool::Sqlite(connections) => Some(&connections.file),
            Pool::Postgres(_) => None,
        }
    }

    /// `known` is the file of an embedded database that is open already, `what` is what turns are counted as.
    async fn connect(
        address: Address,
        known: Option<Arc<DatabaseFile>>,
        what: &'static str,
    ) -> Result<Database, StoreError> {
        let (writer, reader) = match &address {
            Address::File { path, lock } => {
                let connected = sqlite::connect(path, lock, known).await;
                let (writer, reader) =
                    connected.map_err(|source| StoreError::from(source).of_file(path))?;
                (Arc::new(Pool::Sqlite(writer)), Arc::new(Pool::Sqlite(reader)))
            }
            Address::Server { options, connections } => {
                let connected = postgres::connect(options, *connections).await;
                let pool = connected.map_err(|source| StoreError::CannotConnect {
                    server: postgres::name(options),
                    source,
                })?;
                let pool = Arc::new(Pool::Postgres(pool));
                (pool.clone(), pool)
            }
        };
        Ok(Database::of_pools(address, (writer, reader), what))
    }

    fn of_pools(
        address: Address,
        (writer, reader): (Arc<Pool>, Arc<Pool>),
        what: &'static str,
    ) -> Database {
        let turns = FairSemaphore::new(what, address.writers(), usize::MAX);
        Database { address, writer, reader, turns, line: OWN_LINE.into(), first: None }
    }

    /// The same in another queue of writers, without a step before writing.
    pub fn in_line(&self, line: &str) -> Database {
        Database { line: line.into(), first: None, ..self.clone() }
    }

    /// The same with a step before the first write.
    pub fn after(&self, first: Arc<dyn BeforeWriting>) -> Database {
        Database { first: Some(first), ..self.clone() }
    }

    /// Waiting writers of this queue.
    pub fn waiting(&self) -> usize {
        self.turns.waiting(&self.line)
    }

    /// Waits until this one may write.
    async fn permit(&self) -> Result<Permit, StoreError> {
        if let Some(first) = &self.first {
            first.prepare().await?;
        }
        let late = || StoreError::from(sqlx::Error::PoolTimedOut);
        let permit = tokio::time::timeout(self.address.patience(), self.turns.acquire(&self.line));
        permit.await.map_err(|_| late())?.map_err(|Full { .. }| late())
    }

    pub fn reader(&self) -> &Pool {
        &self.reader
    }

    /// For single statements that change something.
    pub async fn writer(&self) -> Result<Writer, StoreError> {
        let permit = self.permit().await?;
        Ok(Writer { pool: self.writer.clone(), _permit: permit })
    }

    /// Where it is, for messages.
    pub fn place(&self) -> String {
        match &self.address {
            Address::File { path, .. } => path.display().to_string(),
            Address::Server { options, .. } => postgres::name(options),
        }
    }

    /// For words to other processes.
    pub fn server(&self) -> Option<&sqlx::PgPool> {
        match &*self.writer {
            Pool::Sqlite(_) => None,
            Pool::Postgres(pool) => Some(pool),
        }
    }

    pub async fn begin(&self) -> Result<Transaction, StoreError> {
        let permit = self.permit().await?;
        let open = match &*self.writer {
            Pool::Sqlite(connections) => {
                Open::Sqlite(connections.begin().await?, connections.file.clone())
            }
            Pool::Postgres(pool) => Open::Postgres(postgres::begin(pool).await?),
        };
        Ok(Transaction::new(open, Some(permit)))
    }

    /// A transaction whose commit does not wait for the disk. It is there before whatever is committed after it, since
    /// a log is written in its order; a crash of the server within a second may take it alone.
    pub async fn begin_unflushed(&self) -> Result<Transaction, StoreError> {
        let Pool::Postgres(pool) = &*self.writer else { return self.begin().await };
        let permit = self.permit().await?;
        Ok(Transaction::new(Open::Postgres(postgres::begin_unflushed(pool).await?), Some(permit)))
    }

    /// A transaction that sees everything as it is when it begins, and changes nothing. It may last.
    pub async fn snapshot(&self) -> Result<Transaction, StoreError> {
        let open = match (&self.address, &*self.reader) {
            (Address::Server { options, .. }, _) => {
                let pool = postgres::unlimited(options).await?;
                Open::Postgres(postgres::snapshot(&pool).await?)
            }
            (_, Pool::Sqlite(connections)) => {
                Open::Sqlite(connections.snapshot().await?, connections.file.clone())
            }
            (_, Pool::Postgres(pool)) => Open::Postgres(postgres::snapshot(pool).await?),
        };
        Ok(Transaction::new(open, None))
    }

    /// What is wrong with the pages of an embedded database, all of which are read. A server checks its own.
    pub async fn faults(&self) -> Result<Vec<String>, StoreError> {
        match &*self.reader {
            Pool::Sqlite(connections) => Ok(sqlite::faults(&connections.pool).await?),
            Pool::Postgres(_) => Ok(Vec::new()),
        }
    }

    /// The columns of a table.
    pub async fn columns(&self, table: &str) -> Result<Vec<Column>, StoreError> {
        Ok(schema::columns(&self.reader, table).await?)
    }

    /// Brings what was erased out of the files of an embedded database; false while somebody stands in the way. A server
    /// has files of its own.
    pub async fn empty_log(&self) -> Result<bool, StoreError> {
        match &self.address {
            Address::File { path, .. } => {
                let Some(file) = self.file() else { return Ok(true) };
                file.check()?;
                Ok(file.watched(sqlite::empty_log(path).await)?)
            }
            Address::Server { .. } => Ok(true),
        }
    }

    pub async fn close(&self) {
        for pool in [&self.reader, &self.writer] {
            match &**pool {
                // The last connection that is closed writes its log into the file, which may be the last good copy: these stay
                // open until the process ends.
                Pool::Sqlite(connections) if connections.file.is_given_up() => {
                    std::mem::forget(connections.clone());
                }
                Pool::Sqlite(connections) => connections.pool.close().await,
                Pool::Postgres(pool) => pool.close().await,
            }
        }
    }
}
