//! Database and blob store of a deployment.

use std::path::{Path, PathBuf};

use super::secret::{ConfigError, Secret};

/// The folder of this process, the database and the blobs.
#[derive(Clone, Debug)]
pub struct StorageLocations {
    /// For this process alone: files under way, and whatever has no other place.
    pub data: PathBuf,
    pub database: DatabaseLocation,
    pub blobs: BlobLocation,
}

#[derive(Clone, Debug)]
pub enum DatabaseLocation {
    /// SQLite in the data folder, for one process.
    Embedded,
    /// PostgreSQL, for any number of processes.
    Server { address: Secret, connections: u32 },
}

#[derive(Clone, Debug, PartialEq)]
pub enum BlobLocation {
    /// In the data folder, for one process.
    InData,
    /// In a folder that several processes may share.
    Folder(PathBuf),
    /// In an S3-compatible store. Its settings have the names of the usual AWS_* variables.
    Bucket { bucket: String, prefix: String, settings: Vec<(String, Secret)> },
}

impl StorageLocations {
    /// Everything in one folder.
    pub fn in_folder(data: &Path) -> StorageLocations {
        StorageLocations {
            data: data.to_owned(),
            database: DatabaseLocation::Embedded,
            blobs: BlobLocation::InData,
        }
    }

    /// Whether the folders are some, or can be made, as far as this can be told without making them.
    pub fn check_folders(&self) -> Result<(), ConfigError> {
        let blobs = match &self.blobs {
            BlobLocation::Folder(folder) => Some(("blobs", folder)),
            BlobLocation::InData | BlobLocation::Bucket { .. } => None,
        };
        for (name, folder) in [("data", &self.data)].into_iter().chain(blobs) {
            let known = folder.ancestors().find_map(|at| Some((at, at.metadata().ok()?)));
            if let Some((at, _)) = known.filter(|(_, found)| !found.is_dir()) {
                return Err(ConfigError::NoFolder { name, folder: folder.clone(), at: at.into() });
            }
        }
        Ok(())
    }

    /// Whether the address of a server is one; `fault` tells what is wrong with it.
    pub fn check_address(&self, fault: impl Fn(&str) -> Option<String>) -> Result<(), ConfigError> {
        let DatabaseLocation::Server { address, .. } = &self.database else { return Ok(()) };
        fault(address.reveal()).map_or(Ok(()), |reason| {
            let address = without_password(address.reveal());
            Err(ConfigError::DatabaseAddress { address, reason })
        })
    }

    /// What keeps another process from working on the same jobs.
    pub fn check_shared(&self) -> Result<(), ConfigError> {
        match (&self.database, &self.blobs) {
            (DatabaseLocation::Embedded, _) => Err(ConfigError::NotShared { name: "database" }),
            (_, BlobLocation::InData) => Err(ConfigError::NotShared { name: "blobs" }),
            _ => Ok(()),
        }
    }
}

/// The address of a PostgreSQL, or nothing.
pub(super) fn database(address: String, connections: u32) -> Result<DatabaseLocation, ConfigError> {
    if address.is_empty() {
        return Ok(DatabaseLocation::Embedded);
    }
    if !["postgres://", "postgresql://"].iter().any(|scheme| address.starts_with(scheme)) {
        return Err(ConfigError::Database);
    }
    if has_late_at(&address) {
        return Err(ConfigError::DatabasePassword);
    }
    Ok(DatabaseLocation::Server { address: Secret::new(address), connections })
}

/// `s3://bucket/prefix`, a folder, or nothing.
pub(super) fn blobs(place: &str) -> Result<BlobLocation, ConfigError> {
    let refused = || ConfigError::Value {
        name: "blobs",
        value: place.to_owned(),
        wanted: "s3://bucket, s3://bucket/prefix or a folder",
    };
    if place.is_empty() {
        return Ok(BlobLocation::InData);
    }
    let Some((scheme, rest)) = place.split_once("://") else {
        return Ok(BlobLocation::Folder(place.into()));
    };
    let (bucket, prefix) = rest.split_once('/').unwrap_or((rest, ""));
    if scheme != "s3" || bucket.is_empty() {
        return Err(refused());
    }
    Ok(BlobLocation::Bucket {
        bucket: bucket.to_owned(),
        prefix: prefix.trim_matches('/').to_owned(),
        settings: aws_variables(),
    })
}

/// The address of a collector of OpenTelemetry without a slash at its end, or nothing. Credentials belong into headers.
pub(super) fn collector(address: String) -> Result<Option<String>, ConfigError> {
    if address.is_empty() {
        return Ok(None);
    }
    let is_plain = |url: &reqwest::Url| {
        let has_key = !url.username().is_empty() || url.password().is_some();
        let is_web = matches!(url.scheme(), "http" | "https");
        is_web && !has_key && url.query().is_none() && url.fragment().is_none()
    };
    match reqwest::Url::parse(&address).ok().filter(is_plain) {
        Some(url) => Ok(Some(url.as_str().trim_end_matches('/').to_owned())),
        None => Err(ConfigError::Value {
            name: "traces",
            value: without_password(&address),
            wanted: "http:// or https:// with a host and perhaps a port and a path",
        }),
    }
}

/// Endpoint, region and credentials, where every program looks for them.
fn aws_variables() -> Vec<(String, Secret)> {
    let variables = std::env::vars_os().filter_map(|(name, value)| {
        let name = name.into_string().ok().filter(|name| name.starts_with("AWS_"))?;
        Some((name, Secret::new(value.into_string().ok()?)))
    });
    variables.collect()
}

/// Whether the last `@` of an address comes after what ends user and password, as where these hold a `/`, `?` or `#` as it is: the rest
/// of the password would be taken for the name of the database.
fn has_late_at(address: &str) -> bool {
    let rest = address.split_once("://").map_or(address, |(_, rest)| rest);
    rest.rsplit_once('@').is_some_and(|(before, _)| before.contains(['/', '?', '#']))
}

/// An address of a database as it may be shown: without its password. One whose password cannot be told from the rest is hidden.
pub(super) fn without_password(address: &str) -> String {
    let Some((scheme, rest)) = address.split_once("://") else { return "…".to_owned() };
    let host = rest.split(['/', '?', '#']).next().unwrap_or_default();
    // A password without a host behind it is in the place of a port.
    let port =
        host.rsplit_once(':').filter(|(name, _)| !name.contains('@') && !host.ends_with(']'));
    let is_port = |port: &str| port.bytes().all(|byte| byte.is_ascii_digit());
    if has_late_at(address) || (!host.contains('@') && port.is_some_and(|(_, port)| !is_port(port)))
    {
        return format!("{scheme}://…");
    }
    let end = rest.find(['/', '?']).unwrap_or(rest.len());
    let (authority, path) = rest.split_at(end);
    let authority = match authority.rsplit_once('@') {
        Some((user, host)) => match user.split_once(':') {
            Some((user, _)) => format!("{user}:…@{host}"),
            None => authority.to_owned(),
        },
        None => authority.to_owned(),
    };
    let path = match path.split_once('?') {
        Some((path, parameters)) => {
            let hidden = |parameter: &str| match parameter.split_once('=') {
                Some((name, _)) if name.contains("password") => format!("{name}=…"),
                _ => parameter.to_owned(),
            };
            let parameters: Vec<_> = parameters.split('&').map(hidden).collect();
            format!("{path}?{}", parameters.join("&"))
        }
        None => path.to_owned(),
    };
    format!("{scheme}://{authority}{path}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bucket_and_a_folder_are_distinguished() {
        let bucket = |bucket: &str, prefix: &str| BlobLocation::Bucket {
            bucket: bucket.into(),
            prefix: prefix.into(),
            settings: aws_variables(),
        };
        assert_eq!(blobs("").unwrap(), BlobLocation::InData);
        assert_eq!(blobs("/srv/blobs").unwrap(), BlobLocation::Folder("/srv/blobs".into()));
        assert_eq!(blobs("s3://faces").unwrap(), bucket("faces", ""));
        assert_eq!(blobs("s3://faces/of/ward/").unwrap(), bucket("faces", "of/ward"));
        for wrong in ["s3://", "s3:///x", "http://x/y"] {
            assert!(blobs(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_password_is_never_shown() {
        for (address, shown) in [
            ("postgres://a:b@h:5432/d", "postgres://a:…@h:5432/d"),
            ("postgres://a:b@c@h/d?sslmode=require", "postgres://a:…@h/d?sslmode=require"),
            ("postgres://a@h/d?password=x&host=y", "postgres://a@h/d?password=…&host=y"),
            ("postgres://h/d", "postgres://h/d"),
            ("postgres://[::1]:5432/d", "postgres://[::1]:5432/d"),
            ("postgres://a:b/c@h/d", "postgres://…"),
            ("postgres://a:b?c@h/d", "postgres://…"),
            ("postgres://a:b#c@h/d", "postgres://…"),
            ("postgres://a:1/c@h/d", "postgres://…"),
            ("postgres://h/d?password=x@y", "postgres://…"),
            ("postgres://a:b/d", "postgres://…"),
            ("postgress://a:b@h/d", "postgress://a:…@h/d"),
            ("postgres:x", "…"),
        ] {
            assert_eq!(without_password(address), shown);
        }
    }
}
