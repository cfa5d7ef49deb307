//! A deployment by command: what is not there is named, what is another's is left alone, what cannot be written is not served.

use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::Path;
use std::process::{Command, Output};

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
