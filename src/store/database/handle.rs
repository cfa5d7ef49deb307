//! A database of either engine: opened, brought up to date, asked.

use super::run::Pool;
use super::run::Transaction;
use super::schema::Migrated;
use super::{postgres, schema, sqlite};
use crate::store::error::StoreError;
use sqlx::postgres::PgConnectOptions;
use std::path::PathBuf;
use std::sync::Arc;

/// Where the rows are.
#[derive(Clone)]
pub(in crate::store) enum Address {
    /// A file of SQLite, which one process has to itself.
    File(PathBuf),
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
}

/// The connections of this process: those that read, and those that may write.
#[derive(Clone)]
pub(in crate::store) struct Database {
    address: Address,
    writer: Arc<Pool>,
    reader: Arc<Pool>,
}

impl Database {
    /// Opens the database. The embedded one is created where it is not there and brought up to date. One
    /// that many share is refused unless its schema fits: none of them changes it under the others.
    pub async fn open(address: Address) -> Result<Database, StoreError> {
        let database = Database::connect(address).await?;
        match &database.address {
            Address::File(_) => drop(schema::migrate(&database.writer).await?),
            Address::Server { .. } => schema::check(&database.writer).await?,
        }
        Ok(database)
    }

    /// Brings the schema up to date, each step in a transaction of its own.
    pub async fn migrate(address: Address) -> Result<Migrated, StoreError> {
        let database = match address {
            Address::File(_) => Database::connect(address).await?,
            // A step may take longer than any request is allowed to.
            Address::Server { options, .. } => {
                let pool = Arc::new(Pool::Postgres(postgres::unlimited(&options).await?));
                let address = Address::Server { options, connections: 1 };
                Database { address, writer: pool.clone(), reader: pool }
            }
        };
        let migrated = schema::migrate(&database.writer).await;
        database.close().await;
        migrated
    }

    /// A few connections of their own to the same database.
    pub async fn again(&self) -> Result<Database, StoreError> {
        Database::connect(match &self.address {
            Address::Server { options, .. } => {
                Address::Server { options: options.clone(), connections: 2 }
            }
            file => file.clone(),
        })
        .await
    }

    async fn connect(address: Address) -> Result<Database, StoreError> {
        let (writer, reader) = match &address {
            Address::File(file) => {
                let (writer, reader) = sqlite::connect(file).await?;
                (Arc::new(Pool::Sqlite(writer)), Arc::new(Pool::Sqlite(reader)))
            }
            Address::Server { options, connections } => {
                let pool = postgres::connect(options, *connections).await?;
                let pool = Arc::new(Pool::Postgres(pool));
                (pool.clone(), pool)
            }
        };
        Ok(Database { address, writer, reader })
    }

    pub fn reader(&self) -> &Pool {
        &self.reader
    }

    /// For single statements.
    pub fn writer(&self) -> &Pool {
        &self.writer
    }

    pub async fn begin(&self) -> Result<Transaction, StoreError> {
        Ok(match &*self.writer {
            Pool::Sqlite(pool) => Transaction::Sqlite(sqlite::begin(pool).await?),
            Pool::Postgres(pool) => Transaction::Postgres(postgres::begin(pool).await?),
        })
    }

    /// A transaction whose commit does not wait for the disk. It is there before whatever is committed after it, since
    /// a log is written in its order; a crash of the server within a second may take it alone.
    pub async fn begin_unflushed(&self) -> Result<Transaction, StoreError> {
        match &*self.writer {
            Pool::Sqlite(_) => self.begin().await,
            Pool::Postgres(pool) => {
                Ok(Transaction::Postgres(postgres::begin_unflushed(pool).await?))
            }
        }
    }

    /// A transaction that sees everything as it is when it begins, and changes nothing. It may last.
    pub async fn snapshot(&self) -> Result<Transaction, StoreError> {
        Ok(match (&self.address, &*self.reader) {
            (Address::Server { options, .. }, _) => {
                let pool = postgres::unlimited(options).await?;
                Transaction::Postgres(postgres::snapshot(&pool).await?)
            }
            (_, Pool::Sqlite(pool)) => Transaction::Sqlite(pool.begin().await?),
            (_, Pool::Postgres(pool)) => Transaction::Postgres(postgres::snapshot(pool).await?),
        })
    }

    /// Brings what was erased out of the files of an embedded database; false while somebody stands in the way. A server
    /// has files of its own.
    pub async fn empty_log(&self) -> Result<bool, StoreError> {
        match &self.address {
            Address::File(file) => Ok(sqlite::empty_log(file).await?),
            Address::Server { .. } => Ok(true),
        }
    }

    pub async fn close(&self) {
        for pool in [&self.reader, &self.writer] {
            match &**pool {
                Pool::Sqlite(pool) => pool.close().await,
                Pool::Postgres(pool) => pool.close().await,
            }
        }
    }
}
