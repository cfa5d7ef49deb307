//! Who asks: what bounds for each client are counted by.

use std::net::SocketAddr;

use axum::extract::ConnectInfo;
use axum::http::Extensions;

use super::Service;

/// A client: with a key the one who has it, without keys the address that a request comes from.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Client(String);

impl Client {
    pub fn named(name: &str) -> Client {
        Client(name.to_owned())
    }

    /// The client of a request whose key has been checked.
    pub fn of(service: &Service, extensions: &Extensions) -> Client {
        if service.config.api_key.is_some() {
            return Client::named("key");
        }
        let address = extensions.get::<ConnectInfo<SocketAddr>>();
        Client(address.map_or_else(String::new, |ConnectInfo(address)| address.ip().to_string()))
    }
}
