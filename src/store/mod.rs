//! Persistent store: rows in a database, bytes in blobs. Every query lives here, one file for each table; jobs have several: `accepted`,
//! `claims`, `leases`, `waiting`, `lost`, `queue`, `jobs` and `job_tags`, in the order of a job's life.
//!
//! A transaction locks rows in this order, those of one table in the order of their ids, so that of two one waits for the other and
//! not both: blobs, tenants, cases, plans, jobs, cohorts, meshes. Rows that belong to one of these, such as tags, are changed by who
//! has locked it. Several jobs of a case are locked by who has locked the case, in any order. A new row, which nobody else sees, may
//! come at any time; what it refers to is locked before (`referred`). Single statements of one row need no care.

mod accepted;
mod audit;
mod audit_intent;
mod audited_action;
mod audited_actions;
mod blob_folder;
mod blob_operations;
mod blobs;
mod cases;
mod claims;
mod cohorts;
mod database;
mod engines;
mod error;
mod events;
mod exported_rows;
mod exported_values;
mod files;
mod fsck;
mod handle;
mod health;
mod idempotency;
mod job_tags;
mod jobs;
mod keys;
mod leases;
mod lost;
mod made;
mod membership;
mod meshes;
mod note_rows;
mod notes;
mod open_actions;
mod owner;
mod plans;
mod queue;
mod references;
mod referred;
mod responses;
mod restored;
mod retention;
mod seen_clock;
mod spare;
mod sweep;
mod tenants;
mod tombstones;
mod transfer;
mod waiting;
mod wake;
pub use accepted::{Enqueued, NewJob};
pub use audit::{AuditRow, Chain};
pub use audit_intent::AuditIntent;
pub use audited_action::AuditedAction;
pub use cases::{AddedCase, CaseMeshing, CaseRow, Change, NewCase};
pub use claims::Claim;
pub use cohorts::{CohortModelRow, CohortRow, LeftRow, MemberRow, NewCohort, Outdated};
pub use database::Migrated;
pub use error::StoreError;
pub use events::EventRow;
pub use files::FoundBlob;
pub use fsck::{Dangling, Findings, Repaired, Unreached};
pub use handle::{DEFAULT_TENANT, Store, address_fault};
pub use health::StorageFault;
pub use idempotency::Reserved;
pub use jobs::{Dismissal, JobFilter, JobRow};
pub use keys::KeyRow;
pub use leases::{FileRow, Lease, LostJob, Point, Published, PublishedFile};
pub use lost::LostRow;
pub use made::MadeMesh;
pub use meshes::{MeshDeletion, MeshRow, MeshUsers, NewMesh};
pub use open_actions::OpenAction;
pub use plans::PlanRow;
pub use queue::QueueRow;
pub use responses::{CaseResponses, ResponseRow};
pub use seen_clock::ClockDoubt;
pub use sweep::Swept;
pub use tenants::TenantRow;
pub use transfer::TransferCounts;
pub use waiting::MeshedCase;
pub use wake::Changes;
