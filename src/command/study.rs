//! `facies study`: comparison of methods, time and error of each.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;

use super::claim::Claim;
use super::documents::{CaseFile, is_same, read};
use super::failure::CommandError;
use super::files::{FileSource, ScaleArguments};
use super::screen::{print_files, print_warnings, run_with_progress};
use super::stability;
use super::stability_random;
use super::study_screen::print_report;
use super::sweep::{self, Sweep};
use crate::jobs::study::ALL_METHODS;
use crate::jobs::study::files::REPORT_JSON;
use crate::jobs::{JobContext, JobInput, StudyInput};
use crate::schema::study::document::{
    CaseReference, PlanReference, SceneReference, StudyKind, ThresholdsDocument,
};
use crate::schema::study::expected::truth_costs;
use crate::schema::study::report::{OutcomeName, ReportDocument};
use crate::schema::{CaseDocument, Limits, MaterialDocument, StudyDocument};
use mechanics::progress::StopQuery;
use mechanics::study::methods;

/// The scenes and levels of a study that names none.
const USUAL_SCENES: [&str; 5] = ["sphere", "slab", "slab_far", "half_head", "half_head_far"];
const USUAL_LEVELS: [u32; 2] = [0, 1];
/// Of the small one: the movement and the tissue of the slab, docs/verification.md#v29.
const SMALL_SCENE: &str = "slab";
const SMALL_PLAN: &str = "patch 4,0,8 mm";
const SMALL_TISSUE: (f64, f64) = (15.0, 0.46);

/// What a case file says for `predict` is said by a study for all of its cases.
const OWN_WAYS: &str = "a study states itself how cases are computed: say so in an entry of `methods` or in `materials` of a \
                        document for --spec, or by --method";

/// Groups of the arguments in the help.
const WHAT: &str = "What is solved";
const RULES: &str = "What makes its outcome good or bad";

#[derive(Debug, Args)]
pub struct Arguments {
    /// The slab with one plan and one tissue and every method: a minute at most
    #[arg(long, help_heading = WHAT, conflicts_with_all = ["scene", "case", "spec"])]
    small: bool,
    /// A scene that the program makes itself: sphere, slab, slab_hex, half_head, or with large movements slab_far, half_head_far;
    /// may be given several times
    #[arg(long, help_heading = WHAT, value_name = "NAME")]
    scene: Vec<String>,
    /// A file with a case and a plan, as for `predict`; may be given several times
    #[arg(long, help_heading = WHAT, value_name = "FILE")]
    case: Vec<PathBuf>,
    /// The cases of --case are one face on meshes of different cell sizes, under this name: how the skin converges over them
    #[arg(long, help_heading = WHAT, value_name = "NAME", requires = "case")]
    series: Option<String>,
    /// A method by its name; may be given several times; default: all
    #[arg(long, help_heading = WHAT, value_name = "NAME")]
    method: Vec<String>,
    /// How often every edge is halved; may be given several times; default: 0 and 1
    #[arg(long, help_heading = WHAT, value_name = "N")]
    level: Vec<u32>,
    /// Every combination of values of material constants: [REGION.]young_modulus_kpa=V,V, [REGION.]poisson_ratio=V,V or
    /// [REGION.]volume_change=V,V, without a region of all tissue; may be given several times
    #[arg(long, help_heading = WHAT, value_name = "CONSTANT=V,V", value_parser = sweep::sweep)]
    sweep: Vec<Sweep>,
    /// Solves of each row, whose median time is reported
    #[arg(long, help_heading = WHAT, value_name = "N")]
    repeats: Option<u32>,
    /// Instead of a study: map where each method fails, what it does as movements, materials and meshes become
    /// impossible
    #[arg(long, help_heading = WHAT, conflicts_with_all = [
        "small", "scene", "case", "series", "method", "level", "sweep", "repeats", "spec", "baseline", "threshold_p95_mm",
    ])]
    stability: bool,
    /// With --stability: end so many random small scenes instead, each by a method and a law of its own, and count how
    #[arg(long, help_heading = WHAT, value_name = "N", requires = "stability")]
    random: Option<u64>,
    /// With --random: the seed; the same one makes the same scenes
    #[arg(long, help_heading = WHAT, value_name = "S", requires = "random", default_value_t = 1)]
    seed: u64,
    /// A study document; the other arguments override it. Its cases are files as those of --case
    #[arg(long, help_heading = WHAT, value_name = "FILE")]
    spec: Option<PathBuf>,
    /// The folder for the report
    #[arg(long, visible_alias = "output", value_name = "FOLDER", help_heading = "Result")]
    out: PathBuf,
    /// The report.json of an earlier study: rows that are worse than there end the program with 1
    #[arg(long, help_heading = RULES, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// A folder in which rows are stored by their content: another threshold or baseline solves nothing again
    #[arg(long, help_heading = "Result", value_name = "FOLDER", conflicts_with = "stability")]
    keep: Option<PathBuf>,
    /// Rows with a larger p95 error of the skin end the program with 1
    #[arg(long, help_heading = RULES, value_name = "MM")]
    threshold_p95_mm: Option<f64>,
    #[command(flatten)]
    scale: ScaleArguments,
}

/// Runs the study, writes its report and prints its rows. Not passing is an error with the exit code of the outcome.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    if let Some(scenes) = arguments.random {
        return stability_random::run(&arguments.out, scenes, arguments.seed);
    }
    if arguments.stability {
        return stability::run(&arguments.out, &methods::available());
    }
    arguments.refuse_own_baseline()?;
    let mut input = arguments.input()?;
    let limits = Limits::default();
    let sources = FileSource::of_cases(input.cases.values(), arguments.scale);
    let place = JobContext { sources: &sources, limits: &limits, out: &arguments.out };
    let prepared = input.prepare(&sources, &limits, &StopQuery::never())?;
    let kept = arguments.keep.as_ref().map(|folder| folder.join(prepared.rows_key + ".json"));
    if let Some(file) = kept.as_ref().filter(|file| file.exists()) {
        input.earlier = Some(Box::new(read_report(file)?));
        eprintln!("rows       kept in {}", file.display());
    } else {
        for told in prepared.warnings.iter().filter(|warning| warning.code == ALL_METHODS) {
            eprintln!("expected   {}", told.detail);
        }
        for cost in truth_costs(&prepared.study) {
            eprintln!("expected   {}", cost.sentence());
        }
    }
    let _claim = Claim::of(&arguments.out, &[REPORT_JSON])?;
    let done = run_with_progress(&JobInput::Study(input), &place)?;
    let report = read_report(&arguments.out.join(REPORT_JSON))?;
    if let Some(file) = kept.filter(|_| report.rows_of.is_none() && report.is_complete()) {
        keep(&arguments.out.join(REPORT_JSON), &file)?;
    }
    print_report(&report);
    print_warnings(&done.result.warnings);
    print_files(&done.files, &arguments.out);
    match report.verdict.outcome {
        OutcomeName::Pass => Ok(()),
        outcome => Err(CommandError::Verdict { outcome, reasons: report.verdict.reasons }),
    }
}

/// Puts a report where a later study with the same rows finds it; half of one is never there.
fn keep(report: &Path, file: &Path) -> Result<(), CommandError> {
    let failed = |source| CommandError::Write { path: file.to_owned(), source };
    let folder = file.parent().unwrap_or(Path::new(""));
    std::fs::create_dir_all(folder).map_err(failed)?;
    let part = file.with_extension("part");
    std::fs::copy(report, &part).map_err(failed)?;
    std::fs::rename(&part, file).map_err(failed)
}

impl Arguments {
    fn input(&self) -> Result<StudyInput, CommandError> {
        let mut spec = match (&self.spec, self.small) {
            (Some(path), _) => read::<StudyDocument>(path)?,
            (None, true) => small(),
            (None, false) => {
                StudyDocument { levels: USUAL_LEVELS.to_vec(), ..StudyDocument::default() }
            }
        };
        let mut cases = BTreeMap::new();
        self.set_scenes(&mut spec, &mut cases)?;
        if !self.method.is_empty() {
            spec.methods = Some(self.method.iter().map(|name| name.as_str().into()).collect());
        }
        if !self.level.is_empty() {
            spec.levels = self.level.clone();
        }
        if !self.sweep.is_empty() {
            spec.sweep = sweep::document(&self.sweep);
            // Constants that are swept are in the place of the tissue of the small study.
            if self.small {
                spec.materials.clear();
            }
        }
        if let Some(repeats) = self.repeats {
            spec.repeats = repeats;
        }
        if let Some(p95_mm) = self.threshold_p95_mm {
            let given = spec.thresholds.take().unwrap_or_default();
            spec.thresholds = Some(ThresholdsDocument { p95_mm: Some(p95_mm), ..given });
        }
        // Paths of a document lead from where it lies.
        let folder = self.spec.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
        for (_, id) in spec.truth_meshes_mut() {
            *id = folder.join(&*id).to_string_lossy().into_owned();
        }
        let baseline = self.read_baseline(&mut spec)?;
        let (job, queue_s, truth_method, earlier) = (None, None, None, None);
        Ok(StudyInput { job, queue_s, cases, baseline, truth_method, earlier, spec })
    }

    /// The scenes of the arguments, or those of the document, or the usual ones; cases are read.
    fn set_scenes(
        &self,
        spec: &mut StudyDocument,
        cases: &mut BTreeMap<String, CaseDocument>,
    ) -> Result<(), CommandError> {
        if !self.scene.is_empty() || !self.case.is_empty() {
            spec.scenes = self.scene.iter().cloned().map(SceneReference::Name).collect();
            let named = self.case.iter().map(|path| CaseReference {
                case: path.to_string_lossy().into_owned(),
                name: None,
                series: self.series.clone(),
                plans: Vec::new(),
            });
            spec.scenes.extend(named.map(SceneReference::Case));
        } else if spec.scenes.is_empty() && spec.kind == StudyKind::Study {
            spec.scenes = USUAL_SCENES.map(|name| SceneReference::Name(name.to_owned())).into();
        }
        // Paths of arguments lead from here, those of a document from where it lies.
        let of_arguments = !self.case.is_empty();
        let folder = self.spec.as_deref().filter(|_| !of_arguments).and_then(Path::parent);
        // Plans that the study states stand over those of the files.
        let has_plans = !spec.plan_documents().is_empty();
        for scene in &mut spec.scenes {
            if let SceneReference::Case(reference) = scene {
                let path = folder.unwrap_or(Path::new("")).join(&reference.case);
                let case = read_case(&path, reference, has_plans)?;
                cases.insert(reference.case.clone(), case);
            }
        }
        for item in &mut spec.items {
            let path = folder.unwrap_or(Path::new("")).join(&item.case);
            let mut reference = CaseReference {
                case: item.case.clone(),
                name: None,
                series: None,
                plans: Vec::new(),
            };
            let mut case = read_case(&path, &mut reference, false)?;
            case.name = case.name.or(reference.name);
            item.plan = item.plan.take().or(reference.plans.pop());
            cases.insert(item.case.clone(), case);
        }
        Ok(())
    }

    /// The report would take the place of the one that it is compared with.
    fn refuse_own_baseline(&self) -> Result<(), CommandError> {
        let report = self.out.join(REPORT_JSON);
        match &self.baseline {
            Some(baseline) if is_same(baseline, &report) => Err(CommandError::Usage(format!(
                "the baseline {} would be replaced by the new report: give another folder",
                baseline.display()
            ))),
            _ => Ok(()),
        }
    }

    /// The report of the baseline. One that is not there is no mistake of use: the outcome says so.
    fn read_baseline(
        &self,
        spec: &mut StudyDocument,
    ) -> Result<Option<Box<ReportDocument>>, CommandError> {
        let Some(path) = &self.baseline else { return Ok(None) };
        spec.baseline = Some(path.to_string_lossy().into_owned());
        if !path.exists() {
            eprintln!(
                "baseline   {} is not there: the outcome will be `no-baseline`",
                path.display()
            );
            return Ok(None);
        }
        read_report(path).map(|report| Some(Box::new(report)))
    }
}

/// A report of this program. It may be larger than documents of clients.
fn read_report(path: &Path) -> Result<ReportDocument, CommandError> {
    let bytes = std::fs::read(path)
        .map_err(|source| CommandError::Read { path: path.to_owned(), source })?;
    serde_json::from_slice(&bytes)
        .map_err(|error| CommandError::Usage(format!("{} is no report: {error}", path.display())))
}

/// A case with mesh paths that lead from here; its plan goes into the reference unless the study has plans, and the name of
/// the file too.
fn read_case(
    path: &Path,
    reference: &mut CaseReference,
    has_plans: bool,
) -> Result<CaseDocument, CommandError> {
    let file: CaseFile = read(path)?;
    file.refuse_spec(OWN_WAYS, path)?;
    let CaseFile { mut case, plan, .. } = file;
    let mut plan = plan.unwrap_or_default();
    let folder = path.parent().unwrap_or(Path::new(""));
    let lead = |id: &mut String| *id = folder.join(&*id).to_string_lossy().into_owned();
    let bones: Vec<String> = case.bones.iter().map(|bone| bone.name.clone()).collect();
    case.mesh_references_mut().into_iter().for_each(|(_, id)| lead(id));
    for (_, id) in plan.surface_references_mut() {
        if !bones.contains(id) {
            lead(id);
        }
    }
    if reference.plans.is_empty() && !has_plans {
        reference.plans.push(plan);
    }
    if reference.name.is_none() {
        reference.name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    }
    Ok(case)
}

/// The slab of docs/verification.md#v29 at two levels.
fn small() -> StudyDocument {
    let (young_modulus_kpa, poisson_ratio) = SMALL_TISSUE;
    let tissue = MaterialDocument {
        young_modulus_kpa: Some(young_modulus_kpa),
        poisson_ratio: Some(poisson_ratio),
        ..MaterialDocument::default()
    };
    StudyDocument {
        scenes: vec![SceneReference::Name(SMALL_SCENE.to_owned())],
        plans: vec![PlanReference::Name(SMALL_PLAN.to_owned())],
        materials: vec![[("*".to_owned(), tissue)].into()],
        levels: USUAL_LEVELS.to_vec(),
        ..StudyDocument::default()
    }
}
