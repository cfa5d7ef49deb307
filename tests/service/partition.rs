//! A way to PostgreSQL that can be cut: whoever takes it then hears nothing and is not told so, as in a partitioned
//! network.

use std::path::{Path, PathBuf};

use tempfile::TempDir;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{UnixListener, UnixStream};
use tokio::sync::watch;

const SOCKET: &str = ".s.PGSQL.5432";

/// The way, until it is dropped.
pub struct Way {
    pub address: String,
    is_cut: watch::Sender<bool>,
    _folder: TempDir,
}

impl Way {
    /// A way to the server at an address that names the folder of its socket.
    pub fn to(address: &str) -> Way {
        let (database, server) = address.split_once("?host=").unwrap();
        let folder = TempDir::new().unwrap();
        let listener = UnixListener::bind(folder.path().join(SOCKET)).unwrap();
        let is_cut = watch::Sender::new(false);
        tokio::spawn(forward(listener, Path::new(server).join(SOCKET), is_cut.clone()));
        let address = format!("{database}?host={}", folder.path().display());
        Way { address, is_cut, _folder: folder }
    }

    pub fn cut(&self) {
        self.is_cut.send_replace(true);
    }

    pub fn mend(&self) {
        self.is_cut.send_replace(false);
    }
}

async fn forward(listener: UnixListener, server: PathBuf, is_cut: watch::Sender<bool>) {
    while let Ok((client, _)) = listener.accept().await {
        let Ok(server) = UnixStream::connect(&server).await else { continue };
        let (from_client, to_client) = client.into_split();
        let (from_server, to_server) = server.into_split();
        tokio::spawn(pass(from_client, to_server, is_cut.subscribe()));
        tokio::spawn(pass(from_server, to_client, is_cut.subscribe()));
    }
}

/// What comes while the way is cut arrives once it is mended.
async fn pass(
    mut from: impl AsyncReadExt + Unpin,
    mut to: impl AsyncWriteExt + Unpin,
    mut is_cut: watch::Receiver<bool>,
) {
    let mut bytes = vec![0; 1 << 16];
    loop {
        let count = from.read(&mut bytes).await.unwrap_or(0);
        if is_cut.wait_for(|is_cut| !is_cut).await.is_err() || count == 0 {
            return;
        }
        if to.write_all(&bytes[..count]).await.is_err() {
            return;
        }
    }
}
