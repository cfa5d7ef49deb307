//! The steps of the schema: done or not done, and never guessed at.

use facies::store::{Migrated, Store, StoreError};

use crate::deployments::Deployment;
use crate::support::external::Missing;
use crate::support::trials::trials;

trials! {
    on_both {
        a_program_older_than_its_database_refuses_to_start
        a_step_that_breaks_off_leaves_the_step_before
    }
    on_shared {
        a_shared_database_is_migrated_beside_a_process_that_has_the_data_folder
        a_step_that_was_changed_after_it_was_taken_is_refused
    }
    alone {
        a_shared_database_older_than_the_program_is_brought_up_to_date_by_command_only
    }
}

async fn a_program_older_than_its_database_refuses_to_start(on: Deployment) {
    on.open().await.close().await;
    on.execute(
        "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time) \
         SELECT 9999, 'later', success, checksum, 1 FROM _sqlx_migrations WHERE version = 1",
    )
    .await;
    let error = Store::connect(&on.places).await.err().unwrap();
    let too_new = matches!(error, StoreError::SchemaTooNew { found: 9999, .. });
    assert!(too_new, "{error}");
}

async fn a_shared_database_is_migrated_beside_a_process_that_has_the_data_folder(on: Deployment) {
    let _serves = on.open().await;
    let Migrated { from, to } = Store::migrate(&on.places).await.unwrap();
    assert_eq!(from, to);
}

/// The third step makes `blobs` before `discarded_blobs`, which is in its way here.
async fn a_step_that_breaks_off_leaves_the_step_before(shared: Deployment) {
    let on = match shared.places.database {
        facies::config::DatabaseLocation::Embedded => shared,
        facies::config::DatabaseLocation::Server { .. } => Deployment::empty().await.unwrap(),
    };
    on.execute("CREATE TABLE discarded_blobs (in_the_way BIGINT)").await;
    let error = Store::migrate(&on.places).await.unwrap_err();
    assert!(matches!(error, StoreError::Database(_)), "{error}");
    // It would be refused if the broken step had left its first table.
    on.execute("CREATE TABLE blobs (in_the_way BIGINT)").await;
    on.execute("DROP TABLE blobs").await;
    on.execute("DROP TABLE discarded_blobs").await;
    let migrated = Store::migrate(&on.places).await.unwrap();
    assert_eq!(migrated.from, 2);
    on.open().await;
}

async fn a_shared_database_older_than_the_program_is_brought_up_to_date_by_command_only()
-> Result<(), Missing> {
    let on = Deployment::empty().await?;
    let error = Store::connect(&on.places).await.err().unwrap();
    assert!(matches!(error, StoreError::SchemaTooOld { found: 0, .. }), "{error}");
    assert!(error.to_string().contains("facies migrate"), "{error}");
    let Migrated { from, to } = Store::migrate(&on.places).await.unwrap();
    assert!(from == 0 && to > 0);
    assert_eq!(Store::migrate(&on.places).await.unwrap(), Migrated { from: to, to });
    on.open().await;
    Ok(())
}

async fn a_step_that_was_changed_after_it_was_taken_is_refused(on: Deployment) {
    on.execute("UPDATE _sqlx_migrations SET checksum = '' WHERE version = 1").await;
    let error = Store::connect(&on.places).await.err().unwrap();
    assert!(matches!(error, StoreError::Schema(_)), "{error}");
}
