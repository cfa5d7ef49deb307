//! HTTP server loop: connections are closed when they stall. A client that sends no request, half of one or takes
//! nothing of its answer costs a descriptor, and the memory of the answer, for `patience` only.

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

/// Answers until `stop` is done, and then what has been asked by then.
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

/// Bytes of an answer that the system keeps for a client: few, so that what a client takes shows soon.
#[cfg(target_os = "linux")]
const SENT_AHEAD: usize = 256 << 10;

/// The last piece of an answer is not held back until the client has confirmed the ones before it, and what a client does
/// not take is not offered for ever. Elsewhere than on Linux it is.
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
