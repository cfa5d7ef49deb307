//! The service on what is not part of the project: a PostgreSQL and a store of objects, other clocks and disks, real meshes.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on panics")]

mod api;
mod data;
mod faults;
mod store;
#[path = "../support/mod.rs"]
mod support;
mod worker;

use std::process::ExitCode;

use support::{
    collector, connections, deployments, helpers, invariants, partition, processes, rows, samples,
    sources, workers,
};

fn main() -> ExitCode {
    support::external::run([
        api::audit::trials(),
        api::downloads::trials(),
        api::erasures::trials(),
        data::ct::trials(),
        data::cuts::trials(),
        data::faces::trials(),
        faults::broken_disk::trials(),
        faults::slow_database::trials(),
        faults::small_disk::trials(),
        store::commits::trials(),
        store::erasure::trials(),
        store::locks::trials(),
        store::lost_jobs::trials(),
        store::made::trials(),
        store::meshings::trials(),
        store::pages::trials(),
        store::places::trials(),
        store::queue::trials(),
        store::races::trials(),
        store::read_only::trials(),
        store::remembered::trials(),
        store::schema_steps::trials(),
        store::storage::trials(),
        store::tags::trials(),
        store::tenants::trials(),
        store::turns::trials(),
        store::transfer::trials(),
        worker::clocks::trials(),
        worker::hosts::trials(),
        worker::traces::trials(),
    ])
}
