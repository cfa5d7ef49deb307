//! The order in which transactions lock rows: who waits for a row holds none that comes later, so that of two one waits for the
//! other and not both.

use facies::config::DatabaseLocation;
use facies::store::{
    AddedCase, Enqueued, Lease, MadeMesh, MemberRow, MeshedCase, NewCase, NewCohort, NewJob,
    NewMesh, Published, Store, StoreError,
};
use futures::future::BoxFuture;
use sqlx::{AssertSqlSafe, Connection, PgConnection};

use crate::deployments::Deployment;
use crate::rows::{LEASE, PAUSE, file, mesh, new_case, new_job};
use crate::store::made::made;
use crate::support::trials::trials;

trials! {
    on_shared {
        who_waits_for_a_row_holds_none_that_comes_later
    }
}

/// Tables with their keys, in the order in which rows are locked.
const ORDER: [(&str, &str); 6] = [
    ("blobs", "sha256"),
    ("cases", "id"),
    ("plans", "id"),
    ("jobs", "id"),
    ("cohorts", "id"),
    ("meshes", "id"),
];
/// Every change is undone at its end, so that the next one finds the same rows.
const UNDONE: &str = "CREATE FUNCTION undone() RETURNS trigger LANGUAGE plpgsql \
     AS $$ BEGIN RAISE EXCEPTION 'it is undone at its end'; END $$";

/// A change of rows, by its name.
type Operation = (&'static str, fn(&Store, &World) -> BoxFuture<'static, Result<(), StoreError>>);

/// Two of everything, which refer to each other against their order.
#[derive(Clone)]
struct World {
    cases: [NewCase; 2],
    plan: String,
    predictions: [String; 2],
    /// Of a study that was dismissed.
    dismissed: NewJob,
    cohort: String,
    members: Vec<MemberRow>,
    meshed: NewCase,
    /// Of its meshing, which runs.
    lease: Lease,
    /// The meshing of a case that was lost.
    lost: String,
    meshes: [NewMesh; 2],
    made: Vec<MadeMesh>,
}

fn ids(meshes: &[NewMesh; 2]) -> Vec<String> {
    meshes.iter().rev().map(|mesh| mesh.id.clone()).collect()
}

fn case_of(meshes: &[NewMesh; 2]) -> NewCase {
    NewCase { mesh_ids: ids(meshes), ..new_case() }
}

async fn accepted(store: &Store, job: &NewJob) -> String {
    assert_eq!(store.enqueue(job, 100).await.unwrap(), Enqueued::Accepted);
    job.id.clone()
}

async fn succeeded(store: &Store, job: &NewJob) -> String {
    accepted(store, job).await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert_eq!(lease.job, job.id);
    assert!(store.publish(&lease, crate::rows::result("{}", &[])).await.unwrap());
    job.id.clone()
}

/// A case whose meshing is accepted.
async fn meshed(store: &Store, meshes: &[NewMesh; 2]) -> NewCase {
    let case = case_of(meshes);
    let meshing = NewJob {
        kind: "mesh",
        case_id: Some(case.id.clone()),
        mesh_ids: ids(meshes),
        ..new_job("{}", &format!("meshing of {}", case.id))
    };
    let case = NewCase { meshing: Some(meshing), ..case };
    assert_eq!(store.add_case(&case, 100).await.unwrap(), AddedCase::Stored);
    case
}

fn waiting(case: &NewCase, hash: &str) -> NewJob {
    let meshing = case.meshing.as_ref().unwrap();
    NewJob {
        case_id: Some(case.id.clone()),
        waits_for: Some(meshing.id.clone()),
        mesh_ids: meshing.mesh_ids.clone(),
        ..new_job("{}", hash)
    }
}

async fn cohort_of(store: &Store, members: &[MemberRow]) -> String {
    let id = uuid::Uuid::now_v7().to_string();
    let (name, members) = ("all".into(), members.to_vec());
    let new = NewCohort { id: id.clone(), name, consent: None, members };
    assert!(store.add_cohort(&new).await.unwrap());
    id
}

async fn world(store: &Store) -> World {
    let meshes = ["one", "two"].map(|content| mesh(content, "units=mm"));
    for mesh in &meshes {
        assert!(store.add_mesh(mesh).await.unwrap());
    }
    let cases = [case_of(&meshes), case_of(&meshes)];
    let mut members = Vec::new();
    let mut predictions = [String::new(), String::new()];
    for (number, case) in cases.iter().enumerate() {
        assert_eq!(store.add_case(case, 100).await.unwrap(), AddedCase::Stored);
        let mut job = new_job("{}", "a prediction");
        (job.case_id, job.mesh_ids) = (Some(case.id.clone()), ids(&meshes));
        predictions[number] = succeeded(store, &job).await;
        members.insert(
            0,
            MemberRow {
                number: number as i64 + 1,
                case_id: case.id.clone(),
                job_id: job.id,
                mesh_id: meshes[number].id.clone(),
                document: "{}".into(),
            },
        );
    }
    let plan = uuid::Uuid::now_v7().to_string();
    assert!(store.add_plan(&cases[0].id, &plan, "{}").await.unwrap());
    let shared_cases = vec![cases[1].id.clone(), cases[0].id.clone()];
    let dismissed = NewJob { shared_cases, mesh_ids: ids(&meshes), ..new_job("{}", "a study") };
    accepted(store, &dismissed).await;
    store.dismiss(&dismissed.id).await.unwrap();
    cohort_of(store, &members).await;
    let cohort = cohort_of(store, &members).await;
    let lost = meshed(store, &meshes).await;
    accepted(store, &waiting(&lost, "waits for the lost one")).await;
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    assert!(store.lose(&lease, 1, PAUSE, r#"{"class":"infrastructure"}"#).await.unwrap());
    let meshed = meshed(store, &meshes).await;
    for hash in ["waits", "waits too"] {
        accepted(store, &waiting(&meshed, hash)).await;
    }
    let lease = store.claim(LEASE).await.unwrap().unwrap().lease;
    let known = store.mesh_by_content(&meshes[1].sha256, "units=mm").await.unwrap();
    let made = vec![MadeMesh { mesh: meshes[1].clone(), known }, made("three")];
    let lost = lost.meshing.unwrap().id;
    World {
        cases,
        plan,
        predictions,
        dismissed,
        cohort,
        members,
        meshed,
        lease,
        lost,
        meshes,
        made,
    }
}

macro_rules! operation {
    ($name:literal, |$store:ident, $world:ident| $work:expr) => {
        ($name, |store, world| {
            let ($store, $world) = (store.clone(), world.clone());
            Box::pin(async move { $work.await.map(drop) })
        })
    };
}

async fn publish(store: Store, world: World) -> Result<bool, StoreError> {
    let meshed = MeshedCase {
        document: "{}".into(),
        report: "{}".into(),
        mesh_ids: vec![world.made[1].mesh.id.clone(), world.meshes[0].id.clone()],
    };
    let (files, case) = ([file("a result")], Some(&meshed));
    let published = Published { result: "{}", files: &files, meshes: &world.made, case };
    store.publish(&world.lease, published).await
}

async fn add_meshed_case(store: Store, world: World) -> Result<AddedCase, StoreError> {
    let case = case_of(&[world.meshes[1].clone(), mesh("new", "")]);
    let mesh_ids = ids(&world.meshes);
    let meshing = Some(NewJob { mesh_ids, ..new_job("{}", "another") });
    let meshes = vec![NewMesh { id: case.mesh_ids[0].clone(), ..mesh("new", "") }];
    store.add_case(&NewCase { meshing, meshes, ..case }, 100).await
}

async fn learn(store: Store, world: World) -> Result<Enqueued, StoreError> {
    let learns_from = Some((world.cohort, 1));
    let id = uuid::Uuid::now_v7().to_string();
    let job = NewJob { id, learns_from, spec_hash: "a model".into(), ..world.dismissed };
    store.enqueue(&job, 100).await
}

async fn repeat(store: Store, world: World) -> Result<Enqueued, StoreError> {
    let job = NewJob { id: uuid::Uuid::now_v7().to_string(), ..world.dismissed };
    store.enqueue(&job, 100).await
}

async fn add_cohort(store: Store, world: World) -> Result<bool, StoreError> {
    let (id, members) = (uuid::Uuid::now_v7().to_string(), world.members);
    store.add_cohort(&NewCohort { id, name: "new".into(), consent: None, members }).await
}

const OPERATIONS: [Operation; 15] = [
    operation!("delete a case", |store, world| store.delete_case(&world.cases[0].id, None)),
    operation!("delete a meshed case", |store, world| store.delete_case(&world.meshed.id, None)),
    operation!("delete a plan", |store, world| {
        store.delete_plan((&world.cases[0].id, &world.plan), None)
    }),
    operation!("remove a prediction", |store, world| store.dismiss(&world.predictions[1])),
    operation!("remove a study", |store, world| store.dismiss(&world.dismissed.id)),
    operation!("dismiss a meshing", |store, world| store.dismiss(&world.lease.job)),
    operation!("delete a cohort", |store, world| store.delete_cohort(&world.cohort, 1)),
    operation!("learn from a cohort", |store, world| learn(store, world)),
    operation!("accept a study again", |store, world| repeat(store, world)),
    operation!("accept what waits", |store, world| {
        let job = waiting(&world.meshed, "waits longer");
        async move { store.enqueue(&job, 100).await }
    }),
    operation!("add a case", |store, world| add_meshed_case(store, world)),
    operation!("add a cohort", |store, world| add_cohort(store, world)),
    operation!("publish a meshing", |store, world| publish(store, world)),
    operation!("fail a meshing", |store, world| store.fail(&world.lease, "{}")),
    operation!("try a lost meshing again", |store, world| store.requeue(&world.lost)),
];

/// A connection beside those of the store.
struct Beside(PgConnection);

impl Beside {
    async fn of(on: &Deployment) -> Beside {
        let DatabaseLocation::Server { address, .. } = &on.places.database else {
            panic!("it is shared")
        };
        Beside(PgConnection::connect(address.reveal()).await.unwrap())
    }

    async fn execute(&mut self, sql: String) {
        sqlx::raw_sql(AssertSqlSafe(sql)).execute(&mut self.0).await.unwrap();
    }

    async fn texts(&mut self, sql: String) -> Vec<String> {
        sqlx::query_scalar(AssertSqlSafe(sql)).fetch_all(&mut self.0).await.unwrap()
    }

    async fn is_waited_for(&mut self) -> bool {
        let sql = "SELECT pid::text FROM pg_stat_activity \
             WHERE datname = current_database() AND wait_event_type = 'Lock'";
        !self.texts(sql.to_owned()).await.is_empty()
    }

    /// Waits for the ends of all transactions: a server tells of an error before it gives back what was held.
    async fn alone(&mut self) {
        let sql = "SELECT pid::text FROM pg_stat_activity WHERE datname = current_database() \
             AND backend_type = 'client backend' AND pid <> pg_backend_pid() AND xact_start IS NOT NULL";
        while !self.texts(sql.to_owned()).await.is_empty() {}
    }

    /// The rows of a table that somebody has locked.
    async fn held(&mut self, (table, key): (&str, &str)) -> Vec<String> {
        let all = format!("SELECT {key} FROM {table} ORDER BY {key}");
        let free = self.texts(format!("{all} FOR UPDATE SKIP LOCKED")).await;
        let mut held = self.texts(all).await;
        held.retain(|id| !free.contains(id));
        held
    }
}

/// Whether an operation waits for a row while that is locked; where it does, it must hold none that comes later.
async fn waits_in_order(
    on: &Deployment,
    store: &Store,
    world: &World,
    (name, operation): Operation,
    (place, row): (usize, &str),
) -> bool {
    let (mut other, mut beside) = (Beside::of(on).await, Beside::of(on).await);
    let (table, key) = ORDER[place];
    beside.alone().await;
    other.execute("BEGIN".to_owned()).await;
    other.execute(format!("SELECT 1 FROM {table} WHERE {key} = '{row}' FOR UPDATE")).await;
    let work = tokio::spawn(operation(store, world));
    let mut waits = false;
    while !waits && !work.is_finished() {
        waits = beside.is_waited_for().await;
    }
    if waits {
        let mut held = beside.held(ORDER[place]).await;
        held.retain(|id| id.as_str() > row);
        // Of the jobs of a case any may be the first for who holds the case.
        assert!(
            table == "jobs" || held.is_empty(),
            "{name} waits for one of {table} and holds {held:?}"
        );
        for later in &ORDER[place + 1..] {
            let held = beside.held(*later).await;
            assert!(held.is_empty(), "{name} waits for one of {table} and holds of {}", later.0);
        }
    }
    other.execute("ROLLBACK".to_owned()).await;
    let error = work.await.unwrap().unwrap_err().to_string();
    assert!(error.contains("it is undone at its end"), "{name}: {error}");
    waits
}

async fn who_waits_for_a_row_holds_none_that_comes_later(on: Deployment) {
    let store = on.open().await;
    let world = world(&store).await;
    let mut beside = Beside::of(&on).await;
    beside.execute(UNDONE.to_owned()).await;
    for (table, _) in &ORDER[1..] {
        beside
            .execute(format!(
                "CREATE CONSTRAINT TRIGGER undone AFTER INSERT OR UPDATE OR DELETE ON {table} \
                 DEFERRABLE INITIALLY DEFERRED FOR EACH ROW EXECUTE FUNCTION undone()"
            ))
            .await;
    }
    for operation in OPERATIONS {
        let mut waits = 0;
        for (place, (table, key)) in ORDER.iter().enumerate() {
            for row in beside.texts(format!("SELECT {key} FROM {table} ORDER BY {key}")).await {
                let at = (place, row.as_str());
                waits += usize::from(waits_in_order(&on, &store, &world, operation, at).await);
            }
        }
        assert!(waits > 0, "{} waits for nobody", operation.0);
    }
}
