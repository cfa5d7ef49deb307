//! Connections that fail at their commit: the pool has others.

use facies::store::Store;

use crate::deployments::Deployment;
use crate::rows::mesh;
use crate::support::trials::trials;

trials! {
    on_shared {
        a_connection_that_failed_at_its_commit_is_in_nobodys_way
    }
}

/// More than there are connections.
const TIMES: usize = 12;

async fn refused(store: &Store) {
    for _ in 0..TIMES {
        store.add_mesh(&mesh("mesh", "units=mm")).await.unwrap_err();
    }
}

async fn a_connection_that_failed_at_its_commit_is_in_nobodys_way(on: Deployment) {
    let store = on.open().await;
    for fault in ["RAISE EXCEPTION 'refused'", "PERFORM pg_terminate_backend(pg_backend_pid())"] {
        on.execute(&format!(
            "CREATE FUNCTION breaks() RETURNS trigger LANGUAGE plpgsql AS \
             $$ BEGIN {fault}; RETURN NULL; END $$; \
             CREATE CONSTRAINT TRIGGER at_commit AFTER INSERT ON meshes DEFERRABLE INITIALLY DEFERRED \
             FOR EACH ROW EXECUTE FUNCTION breaks()"
        ))
        .await;
        refused(&store).await;
        on.execute("DROP TRIGGER at_commit ON meshes; DROP FUNCTION breaks()").await;
        for _ in 0..TIMES {
            let mesh = mesh("mesh", "units=mm");
            assert!(store.add_mesh(&mesh).await.unwrap(), "{fault}");
            store.delete_mesh(&mesh.id).await.unwrap();
        }
    }
}
