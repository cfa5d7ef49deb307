//! The case, the plan and the spec in one file, as the command line reads and writes them.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::failure::CommandError;
use super::files::relative;
use crate::jobs::PredictInput;
use crate::schema::wire::{canonical, strict};
use crate::schema::{CaseDocument, Limits, PlanDocument, PredictDocument};

/// `case.json`: mesh ids are paths relative to the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseFile {
    pub case: CaseDocument,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<PlanDocument>,
    #[serde(default)]
    pub spec: PredictDocument,
}

/// Reads a document strictly.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, CommandError> {
    let bytes = std::fs::read(path)
        .map_err(|source| CommandError::Read { path: path.to_owned(), source })?;
    strict::parse(&bytes, &Limits::default())
        .map_err(|problem| CommandError::Document { path: path.to_owned(), problem })
}

/// A spec of a job whose case stands beside it: as it is posted, and `case` may be left out.
pub fn read_spec<T: DeserializeOwned>(path: &Path) -> Result<T, CommandError> {
    let mut value: Value = read(path)?;
    if let Some(members) = value.as_object_mut() {
        members.entry("case").or_insert_with(|| "".into());
    }
    strict::from_value(value)
        .map_err(|problem| CommandError::Document { path: path.to_owned(), problem })
}

/// Writes a file, and the folder it is in.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<(), CommandError> {
    let failed = |source| CommandError::Write { path: path.to_owned(), source };
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    std::fs::write(path, content).map_err(failed)
}

impl CaseFile {
    /// The same documents with mesh paths that lead from `out` to what they led to from `folder`,
    /// as `case.json` in `out`. The file they were read from is left alone.
    pub fn write_beside(
        mut self,
        folder: &Path,
        out: &Path,
        read_from: Option<&Path>,
    ) -> Result<PathBuf, CommandError> {
        let path = out.join("case.json");
        let is_source = |from: &Path| {
            let whole = (from.canonicalize().ok(), path.canonicalize().ok());
            whole.0.is_some() && whole.0 == whole.1
        };
        if read_from.is_some_and(is_source) {
            return Ok(path);
        }
        std::fs::create_dir_all(out)
            .map_err(|source| CommandError::Write { path: out.to_owned(), source })?;
        let bones: Vec<String> = self.case.bones.iter().map(|bone| bone.name.clone()).collect();
        let lead = |id: &mut String| {
            *id = relative(&folder.join(&*id), out).to_string_lossy().into_owned();
        };
        for (_, id) in self.case.mesh_references_mut() {
            lead(id);
        }
        for (_, id) in self.plan.iter_mut().flat_map(|plan| plan.surface_references_mut()) {
            if !bones.contains(id) {
                lead(id);
            }
        }
        if let Some(compare_to) = &mut self.spec.compare_to {
            lead(&mut compare_to.actual.mesh);
        }
        write(&path, format!("{:#}\n", canonical::to_value(&self)))?;
        Ok(path)
    }

    /// The job that these documents ask for; without a plan nothing moves.
    pub fn to_input(&self) -> PredictInput {
        PredictInput {
            job: None,
            queue_s: None,
            case: self.case.clone(),
            plan: self.plan.clone().unwrap_or_default(),
            spec: self.spec.clone(),
        }
    }
}
