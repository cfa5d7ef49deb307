//! Files of rows: one for each table of an export, whose first line names the columns and their types.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, ErrorKind, Lines, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;

use super::StoreError;
use super::database::{
    Column, Executor, Row, Statement, Transaction, Value, is_duplicate, is_reference, query_of,
};
use super::exported_files::open_plain;
use super::exported_values::{JsonReader, TextForm, other_integer, told, wrong_file};
use crate::schema::wire::canonical::sha256_hex;

/// The first line of a file of rows: the names of the columns and their types.
#[derive(Serialize, Deserialize)]
#[serde(expecting = "an object with the `columns` of the table")]
struct Head {
    columns: Vec<(String, Kind)>,
}

#[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Text,
    Integer,
    Real,
}

impl Kind {
    fn of(value: &Value) -> Kind {
        match value {
            Value::Text(_) => Kind::Text,
            Value::Integer(_) => Kind::Integer,
            Value::Real(_) => Kind::Real,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Kind::Text => "text",
            Kind::Integer => "integers",
            Kind::Real => "numbers",
        }
    }
}

pub(super) async fn export_table(
    snapshot: &mut Transaction,
    table: &'static str,
    file: &Path,
) -> Result<usize, StoreError> {
    let mut out = BufWriter::new(File::create(file)?);
    let mut rows = 0;
    let mut take = |row: Row| {
        if rows == 0 {
            write_line(&mut out, &Head { columns: head(&row)? })?;
        }
        rows += 1;
        let values: Vec<Json> = row.values()?.into_iter().map(json).collect();
        write_line(&mut out, &values)
    };
    let all = query_of(format!("SELECT * FROM {table}")).without_timeout();
    all.run(Executor::Transaction(snapshot), &mut take).await?;
    out.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all()?;
    Ok(rows)
}

/// The rows of an exported table, one after the other.
pub(super) struct ExportedRows {
    table: String,
    /// The file, for errors.
    file: String,
    columns: Vec<(String, Kind)>,
    lines: Lines<BufReader<File>>,
    read: usize,
}

impl ExportedRows {
    /// `None` where the table had no rows.
    pub fn open(folder: &Path, table: &str) -> Result<Option<ExportedRows>, StoreError> {
        let file = folder.join(format!("{table}.ndjson"));
        let opened = open_plain(&file, "the manifest of the export names it")?;
        let mut lines = BufReader::new(opened).lines();
        let (table, file) = (table.to_owned(), file.display().to_string());
        let Some(head) = lines.next() else { return Ok(None) };
        let unreadable = |what: String| StoreError::Export(format!("{file}, line 1: {what}"));
        let Head { columns } = serde_json::from_str(&text_of(head, &unreadable)?)
            .map_err(|error| unreadable(told(&error)))?;
        let is_name = |name: &str| {
            name.bytes()
                .all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_')
        };
        if let Some((strange, _)) = columns.iter().find(|(name, _)| !is_name(name)) {
            return Err(unreadable(format!("{table} has no column {strange:?}")));
        }
        Ok(Some(ExportedRows { table, file, columns, lines, read: 0 }))
    }

    /// The next row, a value for each column, of its type.
    fn next_row(&mut self) -> Result<Option<Vec<Value>>, StoreError> {
        let Some(line) = self.lines.next() else { return Ok(None) };
        self.read += 1;
        let wanted = self.columns.len();
        let line = text_of(line, &|what| self.fault(&what))?;
        let values: Vec<Json> =
            serde_json::from_str(&line).map_err(|error| self.fault(&told(&error)))?;
        if values.len() != wanted {
            return Err(self.fault(&format!("{} values for {wanted} columns", values.len())));
        }
        let value = |(json, (name, kind)): (Json, &(String, Kind))| {
            value_of(json, *kind)
                .ok_or_else(|| self.fault(&format!("column {name} holds {}", kind.name())))
        };
        values.into_iter().zip(&self.columns).map(value).collect::<Result<_, _>>().map(Some)
    }

    /// The line of the row with this id, with its file.
    pub fn place_of(folder: &Path, table: &str, id: &str) -> Result<String, StoreError> {
        let file = folder.join(format!("{table}.ndjson")).display().to_string();
        let Some(mut rows) = ExportedRows::open(folder, table)? else { return Ok(file) };
        while let Some(values) = rows.next_row()? {
            if rows.id(&values) == Some(id) {
                return Ok(rows.place());
            }
        }
        Ok(file)
    }

    /// What is wrong with a file that has more rows than the manifest says, which are read once more.
    pub fn surplus(mut self, found: usize, declared: usize) -> StoreError {
        let counted = format!("the file has {found} rows, and the manifest says {declared}");
        let mut lines = BTreeMap::new();
        while let Some(line) = self.lines.next() {
            self.read += 1;
            let hash = match text_of(line, &|what| self.fault(&what)) {
                Ok(line) => sha256_hex(line.as_bytes()),
                Err(error) => return error,
            };
            if let Some(before) = lines.insert(hash, self.read + 1) {
                return self.fault(&format!("it repeats line {before}: {counted}"));
            }
        }
        StoreError::Export(format!("{} is longer than what was exported: {counted}", self.file))
    }

    /// The place of the row that was read last, whose line comes after the first one, that of the columns.
    fn place(&self) -> String {
        let (row, line) = (self.read, self.read + 1);
        format!("{}, line {line} (row {row})", self.file)
    }

    /// What is wrong with the row that was read last.
    fn fault(&self, what: &str) -> StoreError {
        StoreError::Export(format!("{}: {what}", self.place()))
    }

    /// An error of the database that is a fault of the row.
    fn refused(&self, error: sqlx::Error) -> StoreError {
        if is_duplicate(&error) {
            return self.fault(&format!("a row before it has the same key ({error})"));
        }
        if is_reference(&error) {
            return self.fault(&format!("it refers to a row that is not there ({error})"));
        }
        error.into()
    }

    /// The columns have to be those of the table, each once.
    fn check_columns(&self, known: &[Column]) -> Result<(), StoreError> {
        let fault = |what: String| StoreError::Export(format!("{}: {what}", self.file));
        for (place, (name, kind)) in self.columns.iter().enumerate() {
            if self.columns[..place].iter().any(|(before, _)| before == name) {
                return Err(fault(format!("column {name} is there twice")));
            }
            let Some(column) = known.iter().find(|column| column.name == *name) else {
                return Err(fault(format!("{} has no column {name}", self.table)));
            };
            let wanted = Kind::of(&column.null);
            if *kind != wanted {
                let (found, wanted) = (kind.name(), wanted.name());
                return Err(fault(format!("column {name} holds {wanted}, not {found}")));
            }
        }
        let is_missing =
            |column: &&Column| !self.columns.iter().any(|(name, _)| *name == column.name);
        match known.iter().find(is_missing) {
            Some(Column { name, .. }) => Err(fault(format!("column {name} is missing"))),
            None => Ok(()),
        }
    }

    /// Whether each column has to hold something, and what.
    fn check_values(
        &self,
        values: &[Value],
        wanted: &[(bool, Option<TextForm>)],
    ) -> Result<(), StoreError> {
        for ((value, (name, _)), (is_needed, wanted)) in
            values.iter().zip(&self.columns).zip(wanted)
        {
            if *is_needed && value.is_null() {
                return Err(self.fault(&format!("column {name} must not be null")));
            }
            if let Value::Integer(Some(number)) = value
                && let Some(wanted) = other_integer(name, *number)
            {
                return Err(self.fault(&format!("column {name} holds {wanted}, not {number}")));
            }
            let (Value::Text(Some(text)), Some(wanted)) = (value, wanted) else { continue };
            if let Err(reason) = wanted.read(text) {
                let holds = format!("column {name} holds {}", wanted.name);
                let Some(reason) = reason else { return Err(self.fault(&holds)) };
                let of =
                    self.id(values).map_or("this one".to_owned(), |id| format!("that of {id}"));
                let why = told(&reason);
                return Err(self.fault(&format!("{holds}, and {of} cannot be read: {why}")));
            }
        }
        Ok(())
    }

    /// The value of a row in one of the columns, if that is there.
    fn value<'a>(&self, values: &'a [Value], column: &str) -> Option<&'a Value> {
        let place = self.columns.iter().position(|(name, _)| name == column);
        place.map(|place| &values[place])
    }

    /// The id of a row that has one.
    fn id<'a>(&self, values: &'a [Value]) -> Option<&'a str> {
        match self.value(values, "id") {
            Some(Value::Text(Some(id))) => Some(id),
            _ => None,
        }
    }

    /// A row that names a blob has to name one of the manifest, and a file of a job to be that blob.
    fn check_blob(
        &self,
        values: &[Value],
        blobs: &BTreeMap<String, u64>,
    ) -> Result<(), StoreError> {
        let of = |wanted: &str| self.value(values, wanted);
        let bytes = match of("blob") {
            None => return Ok(()),
            Some(Value::Text(Some(blob))) => blobs.get(blob),
            Some(_) => None,
        };
        let bytes = bytes.ok_or_else(|| self.fault("its blob is none of those of the manifest"))?;
        let file = (of("name"), of("media_type"), of("bytes"));
        if let (
            Some(Value::Text(Some(name))),
            Some(Value::Text(Some(media_type))),
            Some(Value::Integer(Some(stated))),
        ) = file
            && let Some(wrong) = wrong_file(name, media_type, *stated, *bytes)
        {
            return Err(self.fault(&wrong));
        }
        Ok(())
    }

    /// Reads all rows, whose values have to be what the columns of the table take and what the service can read; `input` reads the
    /// inputs of jobs. `blobs` are those of the manifest, with their sizes, as far as they are known. Returns how many.
    pub fn check(
        mut self,
        known: &[Column],
        input: JsonReader,
        blobs: Option<&BTreeMap<String, u64>>,
    ) -> Result<usize, StoreError> {
        self.check_columns(known)?;
        let is_needed =
            |name: &str| known.iter().any(|column| column.name == name && column.is_needed);
        let wanted =
            |(name, _): &(String, Kind)| (is_needed(name), TextForm::of(&self.table, name, input));
        let wanted: Vec<(bool, Option<TextForm>)> = self.columns.iter().map(wanted).collect();
        while let Some(values) = self.next_row()? {
            self.check_values(&values, &wanted)?;
            blobs.map_or(Ok(()), |blobs| self.check_blob(&values, blobs))?;
        }
        Ok(self.read)
    }
}

pub(super) async fn import_table(
    transaction: &mut Transaction,
    table: &'static str,
    folder: &Path,
) -> Result<usize, StoreError> {
    let Some(mut rows) = ExportedRows::open(folder, table)? else { return Ok(0) };
    let names: Vec<&str> = rows.columns.iter().map(|(name, _)| name.as_str()).collect();
    let places: Vec<String> = (1..=names.len()).map(|number| format!("${number}")).collect();
    let (names, places) = (names.join(", "), places.join(", "));
    let insert = format!("INSERT INTO {table} ({names}) VALUES ({places})");
    while let Some(values) = rows.next_row()? {
        let statement = query_of(insert.clone());
        let statement = values.into_iter().fold(statement, Statement::bind);
        statement.execute(&mut *transaction).await.map_err(|error| rows.refused(error))?;
    }
    Ok(rows.read)
}

fn head(row: &Row) -> Result<Vec<(String, Kind)>, sqlx::Error> {
    Ok(row.columns()?.into_iter().map(|(name, value)| (name, Kind::of(&value))).collect())
}

fn json(value: Value) -> Json {
    match value {
        Value::Text(text) => text.into(),
        Value::Integer(number) => number.into(),
        Value::Real(number) => number.into(),
    }
}

/// `None` for a value of another type.
fn value_of(json: Json, kind: Kind) -> Option<Value> {
    Some(match (kind, json) {
        (Kind::Text, Json::Null) => Value::Text(None),
        (Kind::Integer, Json::Null) => Value::Integer(None),
        (Kind::Real, Json::Null) => Value::Real(None),
        (Kind::Text, Json::String(text)) => Value::Text(Some(text)),
        (Kind::Integer, Json::Number(number)) => Value::Integer(Some(number.as_i64()?)),
        (Kind::Real, Json::Number(number)) => Value::Real(Some(number.as_f64()?)),
        _ => return None,
    })
}

fn write_line(out: &mut impl Write, line: &impl Serialize) -> Result<(), sqlx::Error> {
    let mut text = serde_json::to_vec(line).map_err(std::io::Error::from)?;
    text.push(b'\n');
    Ok(out.write_all(&text)?)
}

/// A line that was read. One that is no text is a fault of the export, and not of the disk.
fn text_of(
    line: std::io::Result<String>,
    fault: &dyn Fn(String) -> StoreError,
) -> Result<String, StoreError> {
    line.map_err(|error| match error.kind() {
        ErrorKind::InvalidData => fault(error.to_string()),
        _ => StoreError::Files(error),
    })
}
