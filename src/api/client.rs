//! Identity of a client, for the limits on each client.

/// A client by the id of its key or by its address.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Client(String);

impl Client {
    pub fn named(name: &str) -> Client {
        Client(name.to_owned())
    }
}
