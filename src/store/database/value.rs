//! Values, statements and rows of either engine.

use sqlx::postgres::{PgRow, Postgres};
use sqlx::sqlite::{Sqlite, SqliteRow};
use sqlx::{Column, ColumnIndex, Decode, Row as _, Type, TypeInfo};
use std::borrow::Cow;

/// What stands for a placeholder. NULL has a type, as PostgreSQL wants.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::store) enum Value {
    Text(Option<String>),
    Integer(Option<i64>),
    Real(Option<f64>),
}

impl Value {
    pub fn is_null(&self) -> bool {
        matches!(self, Value::Text(None) | Value::Integer(None) | Value::Real(None))
    }
}

macro_rules! value_from {
    ($($from:ty => $variant:ident($value:ident) $made:expr;)*) => {
        $(impl From<$from> for Value {
            fn from($value: $from) -> Self {
                Value::$variant($made)
            }
        })*
    };
}

value_from! {
    &str => Text(text) Some(text.to_owned());
    &&str => Text(text) Some((*text).to_owned());
    &String => Text(text) Some(text.clone());
    String => Text(text) Some(text);
    &Option<String> => Text(text) text.clone();
    Option<String> => Text(text) text;
    Option<&str> => Text(text) text.map(str::to_owned);
    i64 => Integer(number) Some(number);
    Option<i64> => Integer(number) number;
    Option<f64> => Real(number) number;
}

/// SQL with the values for its placeholders.
#[must_use]
pub(in crate::store) struct Statement {
    pub(super) sql: Cow<'static, str>,
    pub(super) values: Vec<Value>,
    pub(super) patient: bool,
}

/// A statement of the program's own text; what clients send only ever comes in by `bind`.
pub(in crate::store) fn query(sql: &'static str) -> Statement {
    Statement { sql: sql.into(), values: Vec::new(), patient: false }
}

/// A statement made of the program's own words. Never of a client's.
pub(in crate::store) fn query_of(sql: String) -> Statement {
    Statement { sql: sql.into(), values: Vec::new(), patient: false }
}

/// Consumer of rows, one after the other.
pub(in crate::store) type RowSink<'a> = &'a mut (dyn FnMut(Row) -> Result<(), sqlx::Error> + Send);

/// A row of either engine.
pub(in crate::store) enum Row {
    Sqlite(SqliteRow),
    Postgres(PgRow),
}

impl Row {
    /// A column by its name or number.
    pub fn try_get<'r, T, I>(&'r self, column: I) -> Result<T, sqlx::Error>
    where
        T: Decode<'r, Sqlite> + Type<Sqlite> + Decode<'r, Postgres> + Type<Postgres>,
        I: ColumnIndex<SqliteRow> + ColumnIndex<PgRow>,
    {
        match self {
            Row::Sqlite(row) => row.try_get(column),
            Row::Postgres(row) => row.try_get(column),
        }
    }

    /// The names of the columns, each with a value of its type.
    pub fn columns(&self) -> Result<Vec<(String, Value)>, sqlx::Error> {
        match self {
            Row::Sqlite(row) => row.columns().iter().map(typed).collect(),
            Row::Postgres(row) => row.columns().iter().map(typed).collect(),
        }
    }

    /// All values in the order of the columns.
    pub fn values(&self) -> Result<Vec<Value>, sqlx::Error> {
        let columns = self.columns()?.into_iter().enumerate();
        let value = |(number, (_, kind))| {
            Ok(match kind {
                Value::Text(_) => Value::Text(self.try_get(number)?),
                Value::Integer(_) => Value::Integer(self.try_get(number)?),
                Value::Real(_) => Value::Real(self.try_get(number)?),
            })
        };
        columns.map(value).collect()
    }
}

/// The name of a column, and NULL of its type.
fn typed<C: Column>(column: &C) -> Result<(String, Value), sqlx::Error> {
    Ok((column.name().to_owned(), null_of(column.type_info().name())?))
}

/// NULL of a type, by its name.
pub(super) fn null_of(name: &str) -> Result<Value, sqlx::Error> {
    Ok(match name {
        "TEXT" => Value::Text(None),
        "INTEGER" | "BIGINT" | "INT8" => Value::Integer(None),
        "REAL" | "FLOAT8" | "DOUBLE PRECISION" => Value::Real(None),
        other => return Err(sqlx::Error::Decode(format!("a column of type {other}").into())),
    })
}
