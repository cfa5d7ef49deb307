//! One attempt at a job of the service: its document, the meshes of its worker, the numerics.

use std::path::Path;

use serde_json::{Value, json};

use super::protocol::{Assignment, Effort, MadeFile, MeshFile, Outcome, Products};
use crate::jobs::{JobContext, JobError, JobInput, JobOutput, MadeMesh, MeshSource, work};
use crate::library::upload::upload_made;
use crate::schema::ErrorCode;
use crate::schema::Limits;
use crate::schema::job::ErrorClass;
use mechanics::progress::Progress;

/// Does the work of an assignment. Files are in its folder afterwards.
pub fn attempt(
    assignment: &Assignment,
    sources: &dyn MeshSource,
    limits: &Limits,
    progress: &dyn Progress,
) -> Outcome {
    let input = match read_input(assignment) {
        Ok(input) => input,
        Err(reason) => return broken(&format!("the document of the job: {reason}")),
    };
    let place = JobContext { sources, limits, out: &assignment.folder };
    let done = work(&input, &place, progress).and_then(|output| {
        let meshes = write_meshes(&output.meshes, &assignment.folder)?;
        Ok((output, meshes))
    });
    match done {
        Ok((output, meshes)) => made(output, meshes),
        Err(error) => failed(&input.as_posted(error)),
    }
}

/// Writes meshes in the form in which they are stored, each with its row as for an upload.
fn write_meshes(meshes: &[MadeMesh], folder: &Path) -> Result<Vec<MeshFile>, JobError> {
    let mut written = Vec::with_capacity(meshes.len());
    for (number, mesh) in meshes.iter().enumerate() {
        let row = upload_made(mesh)?.row;
        let file = format!("kept-{number}");
        std::fs::write(folder.join(&file), &row.bytes)
            .map_err(|source| JobError::Write { file: file.clone(), source })?;
        written.push(MeshFile {
            what: mesh.what,
            name: mesh.name.clone(),
            file,
            id: row.id,
            sha256: row.sha256,
            options: row.options,
            report: row.report,
        });
    }
    Ok(written)
}

/// The document of a job, which now knows its job and how long it waited.
fn read_input(assignment: &Assignment) -> Result<JobInput, serde_json::Error> {
    let input: JobInput = serde_json::from_str(&assignment.document)?;
    Ok(input.of_job(&assignment.job, assignment.queue_s))
}

fn made(output: JobOutput, meshes: Vec<MeshFile>) -> Outcome {
    let result = match serde_json::to_string(&output.result) {
        Ok(result) => result,
        Err(error) => return broken(&format!("the manifest: {error}")),
    };
    let provenance = output.result.provenance;
    let solver = provenance.solver.as_ref();
    let files = output.files.into_iter();
    Outcome::Done(Products {
        result,
        files: files
            .map(|file| MadeFile { name: file.name, media_type: file.media_type })
            .collect(),
        meshes,
        effort: Effort {
            unknowns: solver.map_or(0, |solver| solver.unknowns),
            iterations: solver.map_or(0, |solver| solver.iterations),
            method: provenance.method,
        },
    })
}

fn broken(reason: &str) -> Outcome {
    tracing::error!(%reason, "a job could not be worked on");
    Outcome::Failed(broke_off(ErrorClass::Infrastructure))
}

/// The error of a job that met a bug; what it was stands in the log only.
pub(in crate::worker) fn broke_off(class: ErrorClass) -> Value {
    let detail = "the work broke off; the log has the details under the job's id";
    json!({"type": ErrorCode::Internal, "class": class, "detail": detail})
}

fn failed(error: &JobError) -> Outcome {
    match error.class() {
        ErrorClass::Cancelled => Outcome::Cancelled,
        ErrorClass::Infrastructure => {
            Outcome::Storage { error: json!(error.to_document()), reason: error.to_string() }
        }
        ErrorClass::Numerical | ErrorClass::Input | ErrorClass::Budget => {
            Outcome::Failed(json!(error.to_document()))
        }
    }
}
