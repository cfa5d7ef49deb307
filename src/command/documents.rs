//! The case, the plan and the spec in one file, as the command line reads and writes them.

use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::failure::CommandError;
use super::files::{FileSource, relative};
use crate::jobs::PredictInput;
use crate::jobs::result::folder;
use crate::schema::wire::{canonical, strict};
use crate::schema::{
    CaseDocument, ErrorCode, Faults, Limits, PlanDocument, Pointer, PredictDocument,
};

/// The case, as commands write it into the folder of a result.
pub const CASE_FILE: &str = "case.json";

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

/// The documents that a command is about, and where they come from.
pub struct CaseDocuments {
    pub file: CaseFile,
    /// The case file, or the mesh.
    pub path: PathBuf,
    /// From which mesh paths lead.
    pub folder: PathBuf,
    pub sources: FileSource,
}

/// Reads a document strictly.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, CommandError> {
    let bytes = std::fs::read(path)
        .map_err(|source| CommandError::Read { path: path.to_owned(), source })?;
    strict::parse(&bytes, &Limits::default())
        .map_err(|problem| CommandError::Document { path: path.to_owned(), problem })
}

/// The document in a JSON value read from a file.
pub fn document<T: DeserializeOwned>(value: Value, path: &Path) -> Result<T, CommandError> {
    strict::from_value(value)
        .map_err(|problem| CommandError::Document { path: path.to_owned(), problem })
}

/// What the spec of a case file says of how tissue is computed, and every kind of job of one case may say.
const OF_TISSUE: [&str; 6] = ["method", "element", "materials", "membrane", "tolerance", "budget"];

/// What it says of the files of a prediction and of its estimates, and decides no number of another kind of job: told, and not used.
const OF_PREDICTION: [&str; 5] = ["estimate", "outputs", "range_mm", "keep", "tags"];

/// What a file has beside its spec.
const BESIDE_SPEC: [&str; 3] = ["case", "plan", "plan_id"];

/// The spec of another kind of job on a case file, as it is posted but for `case`: what it does not say of the tissue it has
/// from the spec of the case file, so that all commands compute the same tissue.
pub fn spec_beside<T: DeserializeOwned>(
    path: Option<&Path>,
    asked: &CaseDocuments,
) -> Result<T, CommandError> {
    let mut value = path.map_or_else(|| Ok(Value::Object(Map::new())), read::<Value>)?;
    let stated = asked.file.deciding(&asked.path)?;
    let (of_tissue, others): (Map<_, _>, Map<_, _>) =
        stated.into_iter().partition(|(name, _)| OF_TISSUE.contains(&name.as_str()));
    refuse(&others, ONLY_PREDICT, &asked.path)?;
    if let Some(members) = value.as_object_mut() {
        members.entry("case").or_insert_with(|| "".into());
        for (name, stated) in of_tissue {
            members.entry(name).or_insert(stated);
        }
    }
    document(value, path.unwrap_or(&asked.path))
}

/// Why a member that decides numbers of a prediction is refused by another kind of job of the same tissue.
const ONLY_PREDICT: &str = "only `predict` takes that, and without it this would be the answer of another model than that of the spec: \
                            give a case file without it";

/// Refuses members of the spec of a case file.
fn refuse(stated: &Map<String, Value>, why: &str, path: &Path) -> Result<(), CommandError> {
    let mut faults = Faults::default();
    for name in stated.keys() {
        let at = Pointer::root().key("spec").key(name);
        faults.add(&at, ErrorCode::UnknownField, format!("unknown field `{name}`: {why}"));
    }
    let refused = |problem| CommandError::Document { path: path.to_owned(), problem };
    faults.into_result().map_err(refused)
}

/// Whether two paths lead to one file, by links too.
pub fn is_same(one: &Path, other: &Path) -> bool {
    let file = |path: &Path| Some(path.metadata().ok()?).map(|found| (found.dev(), found.ino()));
    file(one).is_some_and(|one| file(other) == Some(one))
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
        let path = out.join(CASE_FILE);
        if read_from.is_some_and(|from| is_same(from, &path)) {
            return Ok(path);
        }
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
            compare_to
                .mesh_references_mut(&Pointer::root())
                .into_iter()
                .for_each(|(_, id)| lead(id));
        }
        folder::put(out, CASE_FILE, format!("{:#}\n", canonical::to_value(&self)).as_bytes())?;
        Ok(path)
    }

    /// What the spec says of numbers; what it says of files and estimates of a prediction is told as not used.
    fn deciding(&self, path: &Path) -> Result<Map<String, Value>, CommandError> {
        self.refuse_beside_spec(path)?;
        let (unused, deciding): (Map<_, _>, Map<_, _>) =
            self.stated().into_iter().partition(|(name, _)| OF_PREDICTION.contains(&name.as_str()));
        if !unused.is_empty() {
            let names: Vec<String> = unused.keys().map(|name| format!("`{name}`")).collect();
            eprintln!(
                "not used   {} of the spec of {}: only `predict` takes that",
                names.join(", "),
                path.display()
            );
        }
        Ok(deciding)
    }

    /// Refuses a case and a plan within a spec: a file has them beside it, and those within would be another case and another plan.
    pub fn refuse_beside_spec(&self, path: &Path) -> Result<(), CommandError> {
        let stated = self.stated().into_iter();
        let within: Map<_, _> =
            stated.filter(|(name, _)| BESIDE_SPEC.contains(&name.as_str())).collect();
        refuse(&within, "in a file `case` and `plan` stand beside `spec`: state them there", path)
    }

    /// What the spec says otherwise than one that says nothing.
    fn stated(&self) -> Map<String, Value> {
        let members = |spec: &PredictDocument| match canonical::to_value(spec) {
            Value::Object(members) => members,
            _ => Map::new(),
        };
        let usual = members(&PredictDocument::default());
        let stated = members(&self.spec).into_iter();
        stated.filter(|(name, value)| usual.get(name) != Some(value)).collect()
    }

    /// Refuses a spec that says how it is to be computed, where that is said by something else.
    pub fn refuse_spec(&self, why: &str, path: &Path) -> Result<(), CommandError> {
        refuse(&self.deciding(path)?, why, path)
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
