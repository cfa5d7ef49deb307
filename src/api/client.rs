//! Whom bounds for each client are counted for.

/// A client by the id of its key or by its address.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Client(String);

impl Client {
    pub fn named(name: &str) -> Client {
        Client(name.to_owned())
    }
}
