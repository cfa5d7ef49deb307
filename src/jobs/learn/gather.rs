//! The cohort of a job: its cases predicted once more for their stress, and what was measured of them.

use std::collections::BTreeMap;

use super::input::LearnInput;
use super::thetas::at_thetas;
use crate::jobs::clock::Observed;
use crate::jobs::failure::JobError;
use crate::jobs::fetch::fetch;
use crate::jobs::made::{refused_cohort, refused_virtual};
use crate::jobs::output::JobContext;
use crate::jobs::predict::Prepared;
use crate::jobs::source::StoredShape;
use crate::schema::learn::correspondence::CorrespondenceDocument;
use crate::schema::predict::result::InputDocument;
use crate::schema::{ErrorCode, Matrix4x4, Pointer, Problem};
use mechanics::learning::classes::{ThetaOfClass, held_out, thetas};
use mechanics::learning::measures::carried_by;
use mechanics::learning::validation::Column;
use mechanics::learning::virtual_cohort::{Making, virtual_cohort};
use mechanics::learning::{Cohort, LearningCase, measures};
use mechanics::mesh::{Frame, TriangleSurface, Vector};
use mechanics::prediction::{Scene, Skin, equilibrium};
use mechanics::progress::Progress;
use mechanics::registration::RigidTransform;

/// What is learned from, and the columns of the table that are not learned.
pub struct Gathered {
    pub cohort: Cohort,
    /// The mechanical prediction is among them, called by its method.
    pub mechanical: Vec<Column>,
    pub thetas: Vec<ThetaOfClass>,
    pub inputs: Vec<InputDocument>,
    pub frame: Frame,
    /// The skin of the first case at rest.
    pub face: TriangleSurface,
    /// Of the meshes of operated cases.
    pub correspondence: Option<CorrespondenceDocument>,
}

pub fn gather(
    input: &LearnInput,
    place: &JobContext,
    clock: &Observed,
) -> Result<Gathered, JobError> {
    match &input.spec.made {
        Some(made) => {
            let making = Making {
                seed: u64::from(made.seed),
                fineness: made.fineness as usize,
                mapping: made.mapping_mm,
            };
            let cohort = virtual_cohort(made.patients as usize, making, clock);
            let cohort = cohort.map_err(|error| refused_virtual(error, clock))?;
            Ok(Gathered {
                cohort: cohort.cohort,
                mechanical: cohort.mechanical,
                thetas: cohort.thetas,
                inputs: Vec::new(),
                frame: Frame::Lps,
                face: cohort.face,
                correspondence: None,
            })
        }
        None => of_cases(input, place, clock),
    }
}

fn of_cases(
    input: &LearnInput,
    place: &JobContext,
    clock: &Observed,
) -> Result<Gathered, JobError> {
    let mut first: Option<Prepared> = None;
    let mut cases = Vec::new();
    let mut inputs = Vec::new();
    let mut told = Vec::new();
    for (index, member) in input.cases.iter().enumerate() {
        let at = Pointer::root().key("spec").key("cases").index(index);
        let prepared = member.prediction.prepare(place.sources, place.limits)?;
        prepared.admit(0, place.limits)?;
        corresponds(first.as_ref().unwrap_or(&prepared), &prepared, &at)?;
        let name = input.spec.name(index);
        let stated = input.spec.cases.get(index).map(|case| case.actual.as_str());
        let actual = fetch(place.sources, stated.unwrap_or_default(), &at.key("actual"))?;
        inputs.push(actual.to_input(&format!("actual {name}")));
        let mut after = places(&actual.shape, &prepared.scene, &at.key("actual"))?;
        register(&mut after, input.spec.cases.get(index).and_then(|case| case.matrix4x4));
        if let Some(frame) = actual.frame.filter(|frame| *frame != prepared.case.frame) {
            let detail = format!(
                "the mesh is in {frame:?}, and the case in {:?}: distances between them mean nothing",
                prepared.case.frame
            );
            return Err(Problem::at(&at.key("actual"), ErrorCode::FrameConflict, detail).into());
        }
        let class = input.spec.class(index, prepared.plan.segments.len());
        cases.push(learned([name, class], &prepared.scene, &after, clock)?);
        if input.spec.theta {
            told.push(at_thetas(&prepared, &at.key("prediction"), clock)?);
        }
        clock.step(index + 1, input.cases.len());
        clock.check()?;
        first.get_or_insert(prepared);
    }
    let correspondence = first.as_ref().map(|own| CorrespondenceDocument::new(&own.scene));
    let nothing = (TriangleSurface::default(), BTreeMap::new(), Frame::Unspecified);
    let (face, regions, frame) = first.map_or(nothing, |own| {
        let Skin { surface, regions } = own.scene.skin;
        (surface, regions, own.case.frame)
    });
    let cohort = Cohort::new(cases, regions, &input.predicted_by());
    let cohort = cohort.map_err(|error| refused_cohort(&error))?;
    let column = |name: &str, of: &dyn Fn(&LearningCase) -> Vec<f64>| {
        let told: Vec<Vec<f64>> = cohort.cases.iter().map(of).collect();
        Column::of(name, &told, &cohort)
    };
    let mut mechanical = vec![
        column("no movement", &|case| vec![0.0; case.actual.len()]),
        column(&cohort.mechanical, &|case| case.predicted.clone()),
    ];
    let mut fitted = Vec::new();
    if input.spec.theta {
        mechanical.push(held_out(&cohort, &told));
        fitted = thetas(&cohort, &told);
    }
    Ok(Gathered { mechanical, cohort, thetas: fitted, inputs, frame, face, correspondence })
}

/// Cases have the same cells, frame, skin, bone and method.
fn corresponds(first: &Prepared, other: &Prepared, at: &Pointer) -> Result<(), JobError> {
    let [one, two] = [first, other].map(|own| &own.scene);
    let conflict =
        |code, detail: String| Err(Problem::at(&at.key("prediction"), code, detail).into());
    let [a, b] = [one, two].map(|own| (own.mesh.nodes.len(), own.mesh.cells.len()));
    if a != b || one.mesh.cells != two.mesh.cells {
        let detail = format!(
            "its mesh has {} nodes and {} cells, that of the first case {} and {}, and cells have to be the same: nodes do not correspond",
            b.0, b.1, a.0, a.1
        );
        return conflict(ErrorCode::NotCorresponding, detail);
    }
    if one.skin.nodes() != two.skin.nodes() {
        let [a, b] = [one, two].map(|own| own.skin.nodes().len());
        let detail = format!(
            "its skin has {b} nodes and that of the first case {a}, and they have to be the same"
        );
        return conflict(ErrorCode::NotCorresponding, detail);
    }
    if let Some(detail) = other_bone(one, two) {
        return conflict(ErrorCode::NotCorresponding, detail);
    }
    if first.case.frame != other.case.frame {
        let detail = format!(
            "its frame is {:?} and that of the first case {:?}",
            other.case.frame, first.case.frame
        );
        return conflict(ErrorCode::FrameConflict, detail);
    }
    let [a, b] = [one, two].map(|own| own.settings.method.kind().name());
    match a == b {
        true => Ok(()),
        false => conflict(
            ErrorCode::MethodMismatch,
            format!(
                "it was predicted by {b} and the first case by {a}: what they miss is not the same"
            ),
        ),
    }
}

/// In what the segments of a case, in their order, differ from those of the first.
fn other_bone(first: &Scene, other: &Scene) -> Option<String> {
    let [a, b] = [first, other].map(|own| own.segments.len());
    if a != b {
        return Some(format!(
            "its case has {b} segments and that of the first case {a}, and they have to be the same"
        ));
    }
    let differing = (0..a).find_map(|number| {
        let [one, two] =
            [first, other].map(|own| (own.segments[number].name.as_str(), carried_by(own, number)));
        (one != two).then_some((one, two))
    });
    let ((name, nodes), (own_name, own)) = differing?;
    let common = own.iter().filter(|node| nodes.binary_search(node).is_ok()).count();
    Some(format!(
        "its segment {own_name:?} carries {} nodes, {common} of which are among the {} of segment {name:?} of the first case, and they have to be the same under the same name, in the same order: bone does not correspond",
        own.len(),
        nodes.len()
    ))
}

/// Where the skin is in a mesh after the operation.
fn places(shape: &StoredShape, scene: &Scene, at: &Pointer) -> Result<Vec<Vector>, JobError> {
    let nodes = scene.skin.nodes();
    let (points, expected): (&[Vector], usize) = match shape {
        StoredShape::Volume(volume) => (&volume.nodes, scene.mesh.nodes.len()),
        StoredShape::Surface(surface) => (&surface.points, nodes.len()),
        StoredShape::Image(_) => (&[], nodes.len()),
    };
    if points.len() != expected {
        let detail = format!(
            "it has {} points, and {expected} would correspond to the mesh of the case",
            points.len()
        );
        return Err(Problem::at(at, ErrorCode::NotCorresponding, detail).into());
    }
    Ok(match shape {
        StoredShape::Volume(_) => nodes.iter().map(|&node| points[node as usize]).collect(),
        StoredShape::Surface(_) | StoredShape::Image(_) => points.to_vec(),
    })
}

/// Brings points into the frame of the case.
fn register(points: &mut [Vector], matrix: Option<Matrix4x4>) {
    let Some(Matrix4x4(matrix)) = matrix else { return };
    let transform = RigidTransform::from_matrix4(&matrix);
    points.iter_mut().for_each(|point| *point = transform.apply(point));
}

fn learned(
    [name, class]: [String; 2],
    scene: &Scene,
    after: &[Vector],
    clock: &Observed,
) -> Result<LearningCase, JobError> {
    let (solved, _) = equilibrium(scene, clock).map_err(|error| clock.judge(error))?;
    let displacement = &solved.displacement;
    let before = scene.skin.nodes().iter().map(|&node| scene.mesh.nodes[node as usize]);
    let moved = after.iter().zip(before).map(|(after, before)| after - before);
    Ok(LearningCase {
        name,
        class,
        features: measures::features(scene, displacement),
        bone: measures::bone(scene, displacement),
        predicted: measures::skin(scene, displacement),
        actual: moved.flat_map(|own| [own.x, own.y, own.z]).collect(),
    })
}
