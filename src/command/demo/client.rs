//! The demo's side of the API: one connection for each request, over hyper, which the server brings along.

use std::net::SocketAddr;

use axum::body::{Body, to_bytes};
use axum::http::{HeaderName, Request, StatusCode, header};
use bytes::Bytes;
use hyper_util::rt::TokioIo;
use serde_json::Value;
use tokio::net::TcpStream;

use crate::schema::wire::canonical::sha256_hex;

/// More than any file of the demo.
const LARGEST_ANSWER: usize = 512 << 20;

#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    #[error("{path}: {source}")]
    Connection { path: String, source: std::io::Error },
    #[error("{path}: {source}")]
    Http { path: String, source: hyper::Error },
    #[error("{path}: {detail}")]
    Answer { path: String, detail: String },
    #[error("{path} was answered with {status}: {detail}")]
    Refused { path: String, status: StatusCode, detail: String },
}

/// A server to talk to.
#[derive(Clone, Copy, Debug)]
pub struct Client {
    pub address: SocketAddr,
}

/// A part of a form: its name and its bytes, a document or a mesh.
pub struct Part {
    pub name: String,
    pub bytes: Vec<u8>,
}

impl Client {
    /// The bytes behind a path.
    pub async fn bytes(&self, path: &str) -> Result<Bytes, ClientError> {
        self.send("GET", path, &[], Body::empty()).await
    }

    /// The document behind a path.
    pub async fn get(&self, path: &str) -> Result<Value, ClientError> {
        document(path, &self.bytes(path).await?)
    }

    /// Posts a document.
    pub async fn post(&self, path: &str, body: &Value) -> Result<Value, ClientError> {
        let body = Body::from(body.to_string());
        let headers = [(header::CONTENT_TYPE, "application/json")];
        document(path, &self.send("POST", path, &headers, body).await?)
    }

    /// Posts a file.
    pub async fn upload(
        &self,
        path: &str,
        media_type: &str,
        bytes: Bytes,
    ) -> Result<Value, ClientError> {
        let headers = [(header::CONTENT_TYPE, media_type)];
        document(path, &self.send("POST", path, &headers, Body::from(bytes)).await?)
    }

    /// Posts a form of several parts (RFC 7578). What an earlier run made of the same parts is found again, unless it was
    /// erased since.
    pub async fn form(&self, path: &str, parts: &[Part]) -> Result<Value, ClientError> {
        let boundary = format!("facies-{}", uuid::Uuid::now_v7().simple());
        let body = Bytes::from(form_body(parts, &boundary));
        let media_type = format!("multipart/form-data; boundary={boundary}");
        let hashes: String = parts.iter().map(|part| sha256_hex(&part.bytes)).collect();
        let key = sha256_hex(hashes.as_bytes());
        let headers = [
            (header::CONTENT_TYPE, media_type.as_str()),
            (HeaderName::from_static("idempotency-key"), key.as_str()),
        ];
        let answer = match self.send("POST", path, &headers, body.clone().into()).await {
            Err(ClientError::Refused { status: StatusCode::GONE, .. }) => {
                self.send("POST", path, &headers[..1], body.into()).await
            }
            answer => answer,
        };
        document(path, &answer?)
    }

    async fn send(
        &self,
        method: &str,
        path: &str,
        headers: &[(HeaderName, &str)],
        body: Body,
    ) -> Result<Bytes, ClientError> {
        let stream = TcpStream::connect(self.address)
            .await
            .map_err(|source| ClientError::Connection { path: path.to_owned(), source })?;
        let failed = |source| ClientError::Http { path: path.to_owned(), source };
        let unreadable = |error: axum::Error| ClientError::Answer {
            path: path.into(),
            detail: error.to_string(),
        };
        let (mut sender, connection) =
            hyper::client::conn::http1::handshake(TokioIo::new(stream)).await.map_err(failed)?;
        // It ends with the answer; what goes wrong on it is told by the answer.
        tokio::spawn(connection);
        let mut request = Request::builder()
            .method(method)
            .uri(path)
            .header(header::HOST, self.address.to_string());
        for (name, value) in headers {
            request = request.header(name, *value);
        }
        let request = request.body(body).map_err(|error| ClientError::Answer {
            path: path.into(),
            detail: error.to_string(),
        })?;
        let response = sender.send_request(request).await.map_err(failed)?;
        let status = response.status();
        let body = to_bytes(Body::new(response.into_body()), LARGEST_ANSWER);
        let bytes = body.await.map_err(unreadable)?;
        if status.is_success() {
            return Ok(bytes);
        }
        Err(ClientError::Refused { path: path.to_owned(), status, detail: reason(&bytes) })
    }
}

/// What a problem document says, or the body as it is.
fn reason(bytes: &[u8]) -> String {
    let problem: Value = serde_json::from_slice(bytes).unwrap_or_default();
    let text = problem["errors"][0]["detail"].as_str().or(problem["detail"].as_str());
    text.map_or_else(|| String::from_utf8_lossy(bytes).into_owned(), str::to_owned)
}

fn document(path: &str, bytes: &[u8]) -> Result<Value, ClientError> {
    serde_json::from_slice(bytes)
        .map_err(|error| ClientError::Answer { path: path.to_owned(), detail: error.to_string() })
}

fn form_body(parts: &[Part], boundary: &str) -> Vec<u8> {
    let mut body = Vec::new();
    for Part { name, bytes } in parts {
        let head =
            format!("--{boundary}\r\nContent-Disposition: form-data; name=\"{name}\"\r\n\r\n");
        body.extend_from_slice(head.as_bytes());
        body.extend_from_slice(bytes);
        body.extend_from_slice(b"\r\n");
    }
    body.extend_from_slice(format!("--{boundary}--\r\n").as_bytes());
    body
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_form_is_written_as_rfc_7578_asks() {
        let parts = [("case", &b"{}"[..]), ("volume", b"\x00\r\n")]
            .map(|(name, bytes)| Part { name: name.into(), bytes: bytes.to_vec() });
        let expected = b"--b\r\nContent-Disposition: form-data; name=\"case\"\r\n\r\n{}\r\n\
            --b\r\nContent-Disposition: form-data; name=\"volume\"\r\n\r\n\x00\r\n\r\n--b--\r\n";
        assert_eq!(form_body(&parts, "b"), expected);
    }

    #[test]
    fn a_refusal_is_reported_by_its_first_reason() {
        let problem =
            br#"{"detail":"2 problems","errors":[{"detail":"nu is 0.7"},{"detail":"E"}]}"#;
        assert_eq!(reason(problem), "nu is 0.7");
        assert_eq!(reason(br#"{"detail":"gone"}"#), "gone");
        assert_eq!(reason(b"<html>"), "<html>");
    }
}
