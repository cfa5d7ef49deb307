//! HTTP server loop: stalled connections are closed. A client that sends no request, half of one or reads
//! nothing of its response costs a descriptor, and the memory of the response, for `patience` only.

use std::net::SocketAddr;
use std::pin::pin;
use std::time::Duration;

use super::pace::Paced;
use axum::Router;
use axum::body::Body;
use axum::extract::Request;
use axum::serve::Listener;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tower::{Service as _, ServiceExt as _};

/// Serves until `stop` is done, then finishes the requests received so far.
pub async fn serve(
    mut listener: TcpListener,
    router: Router,
    patience: Duration,
    stop: impl Future<Output = ()>,
) {
    let mut answers = router.into_make_service_with_connect_info::<SocketAddr>();
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(patience);
    let open = GracefulShutdown::new();
    let mut stop = pin!(stop);
    loop {
        let (stream, client) = tokio::select! {
            // Where the process has no descriptor left, it tries again every second.
            accepted = Listener::accept(&mut listener) => accepted,
            () = &mut stop => break,
        };
        prepare(&stream, patience);
        let stream = Paced::new(stream, patience);
        let Ok(answer) = answers.call(client).await;
        let answer = answer.map_request(|request: Request<_>| request.map(Body::new));
        let connection =
            http.serve_connection(TokioIo::new(stream), TowerToHyperService::new(answer));
        let connection = open.watch(connection);
        tokio::spawn(async move {
            if let Err(error) = connection.await {
                tracing::debug!(%error, "a connection broke off");
            }
        });
    }
    drop(listener);
    open.shutdown().await;
}

/// Bytes of a response that the system buffers for a client: few, so that its reading rate is seen soon.
#[cfg(target_os = "linux")]
const SENT_AHEAD: usize = 256 << 10;

/// The last piece of a response does not wait until the client has acknowledged the previous ones, and data that a client does
/// not read is not retransmitted for ever, on Linux only.
fn prepare(stream: &TcpStream, patience: Duration) {
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "TCP_NODELAY");
    }
    #[cfg(target_os = "linux")]
    {
        let milliseconds = u32::try_from(patience.as_millis()).unwrap_or(u32::MAX);
        if let Err(error) = rustix::net::sockopt::set_tcp_user_timeout(stream, milliseconds) {
            tracing::debug!(%error, "TCP_USER_TIMEOUT");
        }
        if let Err(error) = rustix::net::sockopt::set_socket_send_buffer_size(stream, SENT_AHEAD) {
            tracing::debug!(%error, "SO_SNDBUF");
        }
    }
}
