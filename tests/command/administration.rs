//! A deployment by command: what is not there is named, what is another's is left alone, what cannot be written is not served.

use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;
use std::process::{Command, Output};

use sqlx::{Connection as _, SqliteConnection};

use crate::program::{facies, path, text};

/// An empty deployment on SQLite.
fn made(data: &Path) {
    let done = facies(&["migrate", "--data", path(data)]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
}

/// The line that a command is refused with.
fn refused(done: &Output, code: i32, words: &str) {
    let told = text(&done.stderr);
    assert_eq!(done.status.code(), Some(code), "{told}");
    assert!(told.contains(words) && told.lines().count() == 1, "{words:?} is not in {told}");
}

#[test]
fn a_data_folder_that_is_not_there_is_named_and_not_made() {
    let folder = tempfile::tempdir().unwrap();
    let (data, backup) = (folder.path().join("typo"), folder.path().join("backup"));
    for command in [
        &["export", "--to", path(&backup)][..],
        &["fsck"],
        &["audit"],
        &["retention", "--days", "90"],
        &["key", "list"],
    ] {
        let done = facies(&[&["admin"][..], command, &["--data", path(&data)]].concat());
        refused(&done, 2, path(&data.join("facies.db")));
        assert!(!data.exists() && !backup.exists(), "{command:?}");
    }
    // The first key of a deployment is made before its service starts.
    let key = facies(&["admin", "key", "new", "--label", "first", "--data", path(&data)]);
    assert_eq!(key.status.code(), Some(0), "{}", text(&key.stderr));
    assert_eq!(facies(&["admin", "fsck", "--data", path(&data)]).status.code(), Some(0));
}

#[test]
fn an_export_into_a_folder_and_an_import_over_rows_are_refused_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let [data, new, backup] = ["data", "new", "backup"].map(|name| folder.path().join(name));
    made(&data);
    let export = ["admin", "export", "--data", path(&data), "--to", path(&backup)];
    assert_eq!(facies(&export).status.code(), Some(0));
    refused(&facies(&export), 2, "it has to be a new folder");
    let import = |from: &Path, data: &Path| {
        facies(&["admin", "import", "--from", path(from), "--data", path(data)])
    };
    refused(&import(&folder.path().join("nothing"), &new), 2, "the export cannot be read");
    assert!(!new.exists(), "what was made for it is gone");
    assert_eq!(import(&backup, &new).status.code(), Some(0));
    let key = facies(&["admin", "key", "new", "--label", "mine", "--data", path(&new)]);
    assert_eq!(key.status.code(), Some(0), "{}", text(&key.stderr));
    refused(&import(&backup, &new), 2, "there is something in this deployment already");
    assert!(new.join("facies.db").is_file());
}

#[test]
fn blobs_of_another_database_are_not_repaired() {
    let folder = tempfile::tempdir().unwrap();
    let [one, other, blobs] = ["one", "other", "blobs"].map(|name| folder.path().join(name));
    made(&one);
    made(&other);
    let fsck = |data: &Path, option: &[&str]| {
        let places = ["admin", "fsck", "--data", path(data), "--blobs", path(&blobs)];
        facies(&[&places[..], option].concat())
    };
    assert_eq!(fsck(&one, &[]).status.code(), Some(0));
    let mark = fs::read(blobs.join("facies-owner")).unwrap();
    let mesh = blobs.join("ab/abcd");
    fs::create_dir(blobs.join("ab")).unwrap();
    fs::write(&mesh, "a mesh").unwrap();
    refused(&fsck(&other, &["--repair"]), 78, "the mark of another database");
    let serve = ["serve", "--bind", "127.0.0.1:0", "--log-level", "error", "--data", path(&other)];
    refused(&facies(&[&serve[..], &["--blobs", path(&blobs)]].concat()), 78, "facies-owner");
    assert!(mesh.exists() && fs::read(blobs.join("facies-owner")).unwrap() == mark);
    assert_eq!(fsck(&one, &[]).status.code(), Some(1), "known to no row");
    assert_eq!(fsck(&one, &["--repair"]).status.code(), Some(0));
    assert!(!mesh.exists() && blobs.join("facies-owner").exists());
}

#[test]
fn a_database_that_can_only_be_read_ends_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    made(&data);
    let file = data.join("facies.db");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o444)).unwrap();
    let program = env!("CARGO_BIN_EXE_facies");
    let mut command = match fs::metadata(&file).unwrap().uid() {
        // Who is root writes whatever file, unless this is taken away.
        0 => {
            let mut command = Command::new("setpriv");
            command.args(["--bounding-set=-dac_override", "--inh-caps=-dac_override", program]);
            command
        }
        _ => Command::new(program),
    };
    command.args(["serve", "--bind", "127.0.0.1:0", "--log-level", "error", "--data"]);
    refused(&command.arg(&data).output().unwrap(), 78, path(&file));
}

#[test]
fn a_data_folder_that_cannot_be_made_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    let data = file.join("data");
    let serve = ["serve", "--bind", "127.0.0.1:0", "--log-level", "error", "--data", path(&data)];
    refused(&facies(&serve), 78, path(&data));
    for data in [&data, &file] {
        let key = ["admin", "key", "new", "--label", "first", "--data", path(data)];
        refused(&facies(&key), 78, path(data));
        refused(&facies(&["admin", "fsck", "--data", path(data)]), 78, path(data));
    }
}

/// Runs SQL in the database of a deployment that nobody serves.
async fn changed(data: &Path, sql: &'static str) {
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(data.join("facies.db"));
    let mut connection = SqliteConnection::connect_with(&options).await.unwrap();
    sqlx::raw_sql(sql).execute(&mut connection).await.unwrap();
    connection.close().await.unwrap();
}

#[tokio::test]
async fn a_database_of_an_earlier_program_is_refused_and_stays_one_that_it_can_open() {
    let folder = tempfile::tempdir().unwrap();
    let [data, backup] = ["data", "backup"].map(|name| folder.path().join(name));
    made(&data);
    changed(&data, "DELETE FROM _sqlx_migrations WHERE version > 18").await;
    for command in [
        &["fsck"][..],
        &["fsck", "--repair"],
        &["export", "--to", path(&backup)],
        &["audit"],
        &["clock"],
        &["retention", "--days", "90"],
        &["key", "list"],
        &["key", "new", "--label", "first"],
        &["import", "--from", path(&backup)],
    ] {
        let done = facies(&[&["admin"][..], command, &["--data", path(&data)]].concat());
        refused(&done, 78, "is at schema step 18 and this program needs step");
        refused(&done, 78, "Copy the data folder");
        assert_eq!(newest_step(&data).await, 18, "{command:?}");
    }
    assert!(!backup.exists());
}

#[tokio::test]
async fn a_list_of_keys_shows_unseen_characters_of_labels_as_text_and_when_keys_end() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    let new = |label| facies(&["admin", "key", "new", "--label", label, "--data", path(&data)]);
    refused(&new("\u{1b}[2J\nroot"), 2, "/label: a name has no control characters");
    refused(
        &new("ward\u{202e}7"),
        2,
        "/label: a label has no letters that nobody sees, and this one has \\u{202e}",
    );
    assert_eq!(new("Anna's \"C:\\ward\"").status.code(), Some(0));
    let list = ["admin", "key", "list", "--data", path(&data)];
    let ends = |label: &str| {
        let told = text(&facies(&list).stdout);
        assert!(told.ends_with(&format!("  read write run  {label}\n")), "{told:?}");
        assert_eq!(told.lines().count(), 1);
    };
    ends("Anna's \"C:\\ward\"");
    changed(
        &data,
        "UPDATE keys SET label = char(27) || '[2J' || char(10) || 'root' || char(155, 8203)",
    )
    .await;
    ends("\\u{1b}[2J\\nroot\\u{9b}\\u{200b}");
    let tells = |state: &str| {
        let told = text(&facies(&list).stdout);
        assert!(told.contains(&format!("  {state}  ")), "{told:?}");
    };
    tells("lasts");
    changed(&data, "UPDATE keys SET expires = 1795176912345").await;
    tells("until 2026-11-20T12:15:12Z");
    changed(&data, "UPDATE keys SET revoked = 1795176912345").await;
    tells("revoked");
}

/// The last schema step of a deployment that nobody serves.
async fn newest_step(data: &Path) -> i64 {
    let options = sqlx::sqlite::SqliteConnectOptions::new().filename(data.join("facies.db"));
    let mut connection = SqliteConnection::connect_with(&options).await.unwrap();
    let asked = sqlx::query_scalar("SELECT MAX(version) FROM _sqlx_migrations");
    let step = asked.fetch_one(&mut connection).await.unwrap();
    connection.close().await.unwrap();
    step
}

#[test]
fn a_database_with_a_damaged_page_is_not_exported_and_fsck_names_the_page() {
    const PAGE: usize = 4096;
    let folder = tempfile::tempdir().unwrap();
    let [data, backup] = ["data", "backup"].map(|name| folder.path().join(name));
    made(&data);
    let fsck = ["admin", "fsck", "--data", path(&data)];
    assert_eq!(facies(&fsck).status.code(), Some(0));
    let file = data.join("facies.db");
    let mut bytes = fs::read(&file).unwrap();
    let pages = bytes.len() / PAGE;
    bytes[(pages - 1) * PAGE..].fill(0);
    fs::write(&file, bytes).unwrap();
    // Page or page, as SQLite writes it.
    let named = format!("age {pages}: ");
    refused(&facies(&[&fsck[..], &["--repair"]].concat()), 1, &named);
    let export = ["admin", "export", "--data", path(&data), "--to", path(&backup)];
    let told = facies(&export);
    refused(&told, 1, path(&file));
    refused(&told, 1, &named);
    assert!(!backup.exists());
}

#[tokio::test]
async fn a_row_that_an_import_would_refuse_is_not_exported_and_fsck_finds_it() {
    let folder = tempfile::tempdir().unwrap();
    let [data, backup] = ["data", "backup"].map(|name| folder.path().join(name));
    let key = facies(&["admin", "key", "new", "--label", "first", "--data", path(&data)]);
    assert_eq!(key.status.code(), Some(0), "{}", text(&key.stderr));
    let fsck = ["admin", "fsck", "--read-all", "--data", path(&data)];
    assert_eq!(facies(&fsck).status.code(), Some(0));
    changed(&data, "UPDATE keys SET scopes = 'something else'").await;
    let row = "keys.ndjson, line 2 (row 1): column scopes holds scopes";
    refused(&facies(&fsck), 1, &format!("is damaged: {row}. "));
    let export = ["admin", "export", "--data", path(&data), "--to", path(&backup)];
    refused(&facies(&export), 1, row);
    assert!(!backup.join("export.json").exists(), "what is there is no export");
}

#[tokio::test]
async fn a_new_database_beside_old_blobs_is_refused_and_one_that_was_served_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    made(&data);
    let blobs = data.join("blobs");
    fs::create_dir_all(blobs.join("ab")).unwrap();
    fs::write(blobs.join("ab/abcd"), "a mesh").unwrap();
    let fsck = ["admin", "fsck", "--repair", "--data", path(&data)];
    refused(&facies(&fsck), 78, path(&blobs));
    let serve = ["serve", "--bind", "127.0.0.1:0", "--log-level", "error", "--data", path(&data)];
    refused(&facies(&serve), 78, "Restore the database from a backup");
    assert!(blobs.join("ab/abcd").exists());
    changed(&data, "INSERT INTO seen_clock (number, trusted, latest) VALUES (1, 1, 1)").await;
    let found = facies(&["admin", "fsck", "--data", path(&data)]);
    assert_eq!(text(&found.stdout), "known to no row: ab/abcd\n");
}

#[tokio::test]
async fn a_clock_far_behind_is_told_until_it_is_confirmed() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    made(&data);
    let clock = ["admin", "clock", "--data", path(&data)];
    assert_eq!(text(&facies(&clock).stdout), "retention trusts the clock\n");
    let seen = "INSERT INTO seen_clock (number, trusted, latest) VALUES (1, 4102444800000, 4102444800000 - 73 * 3600000)";
    changed(&data, seen).await;
    refused(&facies(&clock), 1, "the clock is 73 h behind");
    let trusted = facies(&["admin", "clock", "--trust", "--data", path(&data)]);
    assert_eq!(text(&trusted.stdout), "retention trusts the clock\n");
    assert_eq!(text(&facies(&clock).stdout), "retention trusts the clock\n");
}

#[tokio::test]
async fn a_document_that_the_service_could_not_read_is_neither_exported_nor_imported() {
    const CASE: &str = "INSERT INTO cases (id, document, report, version, created, updated) \
         VALUES ('a', '{\"units\":\"mm\",\"volume\":\"\"}', 'null', 1, 0, 0)";
    const JOB: &str = "INSERT INTO jobs (id, kind, document, spec_hash, engine, status, progress, attempt, losses, claimable_from, \
         created, updated) VALUES ('b', 'predict', '{\"predict\":{\"case\":null,\"plan\":{},\"spec\":{}}}', '', \
         '{\"name\":\"\",\"version\":\"\",\"target\":\"\",\"profile\":\"\"}', 'accepted', 0, 0, 0, 0, 0, 0)";
    let folder = tempfile::tempdir().unwrap();
    let [data, new, backup] = ["data", "new", "backup"].map(|name| folder.path().join(name));
    made(&data);
    changed(&data, CASE).await;
    // It waits for the mesh of its case.
    changed(&data, JOB).await;
    let fsck = ["admin", "fsck", "--read-all", "--data", path(&data)];
    assert_eq!(facies(&fsck).status.code(), Some(0));
    let export = |to: &Path| facies(&["admin", "export", "--data", path(&data), "--to", path(to)]);
    assert_eq!(export(&backup).status.code(), Some(0));
    let faults = [
        (
            "cases.ndjson",
            "\"{\\\"units\\\":\\\"mm\\\",\\\"volume\\\":\\\"\\\"}\"",
            "a case, and that of a cannot",
        ),
        (
            "jobs.ndjson",
            "\"{\\\"predict\\\":{\\\"case\\\":null,\\\"plan\\\":{},\\\"spec\\\":{}}}\"",
            "the input of a job, and that of b cannot",
        ),
    ];
    for (file, document, wanted) in faults {
        let file = backup.join(file);
        let whole = fs::read_to_string(&file).unwrap();
        let changed = whole.replace(document, "\"{}\"");
        assert_ne!(changed, whole);
        fs::write(&file, changed).unwrap();
        let import = ["admin", "import", "--from", path(&backup), "--data", path(&new)];
        let told = facies(&import);
        let place = format!("{}, line 2 (row 1): column document holds {wanted}", file.display());
        refused(&told, 2, &place);
        assert!(!new.exists(), "nothing of it is stored");
        fs::write(&file, whole).unwrap();
    }
    changed(&data, "UPDATE jobs SET document = '{}'").await;
    let row =
        "jobs.ndjson, line 2 (row 1): column document holds the input of a job, and that of b";
    refused(&facies(&fsck), 1, row);
    refused(&export(&folder.path().join("other")), 1, row);
}
