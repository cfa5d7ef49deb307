//! The two ways to keep rows and bytes: SQLite with a folder, and a real PostgreSQL with a real S3-compatible
//! store. Both servers are started once for all tests and end with the process.

use std::io::{BufRead, BufReader};
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;

use facies::config::{BlobLocation, DatabaseLocation, Secret, StorageLocations};
use facies::store::Store;
use hyper_util::rt::{TokioExecutor, TokioIo};
use s3s::auth::SimpleAuth;
use s3s::service::S3ServiceBuilder;
use sqlx::{AssertSqlSafe, Connection, PgConnection, SqliteConnection};
use tempfile::TempDir;
use tokio::net::TcpListener;
use tokio::sync::Mutex;

use crate::support::external::{Missing, REQUIRE_SERVERS};

const BUCKET: &str = "faces";
const KEY: &str = "test-key";
const SECRET: &str = "test-secret";

/// A private PostgreSQL in a folder of its own. It ends when its keeper's standard input does.
pub struct Cluster {
    folder: PathBuf,
    binaries: PathBuf,
    keeper: Child,
}

/// PostgreSQL refuses to run as root. The order of texts is that of a language, as on most installations.
const KEEPER: &str = r#"
trap '' INT TERM HUP
mkdir pg
if [ "$(id -u)" = 0 ]; then chmod 711 .; chown nobody pg; as='runuser -u nobody --'; fi
init="$as $1/initdb -D pg --no-sync -A trust -U postgres -E UTF8"
{
  $init --locale-provider=icu --icu-locale=en-US || { rm -rf pg/*; $init; }
  $as "$1/pg_ctl" -D pg -w -l pg/log -o "$2" start
} >&2 && echo ready
cat >/dev/null
$as "$1/pg_ctl" -D pg -m immediate stop >&2
cd /
rm -rf "$3"
"#;

impl Cluster {
    pub fn start() -> Result<Cluster, Missing> {
        let binaries = binaries().ok_or_else(no_postgresql)?;
        let folder = TempDir::new().unwrap().keep();
        let socket = folder.join("pg");
        let options = format!("-c listen_addresses= -k {} -c fsync=off -N 300", socket.display());
        let log = std::fs::File::create(folder.join("keeper.log")).unwrap();
        let mut keeper = Command::new("sh")
            .args(["-c", KEEPER, "keeper"])
            .args([binaries.as_os_str(), options.as_ref(), folder.as_os_str()])
            .current_dir(&folder)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(log)
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(keeper.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let log = || std::fs::read_to_string(folder.join("keeper.log")).unwrap();
        assert_eq!(line, "ready\n", "{}", log());
        Ok(Cluster { folder, binaries, keeper })
    }

    pub fn address(&self, database: &str) -> String {
        format!("postgres://postgres@localhost/{database}?host={}/pg", self.folder.display())
    }

    /// `stop -m immediate` is a crash, `stop -m fast` the way of an administrator.
    pub fn control(&self, arguments: &[&str]) {
        let mut command = Command::new("env");
        if std::fs::metadata("/proc/self").unwrap().uid() == 0 {
            command = Command::new("runuser");
            command.args(["-u", "nobody", "--"]);
        }
        let options =
            format!("-c listen_addresses= -k {}/pg -c fsync=off -N 300", self.folder.display());
        let data = self.folder.join("pg");
        command.arg(self.binaries.join("pg_ctl")).arg("-D").arg(&data).arg("-w");
        command.arg("-l").arg(data.join("log")).args(["-o", &options]).args(arguments);
        let output = command.current_dir("/").stdin(Stdio::null()).output().unwrap();
        assert!(output.status.success(), "{output:?}");
    }

    /// An empty database.
    pub async fn database(&self) -> String {
        // Two at once would both copy the same template, which PostgreSQL refuses.
        static ONE_AT_A_TIME: Mutex<()> = Mutex::const_new(());
        let _alone = ONE_AT_A_TIME.lock().await;
        let name = format!("facies_{}", uuid::Uuid::now_v7().simple());
        execute_on(&self.address("postgres"), &format!("CREATE DATABASE {name}")).await;
        self.address(&name)
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        drop(self.keeper.stdin.take());
        let _ = self.keeper.wait();
    }
}

fn binaries() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let debian = std::fs::read_dir("/usr/lib/postgresql").into_iter().flatten().flatten();
    let debian = debian.map(|version| version.path().join("bin"));
    let mut folders = debian.chain(std::env::split_paths(&path));
    folders.find(|folder| folder.join("initdb").exists() && folder.join("pg_ctl").exists())
}

fn no_postgresql() -> Missing {
    let why = "there is no initdb of PostgreSQL here".to_owned();
    Missing { why, required_by: Some(REQUIRE_SERVERS) }
}

/// The one for all tests.
fn cluster() -> Result<&'static Cluster, Missing> {
    static CLUSTER: OnceLock<Option<Cluster>> = OnceLock::new();
    CLUSTER.get_or_init(|| Cluster::start().ok()).as_ref().ok_or_else(no_postgresql)
}

async fn execute_on(address: &str, sql: &str) {
    let mut connection = PgConnection::connect(address).await.unwrap();
    sqlx::raw_sql(AssertSqlSafe(sql)).execute(&mut connection).await.unwrap();
    connection.close().await.unwrap();
}

/// The S3-compatible store of all tests, on a thread of its own: its settings by their variables.
fn object_store() -> &'static [(String, String)] {
    static SETTINGS: OnceLock<Vec<(String, String)>> = OnceLock::new();
    SETTINGS.get_or_init(|| {
        let root = objects_root();
        // What an earlier run left.
        let _ = std::fs::remove_dir_all(&root);
        std::fs::create_dir_all(root.join(BUCKET)).unwrap();
        let (told, address) = std::sync::mpsc::channel();
        std::thread::spawn(move || {
            let runtime = tokio::runtime::Runtime::new().unwrap();
            runtime.block_on(serve_objects(&root, told));
        });
        let endpoint = format!("http://{}", address.recv().unwrap());
        let settings = [
            ("AWS_ENDPOINT_URL", endpoint.as_str()),
            ("AWS_REGION", "us-east-1"),
            ("AWS_ACCESS_KEY_ID", KEY),
            ("AWS_SECRET_ACCESS_KEY", SECRET),
            ("AWS_ALLOW_HTTP", "true"),
        ];
        settings.iter().map(|(name, value)| ((*name).into(), (*value).into())).collect()
    })
}

fn objects_root() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("objects")
}

async fn serve_objects(root: &Path, told: std::sync::mpsc::Sender<std::net::SocketAddr>) {
    let mut builder = S3ServiceBuilder::new(s3s_fs::FileSystem::new(root).unwrap());
    builder.set_auth(SimpleAuth::from_single(KEY, SECRET));
    let service = builder.build();
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    told.send(listener.local_addr().unwrap()).unwrap();
    let http = hyper_util::server::conn::auto::Builder::new(TokioExecutor::new());
    loop {
        let (stream, _) = listener.accept().await.unwrap();
        let connection = http.serve_connection(TokioIo::new(stream), service.clone());
        tokio::spawn(connection.into_owned());
    }
}

/// Rows and bytes of one test.
pub struct Deployment {
    folder: TempDir,
    pub places: StorageLocations,
}

impl Deployment {
    pub async fn embedded() -> Deployment {
        let folder = TempDir::new().unwrap();
        Deployment { places: StorageLocations::in_folder(&folder.path().join("data")), folder }
    }

    /// PostgreSQL and S3, with the tables made.
    pub async fn shared() -> Result<Deployment, Missing> {
        let deployment = Deployment::empty().await?;
        Store::migrate(&deployment.places).await.unwrap();
        Ok(deployment)
    }

    /// The same without tables.
    pub async fn empty() -> Result<Deployment, Missing> {
        Ok(Deployment::on(&cluster()?.database().await))
    }

    /// A database by its address, and a place of its own for bytes.
    pub fn on(address: &str) -> Deployment {
        let folder = TempDir::new().unwrap();
        let secret = |(name, value): &(String, String)| (name.clone(), Secret::new(value.clone()));
        let places = StorageLocations {
            data: folder.path().join("data"),
            database: DatabaseLocation::Server {
                address: Secret::new(address.to_owned()),
                connections: 8,
            },
            blobs: BlobLocation::Bucket {
                bucket: BUCKET.into(),
                prefix: uuid::Uuid::now_v7().to_string(),
                settings: object_store().iter().map(secret).collect(),
            },
        };
        Deployment { folder, places }
    }

    pub async fn open(&self) -> Store {
        Store::connect(&self.places).await.unwrap()
    }

    /// The store as another process sees it: one on another host, where hosts share one.
    pub async fn again(&self, store: &Store) -> Store {
        match self.places.database {
            DatabaseLocation::Embedded => store.again().await.unwrap(),
            DatabaseLocation::Server { .. } => {
                let data = self.folder.path().join(uuid::Uuid::now_v7().to_string());
                Store::connect(&StorageLocations { data, ..self.places.clone() }).await.unwrap()
            }
        }
    }

    /// What an administrator does behind the service's back.
    pub async fn execute(&self, sql: &str) {
        match &self.places.database {
            DatabaseLocation::Server { address, .. } => execute_on(address.reveal(), sql).await,
            DatabaseLocation::Embedded => {
                std::fs::create_dir_all(&self.places.data).unwrap();
                let options = sqlx::sqlite::SqliteConnectOptions::new()
                    .filename(self.places.data.join("facies.db"))
                    .create_if_missing(true);
                let mut connection = SqliteConnection::connect_with(&options).await.unwrap();
                sqlx::raw_sql(AssertSqlSafe(sql)).execute(&mut connection).await.unwrap();
                connection.close().await.unwrap();
            }
        }
    }

    /// The first column of a query, as texts.
    pub async fn texts(&self, sql: &'static str) -> Vec<String> {
        match &self.places.database {
            DatabaseLocation::Server { address, .. } => {
                let mut connection = PgConnection::connect(address.reveal()).await.unwrap();
                sqlx::query_scalar(sql).fetch_all(&mut connection).await.unwrap()
            }
            DatabaseLocation::Embedded => {
                let file = self.places.data.join("facies.db");
                let options = sqlx::sqlite::SqliteConnectOptions::new().filename(file);
                let mut connection = SqliteConnection::connect_with(&options).await.unwrap();
                sqlx::query_scalar(sql).fetch_all(&mut connection).await.unwrap()
            }
        }
    }

    /// The files in which the bytes lie, without the mark of their owner.
    pub fn objects(&self) -> Vec<PathBuf> {
        let root = match &self.places.blobs {
            BlobLocation::Bucket { prefix, .. } => objects_root().join(BUCKET).join(prefix),
            _ => self.places.data.join("blobs"),
        };
        let mut found = Vec::new();
        let mut folders = vec![root];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).into_iter().flatten() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else if !path.ends_with("facies-owner") {
                    found.push(path);
                }
            }
        }
        found
    }

    /// A folder for what a test writes.
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Flags and variables that bring a process to these places, with a data folder of its own.
    pub fn bring(&self, command: &mut Command) {
        let data = self.folder.path().join(uuid::Uuid::now_v7().to_string());
        command.arg("--data").arg(data);
        if let DatabaseLocation::Server { address, .. } = &self.places.database {
            command.args(["--database", address.reveal()]);
        }
        if let BlobLocation::Bucket { bucket, prefix, settings } = &self.places.blobs {
            command.args(["--blobs", &format!("s3://{bucket}/{prefix}")]);
            command.envs(settings.iter().map(|(name, value)| (name, value.reveal())));
        }
    }
}
