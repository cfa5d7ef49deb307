//! A PostgreSQL that only reads for a while.

use facies::store::Store;

use crate::deployments::Deployment;
use crate::processes::until;
use crate::rows::mesh;
use crate::support::trials::trials;

trials! {
    on_shared {
        connections_of_a_time_without_writing_do_not_outlast_it
    }
}

/// More than there are connections.
const TIMES: usize = 12;

/// What new sessions of the database may do.
async fn by_default(on: &Deployment, setting: &str) {
    on.execute(&format!(
        "BEGIN READ WRITE; DO $$ BEGIN \
         EXECUTE format('ALTER DATABASE %I {setting}', current_database()); END $$; COMMIT"
    ))
    .await;
}

/// How many of several concurrent writes are refused.
async fn refused(store: &Store) -> usize {
    let new = || mesh("mesh", &uuid::Uuid::now_v7().to_string());
    let meshes: Vec<_> = std::iter::repeat_with(new).take(TIMES).collect();
    let added = futures::future::join_all(meshes.iter().map(|mesh| store.add_mesh(mesh))).await;
    added.iter().filter(|added| added.is_err()).count()
}

async fn connections_of_a_time_without_writing_do_not_outlast_it(on: Deployment) {
    let store = on.open().await;
    let kept = mesh("kept", "units=mm");
    assert!(store.add_mesh(&kept).await.unwrap());
    by_default(&on, "SET default_transaction_read_only = on").await;
    on.execute(
        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity \
         WHERE datname = current_database() AND pid <> pg_backend_pid()",
    )
    .await;
    until("every row is refused", async || (refused(&store).await == TIMES).then_some(())).await;
    assert!(store.ping().await.unwrap_err().is_unavailable());
    assert!(store.mesh(&kept.id).await.unwrap().is_some(), "what is stored is read");
    by_default(&on, "RESET default_transaction_read_only").await;
    // Its patience is far shorter than the life of a connection of the pool, ten minutes.
    until("rows are taken", async || (refused(&store).await == 0).then_some(())).await;
    store.ping().await.unwrap();
}
