//! The skin as a membrane on tissue at finite strain.

use mechanics::boundary::Constraint;
use mechanics::material::hyperelastic::{Law, NeoHookean};
use mechanics::material::{PlaneStress, Sheet, SheetError};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::finite_strain::{Advance, Elements, FibreField, FiniteStrain};
use mechanics::model::fem::membrane::Membrane;
use mechanics::model::problem::LoadCase;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, Method, Plan, Prediction, Scene, Settings, SkinMembrane,
    predict,
};
use mechanics::progress::Unobserved;
use mechanics::solver::Tolerance;
use mechanics::study::scenes::{slab, slab_hex};
use nalgebra::Rotation3;

use super::numerical_error::{Question, moved_at_finite_strain};
use crate::scenes::{case_of, material, set, solve};

const SKIN: Sheet =
    Sheet { thickness: 1.5, young_modulus: 200.0, poisson_ratio: 0.45, along_lines: None };

/// Forces of the skin on top of a block of 10 x 8 x 4 mm all of whose nodes are moved, in mN, by node.
fn forces(mesh: &VolumeMesh, sheet: PlaneStress, moved: impl Fn(&Vector) -> Vector) -> Vec<Vector> {
    let top = &mesh.node_sets["z_max"];
    let faces = mesh.boundary_faces();
    let faces = faces.iter().filter(|face| face.nodes().iter().all(|node| top.contains(node)));
    let triangles = faces.flat_map(|face| face.triangles(&mesh.nodes)).collect();
    let membrane = Membrane { sheet, triangles, lines: Vec::new() };
    let laws = [Law::NeoHookean(NeoHookean { lambda: 50.0, mu: 5.0 })];
    let constraints: Vec<Constraint> =
        (0..).zip(&mesh.nodes).map(|(node, x)| Constraint::at(node, moved(x) - x)).collect();
    let one = vec![0; mesh.cells.len()];
    let reactions = |membrane: Option<&Membrane>| {
        let problem = FiniteStrain {
            mesh,
            nodes: &mesh.nodes,
            laws: &laws,
            law_of_cell: &one,
            pressure_of_cell: &one,
            elements: Elements::PLAIN,
            fibres: FibreField::default(),
            membrane,
            inner: std::sync::Arc::default(),
            constraints: &constraints,
            tolerance: Tolerance { relative_residual: 1e-10, memory_mb: 1000.0 },
            with_states: false,
            advance: Advance::default(),
            near: None,
        };
        let held = constraints.iter().map(|constraint| *constraint.values()).collect();
        let forces = vec![Vector::zeros(); mesh.nodes.len()];
        let case = LoadCase { held, forces, ..LoadCase::default() };
        problem.solve(&case, &Unobserved).unwrap().reactions
    };
    let (with, without) = (reactions(Some(&membrane)), reactions(None));
    with.iter().zip(&without).map(|(with, without)| with - without).collect()
}

fn strip() -> VolumeMesh {
    block(Vector::new(10.0, 8.0, 4.0), [4, 3, 1], CellShape::Tet4)
}

#[test]
fn a_sheet_that_is_stretched_and_turned_pulls_by_its_law_along_itself() {
    let mesh = strip();
    let turn = Rotation3::from_euler_angles(0.7, -1.1, 2.4);
    let Sheet { thickness, young_modulus, poisson_ratio: nu, .. } = SKIN;
    let stiffness = young_modulus / (1.0 - nu * nu);
    for stretch in [0.8, 1.0, 1.5] {
        let moved = |x: &Vector| turn * Vector::new(stretch * x.x, x.y, x.z);
        let pulled = forces(&mesh, PlaneStress::new(&SKIN).unwrap(), moved);
        let mut end = Vector::zeros();
        for (x, force) in mesh.nodes.iter().zip(&pulled) {
            if x.x > 9.9 {
                end += force;
            }
            let inside = x.x > 0.1 && x.x < 9.9 && x.y > 0.1 && x.y < 7.9;
            assert!(!inside || force.norm() < 1e-8, "{force}");
        }
        // S = E / (1 - nu²) (lambda² - 1) / 2 on 8 mm of thickness at rest.
        let stress = stiffness * (stretch * stretch - 1.0) / 2.0;
        let expected = turn * Vector::x() * (8.0 * thickness * stretch * stress);
        assert!((end - expected).norm() < 1e-8, "{stretch}: {end} instead of {expected}");
    }
}

#[test]
fn a_sheet_that_bears_no_compression_pulls_along_its_largest_strain_only() {
    let mesh = strip();
    let turn = Rotation3::from_euler_angles(0.7, -0.4, 0.9);
    let Sheet { thickness, young_modulus, poisson_ratio: nu, .. } = SKIN;
    let tension = 1.0;
    let sheet = PlaneStress::new(&SKIN).unwrap().with_tension(tension).unwrap();
    let sheet = sheet.without_compression().unwrap();
    // At the end of 8 mm, and at three of the five nodes of a side of 10 mm.
    let pulled = |moved: &dyn Fn(&Vector) -> Vector| {
        let forces = forces(&mesh, sheet, moved);
        let at = |counts: &dyn Fn(&Vector) -> bool| -> Vector {
            let nodes = mesh.nodes.iter().zip(&forces).filter(|(x, _)| counts(x));
            nodes.map(|(_, force)| force).sum()
        };
        [at(&|x| x.x > 9.9), at(&|x| x.y > 7.9 && x.x > 0.1 && x.x < 9.9)]
    };
    // What balances the tension at rest stays as it is.
    let at_rest = [Vector::x() * 8.0, Vector::y() * 7.5].map(|way| way * thickness * tension);
    // Across, the strip is narrowed by more than it would narrow by itself: S = E (lambda² - 1) / 2 + (1 - nu) s.
    let [end, side] = pulled(&|x| turn * Vector::new(1.2 * x.x, 0.8 * x.y, x.z));
    let stress = young_modulus * (1.2 * 1.2 - 1.0) / 2.0 + (1.0 - nu) * tension;
    let expected = turn * Vector::x() * (8.0 * thickness * 1.2 * stress) - at_rest[0];
    assert!((end - expected).norm() < 1e-8, "{end} instead of {expected}");
    assert!((side + at_rest[1]).norm() < 1e-8, "{side}");
    // Pressed in all directions it has no force of its own.
    let slack = pulled(&|x| turn * Vector::new(0.9 * x.x, 0.9 * x.y, x.z));
    assert!(slack.iter().zip(&at_rest).all(|(own, rest)| (own + rest).norm() < 1e-8), "{slack:?}");
}

#[test]
fn a_taut_sheet_resists_slopes_whatever_they_are() {
    let mesh = strip();
    let tension = 20.0;
    let taut = PlaneStress::new(&SKIN).unwrap().with_tension(tension).unwrap();
    let lifted = |x: &Vector| x + Vector::z() * (0.3 * x.x);
    let [taut, slack] =
        [taut, PlaneStress::new(&SKIN).unwrap()].map(|own| forces(&mesh, own, lifted));
    let mut end = Vector::zeros();
    for ((x, taut), slack) in mesh.nodes.iter().zip(&taut).zip(&slack) {
        if x.x > 9.9 {
            end += taut - slack;
        }
    }
    let expected = Vector::z() * (8.0 * SKIN.thickness * tension * 0.3);
    assert!((end - expected).norm() < 1e-8, "{end} instead of {expected}");
}

fn with_skin(mut question: Question) -> Question {
    let sheet = PlaneStress::new(&SKIN).unwrap();
    question.settings.membrane = Some(SkinMembrane { sheet, lines: None });
    question
}

#[test]
fn what_linear_elasticity_leaves_out_of_a_skin_falls_with_the_square_and_is_estimated() {
    for (case, element) in
        [(slab().case, ElementChoice::Stabilised), (slab_hex().case, ElementChoice::MeanDilatation)]
    {
        let left_out = |length: f64| {
            let Question { case, plan, settings, .. } =
                with_skin(moved_at_finite_strain(element, length, &case));
            let linear = Settings { method: Method::FemLinear, ..settings.clone() };
            let scene = Scene::new(&case, &plan, &linear).unwrap();
            let found = predict(&scene, &Unobserved).unwrap();
            let finite = solve(&case, &plan, &settings);
            let nodes = || scene.skin.nodes().iter().map(|&node| node as usize);
            let off = nodes().map(|n| (finite.displacement[n] - found.displacement[n]).norm());
            let estimated = found.nonlinearity.as_ref().unwrap();
            let estimated = nodes().map(|n| estimated.left_out[n].norm());
            [off.sum::<f64>(), estimated.sum::<f64>()]
        };
        let ([little, _], [more, estimated]) = (left_out(0.5), left_out(2.0));
        println!(
            "{element:?}: {:.2} times for four times as far, estimated {:.2}",
            more / little,
            estimated / more
        );
        assert!((more / little / 16.0 - 1.0).abs() < 0.25, "{}", more / little);
        assert!((0.8..1.25).contains(&(estimated / more)), "{}", estimated / more);
    }
}

#[test]
fn the_error_of_the_mesh_is_estimated_with_a_skin_at_finite_strain() {
    let (stabilised, mean) = (ElementChoice::Stabilised, ElementChoice::MeanDilatation);
    // Hexahedra under a skin that is moved by 10 mm are estimated 2.2 times as far off as they are.
    for (case, element, halved, mm) in
        [(slab().case, stabilised, 1, 10.0), (slab_hex().case, mean, 2, 7.0)]
    {
        let question: Question = with_skin(moved_at_finite_strain(element, mm, &case));
        let name = format!("{element:?} with skin moved by {mm} mm");
        Question { halved, truth: element, ..question }.assert_effective(&name);
    }
}

/// A soft block of 60 x 36 x 12 mm below a stiff skin, in so many cells, whose bone at one end comes towards that at the other.
struct PressedSkin {
    cells: [usize; 3],
    towards: f64,
    sheet: PlaneStress,
    method: Method,
}

impl PressedSkin {
    fn prediction(&self) -> (VolumeMesh, Prediction) {
        let mut mesh = block(Vector::new(60.0, 36.0, 12.0), self.cells, CellShape::Hex8);
        let below = |range: std::ops::Range<f64>| -> Vec<u32> {
            let nodes = (0..).zip(&mesh.nodes).filter(|(_, x)| x.z < 1e-9 && range.contains(&x.x));
            nodes.map(|(node, _)| node).collect()
        };
        let (moved, held) = (below(-1.0..24.1), below(35.9..61.0));
        mesh.node_sets.insert("moved".to_owned(), moved);
        mesh.node_sets.insert("held".to_owned(), held);
        let case = Case {
            segments: vec![CaseSegment { name: "jaw".to_owned(), nodes: set("moved") }],
            fixed: vec![set("held")],
            ..case_of(mesh.clone(), material(10.0, 0.46))
        };
        let movement = RigidMovement::about_pivot(
            Vector::zeros(),
            Vector::zeros(),
            Vector::x() * self.towards,
        );
        let segments = vec![PlannedSegment { name: "jaw".to_owned(), movement }];
        let membrane = Some(SkinMembrane { sheet: self.sheet, lines: None });
        let settings = Settings { method: self.method.clone(), membrane, ..Settings::default() };
        let found = solve(&case, &Plan { segments, ..Plan::default() }, &settings);
        (mesh, found)
    }

    fn is_told(&self) -> bool {
        let (_, found) = self.prediction();
        found.warnings.iter().any(|warning| warning.code == "membrane-wrinkles")
    }

    /// Of the nodes of the skin every 6 mm.
    fn movements(&self) -> Vec<Vector> {
        let (mesh, found) = self.prediction();
        let is_common = |x: &Vector| {
            x.z > 11.9 && [x.x, x.y].iter().all(|at| (at / 6.0 - (at / 6.0).round()).abs() < 1e-9)
        };
        let mut nodes: Vec<(Vector, Vector)> = mesh
            .nodes
            .iter()
            .copied()
            .zip(found.displacement)
            .filter(|(x, _)| is_common(x))
            .collect();
        nodes.sort_by(|(a, _), (b, _)| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        nodes.into_iter().map(|(_, u)| u).collect()
    }
}

/// With a muscle of 1 kPa beside it the skin of this block differs between meshes by .16 mm at finite strain, and not less on finer ones.
#[test]
fn a_sheet_that_is_pressed_until_it_wrinkles_is_told() {
    let slack = PlaneStress::new(&SKIN).unwrap();
    let taut = slack.with_tension(40.0).unwrap();
    let is_told = |towards, sheet| {
        let cells = [30, 18, 6];
        PressedSkin { cells, towards, sheet, method: Method::FemLinear }.is_told()
    };
    assert!(is_told(3.0, slack));
    assert!(!is_told(3.0, taut));
    assert!(!is_told(-3.0, slack));
    assert!(!is_told(0.1, slack));
}

#[test]
fn a_sheet_that_bears_no_compression_has_a_limit_where_it_wrinkles() {
    let carried = PlaneStress::new(&SKIN).unwrap();
    // The least tension that it may have.
    let tension_only = carried.with_tension(1.0).unwrap().without_compression().unwrap();
    let changes = |sheet: PlaneStress| {
        let meshes = [[10, 6, 2], [20, 12, 4], [30, 18, 6]].map(|cells| {
            PressedSkin { cells, towards: 3.0, sheet, method: Method::FemNonlinear }.movements()
        });
        let change = |one: &[Vector], other: &[Vector]| {
            one.iter().zip(other).map(|(one, other)| (one - other).norm()).fold(0.0, f64::max)
        };
        [change(&meshes[0], &meshes[1]), change(&meshes[1], &meshes[2])]
    };
    let (pressed, tension) = (changes(carried), changes(tension_only));
    println!("changes from mesh to mesh in mm: carried {pressed:.3?}, tension only {tension:.3?}");
    assert!(tension[1] < 0.5 * tension[0], "{tension:?}");
    let told = PressedSkin {
        cells: [20, 12, 4],
        towards: 3.0,
        sheet: tension_only,
        method: Method::FemNonlinear,
    };
    assert!(!told.is_told());
}

#[test]
fn a_sheet_that_bears_no_compression_is_refused_without_tension() {
    let sheet = PlaneStress::new(&SKIN).unwrap();
    let found = sheet.with_tension(0.9).unwrap().without_compression();
    assert_eq!(found, Err(SheetError::TooSlack { tension: 0.9, least: 1.0 }));
    assert!(sheet.with_tension(1.0).unwrap().without_compression().is_ok());
}
