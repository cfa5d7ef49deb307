//! A way to PostgreSQL that can be cut or slow: whoever takes it then hears nothing, or late, and is not told so, as in a
//! partitioned or overloaded network.

use std::path::{Path, PathBuf};
use std::time::Duration;

use tempfile::TempDir;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{UnixListener, UnixStream};
use tokio::sync::watch;
use tokio::time::Instant;

const SOCKET: &str = ".s.PGSQL.5432";

/// How the way is.
#[derive(Clone, Copy)]
enum Condition {
    Open,
    /// Whatever is sent takes this long in each direction.
    Slow(Duration),
    Cut,
}

/// The way, until it is dropped.
pub struct Way {
    pub address: String,
    condition: watch::Sender<Condition>,
    _folder: TempDir,
}

impl Way {
    /// A way to the server at an address that names the folder of its socket.
    pub fn to(address: &str) -> Way {
        let (database, server) = address.split_once("?host=").unwrap();
        let folder = TempDir::new().unwrap();
        let listener = UnixListener::bind(folder.path().join(SOCKET)).unwrap();
        let condition = watch::Sender::new(Condition::Open);
        tokio::spawn(forward(listener, Path::new(server).join(SOCKET), condition.clone()));
        let address = format!("{database}?host={}", folder.path().display());
        Way { address, condition, _folder: folder }
    }

    pub fn cut(&self) {
        self.condition.send_replace(Condition::Cut);
    }

    pub fn slow_down(&self, by: Duration) {
        self.condition.send_replace(Condition::Slow(by));
    }

    pub fn mend(&self) {
        self.condition.send_replace(Condition::Open);
    }
}

async fn forward(listener: UnixListener, server: PathBuf, condition: watch::Sender<Condition>) {
    while let Ok((client, _)) = listener.accept().await {
        let Ok(server) = UnixStream::connect(&server).await else { continue };
        let (from_client, to_client) = client.into_split();
        let (from_server, to_server) = server.into_split();
        tokio::spawn(pass(from_client, to_server, condition.subscribe()));
        tokio::spawn(pass(from_server, to_client, condition.subscribe()));
    }
}

async fn pass(
    mut from: impl AsyncReadExt + Unpin,
    mut to: impl AsyncWriteExt + Unpin,
    mut condition: watch::Receiver<Condition>,
) {
    let mut bytes = vec![0; 1 << 16];
    loop {
        let count = from.read(&mut bytes).await.unwrap_or(0);
        if arrival(&mut condition).await.is_err() || count == 0 {
            return;
        }
        if to.write_all(&bytes[..count]).await.is_err() {
            return;
        }
    }
}

/// What comes while the way is cut arrives once it is mended.
async fn arrival(
    condition: &mut watch::Receiver<Condition>,
) -> Result<(), watch::error::RecvError> {
    let sent = Instant::now();
    loop {
        let now = *condition.borrow_and_update();
        match now {
            Condition::Open => return Ok(()),
            Condition::Cut => condition.changed().await?,
            Condition::Slow(by) => tokio::select! {
                () = tokio::time::sleep_until(sent + by) => return Ok(()),
                changed = condition.changed() => changed?,
            },
        }
    }
}
