//! Every setting of the service, read once at the start from flags, `FACIES_*` variables and a file.

pub mod file;
mod listeners;
mod log_filter;
mod secret;
mod settings;
mod storage_locations;
pub use secret::{ConfigError, Secret};
pub use settings::{SETTINGS, Setting};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;
pub use storage_locations::{BlobLocation, DatabaseLocation, StorageLocations};

/// The settings in force.
#[derive(Clone, Debug)]
pub struct Config {
    pub listen: SocketAddr,
    pub places: StorageLocations,
    pub api_key: Option<Secret>,
    /// Whether a request without a key is refused.
    pub requires_keys: bool,
    pub admin_key: Option<Secret>,
    pub admin_listen: Option<SocketAddr>,
    pub allowed_origins: Vec<String>,
    /// Names beside those of this machine by which a service that asks for no key may be called, in lower case.
    pub allowed_hosts: Vec<String>,
    /// Packages of the clients, which are served as they are.
    pub clients_folder: Option<PathBuf>,
    pub requests_per_minute: u32,
    pub event_streams: u32,
    /// Keys in force that a tenant may have.
    pub most_keys: u32,
    pub workers: usize,
    pub threads_per_job: usize,
    pub slot_memory_bytes: Option<u64>,
    pub lease: Duration,
    pub heartbeat: Duration,
    pub attempts: u32,
    pub grace: Duration,
    pub upload_bytes: usize,
    pub waiting_requests: u32,
    /// Longest check of a case or a job within its request.
    pub check: Duration,
    pub bodies_bytes: u64,
    pub client_bodies_bytes: u64,
    pub body_idle: Duration,
    pub mesh_cache_bytes: usize,
    pub response_cache_bytes: usize,
    pub free_space_floor_bytes: u64,
    pub log: LogConfig,
    /// The address of the collector of traces.
    pub traces: Option<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct LogConfig {
    pub json: bool,
    pub filter: String,
}

const MIB: usize = 1 << 20;

impl Config {
    /// Takes each setting from `given` (its value by its name) or from its default, and checks it.
    pub fn new(given: impl Fn(&str) -> Option<String>) -> Result<Config, ConfigError> {
        let config = Config::without_listener(given)?;
        config.check_listeners()?;
        if !config.listen.ip().is_loopback() && !config.requires_keys {
            return Err(ConfigError::OpenWithoutKey(config.listen));
        }
        Ok(config)
    }

    /// The same for a process that listens nowhere.
    pub fn without_listener(given: impl Fn(&str) -> Option<String>) -> Result<Config, ConfigError> {
        let read = Reader {
            text: |name: &str| given(name).unwrap_or_else(|| default_of(name).to_owned()),
        };
        let config = Config {
            listen: read.parsed("bind", "an address with a port, e.g. 127.0.0.1:8080")?,
            places: read.places()?,
            requires_keys: read.requires_keys()?,
            api_key: read.key("api-key")?,
            admin_key: read.key("admin-key")?,
            admin_listen: read.admin_listen()?,
            allowed_origins: read.list("allowed-origins", is_origin)?,
            allowed_hosts: read.hosts()?,
            clients_folder: read.clients_folder(),
            requests_per_minute: read.whole("requests-per-minute", 0..=10_000_000)? as u32,
            event_streams: read.whole("event-streams", 1..=10_000)? as u32,
            most_keys: read.whole("keys", 1..=100_000)? as u32,
            workers: read.whole("workers", 0..=64)?,
            threads_per_job: read.threads_per_job()?,
            slot_memory_bytes: read.slot_memory()?,
            lease: read.seconds("lease-s", 0.5, 3600.0)?,
            heartbeat: read.seconds("heartbeat-s", 0.1, 1800.0)?,
            attempts: read.whole("attempts", 1..=10)? as u32,
            grace: read.seconds("grace-s", 0.0, 3600.0)?,
            upload_bytes: read.whole("upload-mib", 1..=4096)? * MIB,
            waiting_requests: read.whole("waiting-requests", 1..=100_000)? as u32,
            check: read.seconds("check-s", 1.0, 3600.0)?,
            bodies_bytes: (read.whole("bodies-mib", 1..=MIB)? * MIB) as u64,
            client_bodies_bytes: (read.whole("client-bodies-mib", 1..=MIB)? * MIB) as u64,
            body_idle: read.seconds("body-idle-s", 0.1, 600.0)?,
            mesh_cache_bytes: read.whole("mesh-cache-mib", 0..=MIB)? * MIB,
            response_cache_bytes: read.whole("response-cache-mib", 0..=MIB)? * MIB,
            free_space_floor_bytes: (read.whole("free-space-floor-mib", 0..=MIB)? * MIB) as u64,
            log: LogConfig { json: read.json_log()?, filter: read.log_filter()? },
            traces: storage_locations::collector((read.text)("traces"))?,
        };
        config.checked()
    }

    /// Refuses two listeners of one process on the same port.
    pub fn check_listeners(&self) -> Result<(), ConfigError> {
        match self.admin_listen {
            Some(admin) if listeners::overlap(self.listen, admin) => {
                Err(ConfigError::SameListeners(admin))
            }
            _ => Ok(()),
        }
    }

    fn checked(self) -> Result<Config, ConfigError> {
        if self.heartbeat * 2 > self.lease {
            return Err(ConfigError::Heartbeat {
                heartbeat: self.heartbeat.as_secs_f64(),
                lease: self.lease.as_secs_f64(),
            });
        }
        Ok(self)
    }
}

fn default_of(name: &str) -> &'static str {
    SETTINGS.iter().find(|setting| setting.name == name).map_or("", |setting| setting.default)
}

struct Reader<Text> {
    text: Text,
}

impl<Text: Fn(&str) -> String> Reader<Text> {
    fn parsed<T: std::str::FromStr>(
        &self,
        name: &'static str,
        wanted: &'static str,
    ) -> Result<T, ConfigError> {
        let value = (self.text)(name);
        value.parse().ok().filter(|_| !value.is_empty()).ok_or(ConfigError::Value {
            name,
            value,
            wanted,
        })
    }

    fn whole(
        &self,
        name: &'static str,
        range: std::ops::RangeInclusive<usize>,
    ) -> Result<usize, ConfigError> {
        let value = (self.text)(name);
        let number = value.parse().ok().filter(|number| range.contains(number));
        number.ok_or_else(|| out_of_range(name, value))
    }

    fn seconds(&self, name: &'static str, least: f64, most: f64) -> Result<Duration, ConfigError> {
        let value = (self.text)(name);
        let number = value.parse().ok();
        number
            .filter(|number| (least..=most).contains(number))
            .map(Duration::from_secs_f64)
            .ok_or_else(|| out_of_range(name, value))
    }

    fn places(&self) -> Result<StorageLocations, ConfigError> {
        let connections = self.whole("database-connections", 2..=1000)? as u32;
        Ok(StorageLocations {
            data: self.parsed("data", "a folder")?,
            database: storage_locations::database((self.text)("database"), connections)?,
            blobs: storage_locations::blobs(&(self.text)("blobs"))?,
        })
    }

    fn requires_keys(&self) -> Result<bool, ConfigError> {
        const NAME: &str = "ask-for-keys";
        match (self.text)(NAME).as_str() {
            "true" => Ok(true),
            "false" => Ok(!(self.text)("api-key").is_empty()),
            value => {
                let value = value.to_owned();
                Err(ConfigError::Value { name: NAME, value, wanted: "true or false" })
            }
        }
    }

    fn key(&self, name: &'static str) -> Result<Option<Secret>, ConfigError> {
        let key = (self.text)(name);
        if key.is_empty() {
            return Ok(None);
        }
        if !(16..=255).contains(&key.len()) || !key.bytes().all(|byte| byte.is_ascii_graphic()) {
            return Err(ConfigError::Key(name));
        }
        Ok(Some(Secret(key)))
    }

    /// Without a number, the processors that a slot has for itself.
    fn threads_per_job(&self) -> Result<usize, ConfigError> {
        const NAME: &str = "threads-per-job";
        if !(self.text)(NAME).is_empty() {
            return self.whole(NAME, 1..=64);
        }
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        Ok((processors / self.whole("workers", 0..=64)?.max(1)).clamp(1, 64))
    }

    fn slot_memory(&self) -> Result<Option<u64>, ConfigError> {
        const NAME: &str = "slot-memory-mib";
        match (self.text)(NAME).as_str() {
            "" => Ok(None),
            _ => Ok(Some((self.whole(NAME, 64..=4 * MIB)? * MIB) as u64)),
        }
    }

    fn admin_listen(&self) -> Result<Option<SocketAddr>, ConfigError> {
        match (self.text)("admin-bind").as_str() {
            "" => Ok(None),
            _ => self.parsed("admin-bind", "an address with a port, e.g. 127.0.0.1:9090").map(Some),
        }
    }

    /// Words with commas between them.
    fn list(
        &self,
        name: &'static str,
        is_word: fn(&str) -> bool,
    ) -> Result<Vec<String>, ConfigError> {
        let value = (self.text)(name);
        let words = value.split(',').map(str::trim).filter(|word| !word.is_empty());
        let words: Vec<String> = words.map(str::to_owned).collect();
        match words.iter().all(|word| is_word(word)) {
            true => Ok(words),
            false => Err(out_of_range(name, value)),
        }
    }

    fn clients_folder(&self) -> Option<PathBuf> {
        Some((self.text)("clients-folder")).filter(|folder| !folder.is_empty()).map(PathBuf::from)
    }

    fn hosts(&self) -> Result<Vec<String>, ConfigError> {
        let hosts = self.list("allowed-hosts", is_host)?;
        Ok(hosts.iter().map(|host| host.to_ascii_lowercase()).collect())
    }

    fn log_filter(&self) -> Result<String, ConfigError> {
        let value = (self.text)("log-level");
        match log_filter::is_log_filter(&value) {
            true => Ok(value),
            false => Err(out_of_range("log-level", value)),
        }
    }

    fn json_log(&self) -> Result<bool, ConfigError> {
        let value = (self.text)("log-format");
        match value.as_str() {
            "json" => Ok(true),
            "text" => Ok(false),
            _ => Err(out_of_range("log-format", value)),
        }
    }
}

/// Scheme, host and perhaps a port, as a browser writes them; no wildcard, which would let everybody in.
fn is_origin(text: &str) -> bool {
    let host = text.strip_prefix("https://").or_else(|| text.strip_prefix("http://"));
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b".-:[]".contains(&byte);
    host.is_some_and(|host| !host.is_empty() && host.bytes().all(plain))
}

/// A name or an address, without a port; no wildcard, which would let in every name that resolves to this machine.
fn is_host(text: &str) -> bool {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b".-".contains(&byte);
    text.bytes().all(plain)
}

fn out_of_range(name: &'static str, value: String) -> ConfigError {
    let wanted =
        SETTINGS.iter().find(|setting| setting.name == name).map_or("", |setting| setting.about);
    ConfigError::Value { name, value, wanted }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config(given: &[(&str, &str)]) -> Result<Config, ConfigError> {
        Config::new(|name| {
            given.iter().find(|(key, _)| *key == name).map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn the_defaults_are_valid_and_stay_on_this_machine() {
        let config = config(&[]).unwrap();
        assert!(config.listen.ip().is_loopback());
        assert_eq!(config.lease, Duration::from_secs(15));
        assert_eq!(config.upload_bytes, 256 << 20);
    }

    #[test]
    fn slots_share_the_processors_where_nothing_else_is_said() {
        let threads = |given: &[(&str, &str)]| config(given).unwrap().threads_per_job;
        let processors = std::thread::available_parallelism().unwrap().get();
        assert_eq!(threads(&[("workers", "1")]), processors.min(64));
        assert_eq!(threads(&[("workers", "64")]), (processors / 64).max(1));
        assert_eq!(threads(&[("workers", "1"), ("threads-per-job", "3")]), 3);
    }

    #[test]
    fn an_address_that_others_reach_needs_a_key() {
        let open = ("bind", "0.0.0.0:80");
        assert!(matches!(config(&[open]), Err(ConfigError::OpenWithoutKey(_))));
        assert!(config(&[open, ("api-key", "0123456789abcdef")]).is_ok());
    }

    #[test]
    fn a_value_outside_its_range_is_named_with_its_range() {
        for (name, value) in [
            ("workers", "65"),
            ("workers", "-1"),
            ("threads-per-job", "0"),
            ("slot-memory-mib", "63"),
            ("lease-s", "nan"),
            ("lease-s", "1e9"),
            ("upload-mib", "0"),
            ("log-format", "xml"),
            ("log-level", "warning"),
            ("log-level", ""),
            ("api-key", "short"),
            ("bind", "localhost"),
            ("admin-bind", "9090"),
            ("allowed-origins", "*"),
            ("allowed-origins", "https://a.example/path"),
            ("allowed-hosts", "*.example"),
            ("allowed-hosts", "planning:8080"),
            ("event-streams", "0"),
            ("data", ""),
            ("database", "mysql://x"),
            ("database-connections", "1"),
            ("blobs", "ftp://x"),
            ("traces", "127.0.0.1:4318"),
            ("traces", "http://"),
            ("traces", "http://h?key=x"),
        ] {
            let error = config(&[(name, value)]).unwrap_err().to_string();
            assert!(error.contains(name), "{error}");
            assert!(!error.contains('\n') && !error.contains("secret"), "{error}");
        }
    }

    #[test]
    fn a_worker_of_its_own_needs_what_others_reach() {
        let server = ("database", "postgres://a:secret@h/d");
        let shared = |given: &[(&str, &str)]| config(given).unwrap().places.check_shared();
        assert!(shared(&[]).unwrap_err().to_string().starts_with("database is not set"));
        assert!(shared(&[server]).unwrap_err().to_string().starts_with("blobs is not set"));
        assert!(shared(&[server, ("blobs", "s3://b")]).is_ok());
        assert!(!format!("{:?}", config(&[server]).unwrap()).contains("secret"));
        let collector = ("traces", "https://a:secret@collector:4318");
        assert!(!config(&[collector]).unwrap_err().to_string().contains("secret"));
    }

    #[test]
    fn a_lease_outlasts_two_heartbeats() {
        let error = config(&[("lease-s", "4"), ("heartbeat-s", "3")]).unwrap_err();
        assert!(matches!(error, ConfigError::Heartbeat { .. }));
    }

    #[test]
    fn a_key_is_never_printed() {
        let config = config(&[("api-key", "0123456789abcdef")]).unwrap();
        assert!(!format!("{config:?}").contains("0123456789abcdef"));
        let key = config.api_key.unwrap();
        assert!(key.matches("0123456789abcdef"));
        assert!(!key.matches("0123456789abcdeg"));
    }
}
