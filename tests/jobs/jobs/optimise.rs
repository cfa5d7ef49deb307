//! Inverse planning from a job document to result files, without a server.

use std::path::Path;

use super::stop_at::StopAt;
use facies::jobs::{
    JobContext, JobError, JobInput, JobOutput, MeshSource, OptimiseInput, SourceError, StoredMesh,
    StoredShape, work,
};
use facies::schema::Limits;
use facies::schema::case::document::LengthUnit;
use facies::schema::job::ErrorClass;
use mechanics::mesh::{CellShape, Vector, sample};
use mechanics::progress::{Phase, Progress, Unobserved};

/// One block of 60 x 60 x 30 mm under every id.
struct Block;

impl MeshSource for Block {
    fn mesh(&self, _id: &str) -> Result<StoredMesh, SourceError> {
        let mesh = sample::block(Vector::new(60.0, 60.0, 30.0), [4, 4, 3], CellShape::Hex8);
        Ok(StoredMesh {
            shape: StoredShape::Volume(mesh.into()),
            of_points: Default::default(),
            frame: None,
            units: Some(LengthUnit::Mm),
            warnings: Vec::new(),
            told: Vec::new(),
            sha256: "sha of block".to_owned(),
            identity: "sha of block".to_owned(),
        })
    }

    fn predicted_skin(&self, job: &str) -> Result<StoredMesh, SourceError> {
        Err(SourceError::Unknown { id: job.to_owned() })
    }
}

/// Two bones at opposite ends, of which the second carries a node set that the case does not call a segment.
const CASE: &str = r#"{"units":"mm","volume":"block","segments":[{"name":"left","nodes":{"node_set":"x_min"}}],
    "fixed":[{"node_set":"z_min"}],"landmarks":{"tip":[30,30,30]}}"#;
const SPEC: &str = r#"{"kind":"optimise","case":"",
    "targets":[{"nodes":{"node_set":"z_max"},"displacement_mm":[0.5,null,0.1],"sigma_mm":0.3},
               {"landmark":"tip","displacement_mm":[null,0.2,null]}],
    "bounds":{"x_max":{"translation_mm":[[-5,5],[-5,5],[1,1]]},
              "left":{"translation_mm":[[-5,5],[-5,5],[-5,5]],"rotation_deg":[[0,0],[-9,9],[0,0]],"pivot_mm":[0,30,0]}}}"#;

fn input() -> OptimiseInput {
    let (case, spec) = (serde_json::from_str(CASE).unwrap(), serde_json::from_str(SPEC).unwrap());
    OptimiseInput { job: None, queue_s: None, case, spec }
}

/// The same with some of the spec replaced.
fn changed(from: &str, to: &str) -> OptimiseInput {
    let spec = serde_json::from_str(&SPEC.replacen(from, to, 1)).unwrap();
    OptimiseInput { spec, ..input() }
}

fn run_input(input: OptimiseInput, out: &Path) -> Result<JobOutput, JobError> {
    let limits = Limits::default();
    let place = JobContext { sources: &Block, limits: &limits, out };
    work(&JobInput::Optimise(input), &place, &Unobserved)
}

fn run(out: &Path, progress: &dyn Progress) -> Result<JobOutput, JobError> {
    let limits = Limits::default();
    let place = JobContext { sources: &Block, limits: &limits, out };
    work(&JobInput::Optimise(input()), &place, progress)
}

#[test]
fn segments_are_matched_by_name_in_whatever_order_they_come() {
    let out = tempfile::tempdir().unwrap();
    let done = run(out.path(), &Unobserved).unwrap();
    let found = done.result.optimisation.unwrap();
    let of = |name: &str| found.plan.segments.iter().find(|segment| segment.name == name).unwrap();
    // Held at 1 mm by its bounds, and without rotation.
    let right = of("x_max").translation_mm.unwrap().0;
    assert_eq!((right[2], of("x_max").rotation_deg), (1.0, None));
    let [x, y, z] = of("left").rotation_deg.unwrap().0;
    assert!((x, z) == (0.0, 0.0) && y != 0.0 && y.abs() <= 9.0);
    assert_eq!(found.parameters.len() + found.at_bound.len(), 6);
    assert!(found.verified_difference_mm.unwrap() < 1e-5);
    assert!(found.targets[0].points > 1 && found.targets[1].points == 1);
}

/// Its full solution is that of finite strain, of which the linear response of the same plan knows less.
#[test]
fn a_plan_of_order_2_reaches_its_targets_at_finite_strain() {
    let of_order = |order: u8| {
        let out = tempfile::tempdir().unwrap();
        let kind = format!(r#""kind":"optimise","order":{order}"#);
        let mut input = changed(r#""kind":"optimise""#, &kind);
        input.spec.targets[0].displacement_mm = serde_json::from_str("[2.5,null,0.1]").unwrap();
        run_input(input, out.path()).unwrap().result
    };
    let [first, second] = [1, 2].map(of_order);
    let found = second.optimisation.unwrap();
    let method = second.provenance.method.unwrap();
    assert_eq!(method, "fem_nonlinear");
    let adds = found.second_order_mm.unwrap();
    let (left_out, apart) =
        (found.nonlinearity_estimate_mm.unwrap(), found.verified_difference_mm.unwrap());
    println!("second order {adds:.3} mm, third {left_out:.4} mm, finite strain {apart:.3} mm away");
    assert!(adds > 0.01 && left_out < 0.5 * adds && apart < 10.0 * adds);
    let linear = first.optimisation.unwrap();
    assert!(linear.second_order_mm.is_none() && linear.plan != found.plan);
    let out = tempfile::tempdir().unwrap();
    let tissue =
        r#""kind":"optimise","order":2,"tissue_bounds":{"*":{"poisson_ratio":[0.3,0.49]}}"#;
    let refused = run_input(changed(r#""kind":"optimise""#, tissue), out.path()).unwrap_err();
    assert!(refused.to_string().contains("order 1 only"), "{refused}");
}

#[test]
fn a_queued_job_survives_being_written_and_read() {
    let input = JobInput::Optimise(input());
    let text = serde_json::to_string(&input).unwrap();
    assert_eq!(serde_json::from_str::<JobInput>(&text).unwrap(), input);
}

#[test]
fn a_job_that_is_cancelled_stops_in_every_phase_and_writes_nothing() {
    for phase in [Phase::Validate, Phase::Assemble, Phase::Solve, Phase::Surface, Phase::Compare] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let error = run(&out, &StopAt::phase(phase)).unwrap_err();
        assert_eq!(
            (error.kind().name(), error.class()),
            ("cancelled", ErrorClass::Cancelled),
            "{phase:?}"
        );
        assert!(!out.exists(), "{phase:?}");
    }
}

/// The faults of inverse planning for other targets.
fn refused(targets: &str) -> String {
    let mut input = input();
    input.spec.targets = serde_json::from_str(targets).unwrap();
    let folder = tempfile::tempdir().unwrap();
    format!("{:?}", run_input(input, &folder.path().join("out")).unwrap_err())
}

#[test]
fn several_nodes_at_one_place_and_targets_given_twice_are_refused() {
    let set = r#"[{"nodes":{"node_set":"z_max"},"position_mm":[27,20,30]}]"#;
    let told = refused(set);
    assert!(told.contains("/spec/targets/0/position_mm") && told.contains("15 nodes"), "{told}");
    let tip = r#"{"landmark":"tip","displacement_mm":[1,null,null],"sigma_mm":0.3}"#;
    let told = refused(&format!("[{tip},{tip}]"));
    assert!(told.contains("/spec/targets/1") && told.contains("target 0"), "{told}");
    // A plane for all of them is a place that they may go to.
    let mut input = input();
    let plane = r#"[{"nodes":{"node_set":"z_max"},"position_mm":[null,null,30.5]}]"#;
    input.spec.targets = serde_json::from_str(plane).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let done = run_input(input, &folder.path().join("out")).unwrap();
    assert_eq!(done.result.optimisation.unwrap().targets[0].points, 15);
}

#[test]
fn nodes_of_a_target_that_are_not_on_the_skin_are_counted() {
    let mut input = input();
    input.case.skin = serde_json::from_str(r#"{"node_set":"z_max"}"#).unwrap();
    let side = r#"[{"nodes":{"node_set":"y_max"},"displacement_mm":[0.5,null,null]}]"#;
    input.spec.targets = serde_json::from_str(side).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let done = run_input(input, &folder.path().join("out")).unwrap().result;
    let told = done.warnings.iter().find(|warning| warning.code == "target-off-skin").unwrap();
    // Of 5 x 4 nodes those of the upper edge are skin.
    assert!(told.detail.contains("15 of 20 nodes of target 0"), "{told:?}");
}
