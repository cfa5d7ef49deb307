//! `facies health`: whether a service on this machine is alive, for images that hold no other client.

use std::io::{Read, Write};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpStream};
use std::time::Duration;

use super::settings::Arguments;
use crate::config::{Config, ConfigError};

const PATIENCE: Duration = Duration::from_secs(2);

#[derive(Debug, thiserror::Error)]
pub enum HealthError {
    #[error(transparent)]
    Config(#[from] ConfigError),
    #[error("the service at {0} does not answer: {1}")]
    Silent(SocketAddr, std::io::Error),
    #[error("the service answers `{0}`")]
    Unwell(String),
}

impl HealthError {
    /// Whether another setting would help.
    pub fn is_setting(&self) -> bool {
        matches!(self, HealthError::Config(_))
    }
}

/// Asks for /healthz.
pub fn run(arguments: &Arguments) -> Result<(), HealthError> {
    let given = arguments.given()?;
    let address = Config::without_listener(|name| given.get(name))?.listen;
    let address = on_this_machine(address);
    let answer = ask(&address).map_err(|error| HealthError::Silent(address, error))?;
    let first = answer.lines().next().unwrap_or_default();
    match first.split(' ').nth(1) {
        Some("200") => Ok(()),
        _ => Err(HealthError::Unwell(first.to_owned())),
    }
}

/// At most the first 4096 bytes of the answer.
fn ask(address: &SocketAddr) -> std::io::Result<String> {
    let mut connection = TcpStream::connect_timeout(address, PATIENCE)?;
    connection.set_read_timeout(Some(PATIENCE))?;
    connection.set_write_timeout(Some(PATIENCE))?;
    connection
        .write_all(b"GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")?;
    let mut answer = String::new();
    connection.take(4096).read_to_string(&mut answer)?;
    Ok(answer)
}

fn on_this_machine(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => IpAddr::V4(Ipv4Addr::LOCALHOST),
        IpAddr::V6(ip) if ip.is_unspecified() => IpAddr::V6(Ipv6Addr::LOCALHOST),
        ip => ip,
    };
    SocketAddr::new(ip, address.port())
}
