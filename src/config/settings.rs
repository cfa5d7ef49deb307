//! The settings with their defaults, units and ranges, as `--help` and `facies config` show them and
//! `docs/configuration.md` explains them.

use super::storage_locations;

/// One setting as it is documented: the flag is `--name`, the variable `FACIES_NAME`.
pub struct Setting {
    /// Lower case with dashes; names the unit.
    pub name: &'static str,
    /// As it would be written; empty where there is none.
    pub default: &'static str,
    /// What it does and its range.
    pub about: &'static str,
}

impl Setting {
    /// The environment variable.
    pub fn variable(&self) -> String {
        format!("FACIES_{}", self.name.replace('-', "_").to_uppercase())
    }

    /// A value as it may be shown.
    pub fn shown(&self, value: &str) -> String {
        match self.name {
            "api-key" | "admin-key" if !value.is_empty() => "…".to_owned(),
            "database" if !value.is_empty() => storage_locations::without_password(value),
            _ => value.to_owned(),
        }
    }
}

const fn setting(name: &'static str, default: &'static str, about: &'static str) -> Setting {
    Setting { name, default, about }
}

/// All settings of the service.
pub const SETTINGS: &[Setting] = &[
    setting(
        "bind",
        "127.0.0.1:8080",
        "address and port to listen on; port 0 takes a free one; any address but loopback needs an api-key or ask-for-keys",
    ),
    setting(
        "data",
        "facies-data",
        "folder of this process: temporary files and, unless they have another place, the database and the blobs",
    ),
    setting(
        "database",
        "",
        "`postgres://USER:PASSWORD@HOST/NAME`, which many processes share; without it SQLite in the data folder",
    ),
    setting(
        "database-connections",
        "10",
        "most connections of this process to PostgreSQL; its heartbeat has two more; 2 to 1000",
    ),
    setting(
        "blobs",
        "",
        "`s3://BUCKET/PREFIX`, with endpoint and credentials in the usual AWS_* variables, or a folder; without it a folder in the data folder",
    ),
    setting(
        "api-key",
        "",
        "a key that allows everything to the tenant `default`, sent as `Authorization: Bearer KEY`; 16 to 255 visible characters; with it every request needs a key but those to /healthz, /readyz, the page, the documentation and /clients",
    ),
    setting(
        "ask-for-keys",
        "false",
        "true: every request needs a key that was made by `facies admin key` or through the API, even without an api-key",
    ),
    setting(
        "admin-bind",
        "",
        "address and port of a listener of its own for those who run the service, which clients must not reach: metrics and administration; without it there is none",
    ),
    setting(
        "admin-key",
        "",
        "asked for by the admin listener for everything but /metrics, /healthz and /errors; 16 to 255 visible characters; without it administration is answered on loopback only",
    ),
    setting(
        "allowed-origins",
        "",
        "origins whose pages browsers let in, such as https://planning.example.org, with commas between them; without it none",
    ),
    setting(
        "allowed-hosts",
        "",
        "names, with commas between them and without ports, by which a service that asks for no key may be called, beside localhost and loopback addresses; without it none",
    ),
    setting(
        "clients-folder",
        "",
        "folder whose files are served at /clients to everybody: the packages that clients/build builds; without it there are none",
    ),
    setting(
        "requests-per-minute",
        "60000",
        "requests of one client in a minute, above which it gets 429 with Retry-After; 0 to 10000000, 0 for no limit",
    ),
    setting("event-streams", "8", "streams of events that one client may have open; 1 to 10000"),
    setting("keys", "100", "keys in force that a tenant may have; 1 to 100000"),
    setting("workers", "2", "jobs solved at the same time; 0 to 64, 0 leaves the jobs to others"),
    setting(
        "threads-per-job",
        "",
        "threads of one job; 1 to 64; without it the processors of the machine divided by workers; the results do not depend on it",
    ),
    setting(
        "slot-memory-mib",
        "",
        "memory in MiB that one job may take in its process; 64 to 4194304; without it three quarters of the machine's or the container's, divided by workers",
    ),
    setting(
        "lease-s",
        "15",
        "seconds without a sign of life after which a job is given to another worker; 0.5 to 3600",
    ),
    setting(
        "heartbeat-s",
        "5",
        "seconds between two signs of life of a running job; 0.1 to a half of lease-s",
    ),
    setting(
        "attempts",
        "3",
        "times a job may lose its worker or its storage before it fails; 1 to 10",
    ),
    setting(
        "grace-s",
        "10",
        "seconds that running jobs get to finish after SIGTERM before they are given back; 0 to 3600",
    ),
    setting("upload-mib", "256", "largest body of an upload in MiB; 1 to 4096"),
    setting(
        "bodies-mib",
        "4096",
        "bodies of all clients in MiB that may be under way at the same time, in files of the data folder; 1 to 1048576, and at least those of one client",
    ),
    setting(
        "client-bodies-mib",
        "1024",
        "bodies of one client in MiB that may be under way at the same time; 1 to 1048576, and at least upload-mib",
    ),
    setting(
        "waiting-requests",
        "256",
        "requests of one tenant that may wait for their turn at the parser, as many for the check of jobs, as many to list jobs, and as many to write; 1 to 100000",
    ),
    setting(
        "check-s",
        "30",
        "seconds that the check of a case or a job may take within its request, above which it gets 422; 1 to 3600",
    ),
    setting(
        "body-idle-s",
        "30",
        "seconds a client may stay silent in the middle of a request, between two, or take nothing of an answer, and in which it has to send or take 16 KiB a second; 0.1 to 600",
    ),
    setting("mesh-cache-mib", "1024", "memory for parsed meshes in MiB; 0 to 1048576"),
    setting("response-cache-mib", "256", "memory for plan responses in MiB; 0 to 1048576"),
    setting(
        "free-space-floor-mib",
        "256",
        "free disk space in MiB under which the service reports itself not ready; 0 to 1048576",
    ),
    setting("log-format", "json", "json or text"),
    setting(
        "log-level",
        "info",
        "off, error, warn, info, debug, trace, or levels by module such as info,facies=debug,sqlx=warn",
    ),
    setting(
        "traces",
        "",
        "address of an OpenTelemetry collector that takes OTLP over HTTP, such as http://127.0.0.1:4318; without it there are no traces",
    ),
];
