//! Statements run on a pool or within a transaction of either engine.

use super::file::DatabaseFile;
use super::value::Row;
use super::value::RowSink;
use super::value::Statement;
use super::value::Value;
use super::{postgres, sqlite};
use crate::fair_semaphore::Permit;
use sqlx::postgres::{PgPool, Postgres};
use sqlx::sqlite::Sqlite;
use std::sync::Arc;

/// Connections of one engine.
pub(in crate::store) enum Pool {
    Sqlite(sqlite::Connections),
    Postgres(PgPool),
}

/// Changes that happen together or not at all; dropped, they do not happen.
pub(in crate::store) struct Transaction {
    open: Open,
    /// Of one that writes.
    _permit: Option<Permit>,
}

pub(super) enum Open {
    Sqlite(sqlx::Transaction<'static, Sqlite>, Arc<DatabaseFile>),
    Postgres(sqlx::Transaction<'static, Postgres>),
}

/// For single statements that change something.
pub(in crate::store) struct Writer {
    pub(super) pool: Arc<Pool>,
    pub(super) _permit: Permit,
}

impl Transaction {
    pub(super) fn new(open: Open, permit: Option<Permit>) -> Transaction {
        Transaction { open, _permit: permit }
    }

    pub async fn commit(self) -> Result<(), sqlx::Error> {
        match self.open {
            Open::Sqlite(transaction, file) => {
                file.watched(transaction.commit().await)?;
                // What went into a file that is gone is not there.
                file.check()
            }
            Open::Postgres(transaction) => postgres::in_time(transaction.commit()).await,
        }
    }

    /// Undoes it. Where the engine has done so by itself or is out of reach there is nothing left to undo, and the
    /// connection is not used again.
    pub async fn rollback(self) {
        let undone = match self.open {
            Open::Sqlite(transaction, _) => transaction.rollback().await,
            Open::Postgres(transaction) => postgres::in_time(transaction.rollback()).await,
        };
        if let Err(error) = undone {
            tracing::debug!(%error, "nothing was left to undo");
        }
    }
}

/// Where a statement runs: on any free connection, or as a part of a transaction.
pub(in crate::store) enum Executor<'a> {
    Pool(&'a Pool),
    Transaction(&'a mut Transaction),
}

impl<'a> From<&'a Pool> for Executor<'a> {
    fn from(pool: &'a Pool) -> Self {
        Executor::Pool(pool)
    }
}

impl<'a> From<&'a Writer> for Executor<'a> {
    fn from(writer: &'a Writer) -> Self {
        Executor::Pool(&writer.pool)
    }
}

impl<'a> From<&'a mut Transaction> for Executor<'a> {
    fn from(transaction: &'a mut Transaction) -> Self {
        Executor::Transaction(transaction)
    }
}

impl Statement {
    pub fn bind(mut self, value: impl Into<Value>) -> Self {
        self.values.push(value.into());
        self
    }

    /// Waits for the answer however long it takes.
    pub fn without_timeout(mut self) -> Self {
        self.patient = true;
        self
    }

    /// Hands over the rows as they come; returns how many rows were changed.
    pub async fn run(self, place: Executor<'_>, take: RowSink<'_>) -> Result<u64, sqlx::Error> {
        match place {
            Executor::Pool(Pool::Sqlite(connections)) => {
                let mut connection = connections.acquire().await?;
                connections.file.changed(sqlite::run(&mut connection, self, take).await)
            }
            Executor::Pool(Pool::Postgres(pool)) => {
                let mut connection = pool.acquire().await?;
                let answer = postgres::run(&mut connection, self, take).await;
                if matches!(answer, Err(sqlx::Error::Io(_))) {
                    // Later statements must not wait for the answer that did not come.
                    connection.close_on_drop();
                }
                answer
            }
            Executor::Transaction(Transaction { open: Open::Sqlite(open, file), .. }) => {
                file.changed(sqlite::run(&mut *open, self, take).await)
            }
            Executor::Transaction(Transaction { open: Open::Postgres(open), .. }) => {
                postgres::run(&mut *open, self, take).await
            }
        }
    }

    /// The number of rows that it changed.
    pub async fn execute(self, place: impl Into<Executor<'_>>) -> Result<u64, sqlx::Error> {
        self.run(place.into(), &mut |_| Ok(())).await
    }

    pub async fn fetch_all(self, place: impl Into<Executor<'_>>) -> Result<Vec<Row>, sqlx::Error> {
        let mut rows = Vec::new();
        self.run(place.into(), &mut |row| {
            rows.push(row);
            Ok(())
        })
        .await?;
        Ok(rows)
    }

    /// The first row, if there is one.
    pub async fn fetch_optional(
        self,
        place: impl Into<Executor<'_>>,
    ) -> Result<Option<Row>, sqlx::Error> {
        Ok(self.fetch_all(place).await?.into_iter().next())
    }

    pub async fn fetch_one(self, place: impl Into<Executor<'_>>) -> Result<Row, sqlx::Error> {
        self.fetch_optional(place).await?.ok_or(sqlx::Error::RowNotFound)
    }
}
