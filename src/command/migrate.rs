//! `facies migrate`: brings the schema of the database up to date.

use super::serve::ServeError;
use super::settings::Arguments;
use crate::config::Config;
use crate::store::Store;

/// Takes the steps that are missing and says which; done twice, it does nothing.
pub fn run(arguments: &Arguments) -> Result<(), ServeError> {
    let given = arguments.given()?;
    let config = Config::without_listener(|name| given.get(name))?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let migrated = runtime.block_on(Store::migrate(&config.places))?;
    if migrated.from == migrated.to {
        println!("the database is at schema step {}", migrated.to);
    } else {
        println!("brought the database from schema step {} to {}", migrated.from, migrated.to);
    }
    Ok(())
}
