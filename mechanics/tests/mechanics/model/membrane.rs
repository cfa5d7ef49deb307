//! docs/verification.md#v11: the skin as a membrane, alone and on every element.

use mechanics::material::{PlaneStress, Sheet, SheetError};
use mechanics::mesh::sample::block;
use mechanics::mesh::{CellShape, Vector, VolumeMesh};
use mechanics::model::fem::mass_tensor::{Iterations, MassTensorSettings};
use mechanics::model::fem::membrane::Membrane;
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Case, CaseSegment, ElementChoice, FibreDirection, Load, Method, Plan, Scene, Settings,
    SkinMembrane,
};
use mechanics::progress::Unobserved;
use mechanics::response::build;
use nalgebra::Rotation3;

use crate::scenes::{case_of, constraint, exact, material, set, solve};

/// The skin of V.11.
const SKIN: Sheet =
    Sheet { thickness: 1.5, young_modulus: 200.0, poisson_ratio: 0.45, along_lines: None };

/// A strip of 40 x 10 mm on top of a block, whose triangles are cut irregularly; turned by a rotation.
fn strip(sheet: &Sheet, lines: Vector, turn: Rotation3<f64>) -> (VolumeMesh, Membrane) {
    let mut mesh = block(Vector::new(40.0, 10.0, 4.0), [8, 3, 1], CellShape::Tet4);
    for x in &mut mesh.nodes {
        let inside = x.x > 0.1 && x.x < 39.9 && x.y > 0.1 && x.y < 9.9;
        if inside {
            *x += Vector::new((x.x * 3.0).sin(), (x.y + x.x).cos(), 0.0) * 0.8;
        }
        *x = turn * *x;
    }
    let top = &mesh.node_sets["z_max"];
    let faces: Vec<_> = mesh
        .boundary_faces()
        .into_iter()
        .filter(|face| face.nodes().iter().all(|node| top.contains(node)))
        .collect();
    let triangles: Vec<[u32; 3]> =
        faces.iter().flat_map(|face| face.triangles(&mesh.nodes)).collect();
    let sheet = PlaneStress::new(sheet).unwrap();
    let lines = match sheet.has_lines() {
        true => vec![turn * lines; triangles.len()],
        false => Vec::new(),
    };
    (mesh, Membrane { sheet, triangles, lines })
}

/// The force of the sheet at its ends and the largest one elsewhere, for strains along and across the strip.
fn stretched(sheet: &Sheet, lines: Vector, strains: Vector) -> (f64, f64) {
    let turn = Rotation3::from_euler_angles(0.4, 1.0, -2.0);
    let (mesh, membrane) = strip(sheet, lines, turn);
    let back = turn.inverse();
    let moved: Vec<Vector> =
        mesh.nodes.iter().map(|x| turn * (back * x).component_mul(&strains)).collect();
    let forces = membrane.internal_forces(&mesh, &moved);
    let (mut end, mut elsewhere) = (Vector::zeros(), 0.0_f64);
    for (x, force) in mesh.nodes.iter().zip(&forces) {
        let along = (back * x).x;
        match along {
            _ if along > 39.9 => end += force,
            _ if along < 0.1 => {}
            _ => elsewhere = elsewhere.max(force.norm()),
        }
    }
    assert!((end - turn * Vector::x() * (back * end).x).norm() < 1e-10 * end.norm());
    ((back * end).x, elsewhere)
}

#[test]
fn a_strip_stretched_by_one_percent_pulls_with_modulus_times_thickness_times_width() {
    // 200 kPa times 15 mm² times 1 %: 30 mN, with free sides at a lateral strain of -0.45 %.
    let (force, elsewhere) = stretched(&SKIN, Vector::x(), Vector::new(0.01, -0.0045, 7.0));
    assert!((force / 30.0 - 1.0).abs() < 1e-10, "{force}");
    assert!(elsewhere < 1e-10 * force, "{elsewhere:e}");
}

#[test]
fn a_sheet_that_is_tilted_or_moved_out_of_its_plane_resists_nothing() {
    let turn = Rotation3::from_euler_angles(0.4, 1.0, -2.0);
    let (mesh, membrane) = strip(&SKIN, Vector::x(), turn);
    let (normal, across) = (turn * Vector::z(), turn * Vector::new(0.03, -0.02, 0.0));
    let tilted: Vec<Vector> = mesh.nodes.iter().map(|x| normal * (across.dot(x) + 0.5)).collect();
    let forces = membrane.internal_forces(&mesh, &tilted);
    let energy: f64 = forces.iter().zip(&tilted).map(|(f, u)| f.dot(u)).sum();
    // A stretch as large as the tilt has an energy of E t A strain² = 200 * 1.5 * 400 * 0.03².
    assert!(energy.abs() < 1e-10 * 108.0, "{energy:e}");
    let spin = turn * Vector::new(0.01, 0.02, -0.03);
    let turned: Vec<Vector> = mesh.nodes.iter().map(|x| spin.cross(x)).collect();
    let forces = membrane.internal_forces(&mesh, &turned);
    let largest = forces.iter().map(Vector::norm).fold(0.0, f64::max);
    assert!(largest < 1e-10 * 30.0, "{largest:e}");
}

#[test]
fn a_sheet_with_lines_is_stiffer_along_them_than_across() {
    let lines = Sheet { young_modulus: 100.0, along_lines: Some(400.0), ..SKIN };
    // Along: it narrows by nu. Across: by nu E_t / E_f.
    let (along, rest) = stretched(&lines, Vector::x(), Vector::new(0.01, -0.0045, 0.0));
    assert!((along / 60.0 - 1.0).abs() < 1e-10 && rest < 1e-8, "{along} {rest:e}");
    let (across, rest) = stretched(&lines, -Vector::y(), Vector::new(0.01, -0.001_125, 0.0));
    assert!((across / 15.0 - 1.0).abs() < 1e-10 && rest < 1e-8, "{across} {rest:e}");
    let same = Sheet { along_lines: Some(200.0), ..SKIN };
    let askew = Vector::new(0.6, 0.8, 0.0);
    let (force, rest) = stretched(&same, askew, Vector::new(0.01, -0.0045, 0.0));
    assert!((force / 30.0 - 1.0).abs() < 1e-10 && rest < 1e-8, "{force} {rest:e}");
}

#[test]
fn sheets_that_cannot_be_are_refused_by_name() {
    type Is = fn(&SheetError) -> bool;
    let wrong: [(Sheet, Is); 5] = [
        (Sheet { thickness: 0.0, ..SKIN }, |e| matches!(e, SheetError::Thickness(_))),
        (Sheet { young_modulus: -1.0, ..SKIN }, |e| matches!(e, SheetError::YoungModulus(_))),
        (Sheet { poisson_ratio: 0.51, ..SKIN }, |e| matches!(e, SheetError::PoissonRatio(_))),
        (Sheet { along_lines: Some(f64::NAN), ..SKIN }, |e| matches!(e, SheetError::AlongLines(_))),
        (Sheet { along_lines: Some(40.0), ..SKIN }, |e| {
            matches!(e, SheetError::TooSoftAlongLines { .. })
        }),
    ];
    for (sheet, is) in wrong {
        let error = PlaneStress::new(&sheet).unwrap_err();
        assert!(is(&error), "{error}");
    }
}

fn membrane(along_lines: Option<f64>, lines: Option<FibreDirection>) -> Option<SkinMembrane> {
    let sheet = PlaneStress::new(&Sheet { along_lines, poisson_ratio: 0.3, ..SKIN }).unwrap();
    Some(SkinMembrane { sheet, lines })
}

const MODELS: [(CellShape, ElementChoice, Method); 6] = [
    (CellShape::Tet4, ElementChoice::Plain, Method::FemLinear),
    (CellShape::Tet4, ElementChoice::Stabilised, Method::FemLinear),
    (CellShape::Tet4, ElementChoice::Quadratic, Method::FemLinear),
    (
        CellShape::Tet4,
        ElementChoice::Plain,
        Method::MassTensorTransverse(MassTensorSettings { iterations: Iterations::Fast }),
    ),
    (CellShape::Hex8, ElementChoice::MeanDilatation, Method::FemLinear),
    (CellShape::Wedge6, ElementChoice::MeanDilatation, Method::FemLinear),
];

/// A bar of 40 x 10 x 6 mm with skin above, stretched by 1 %, its other sides free.
fn bar(shape: CellShape) -> (Case, Plan) {
    let mesh = block(Vector::new(40.0, 10.0, 6.0), [4, 2, 2], shape);
    let mut case = case_of(mesh, material(15.0, 0.3));
    case.skin = Some(set("z_max"));
    // Planes of symmetry leave the bar free to narrow.
    let prescribed = vec![
        constraint("x_min", [Some(0.0), None, None]),
        constraint("y_min", [None, Some(0.0), None]),
        constraint("z_min", [None, None, Some(0.0)]),
        constraint("x_max", [Some(0.4), None, None]),
    ];
    (case, Plan { prescribed, ..Plan::default() })
}

#[test]
fn tissue_and_skin_of_one_poisson_ratio_share_a_stretch_by_their_stiffness() {
    for (shape, element, method) in MODELS {
        let (case, plan) = bar(shape);
        let pull = |membrane: Option<SkinMembrane>| {
            let settings = Settings { element, method: method.clone(), membrane, ..exact() };
            let scene = Scene::new(&case, &plan, &settings).unwrap();
            let answer = scene.solve(&Unobserved).unwrap();
            for (x, u) in case.volume.nodes.iter().zip(&answer.displacement) {
                let exact = Vector::new(0.01 * x.x, -0.003 * x.y, -0.003 * x.z);
                assert!((u - exact).norm() < 1e-10, "{shape:?} {element:?}: {u} at {x}");
            }
            let constraints = scene.conditions.constraints.iter().zip(&answer.reactions);
            let ends = constraints
                .filter(|(constraint, _)| case.volume.nodes[constraint.node as usize].x > 39.0);
            ends.map(|(_, force)| force.x).sum::<f64>()
        };
        // 15 kPa times 60 mm² times 1 %, and 200 kPa times 15 mm² times 1 %.
        let (without, with) = (pull(None), pull(membrane(None, None)));
        assert!((without / 9.0 - 1.0).abs() < 1e-10, "{shape:?} {element:?}: {without}");
        assert!((with / 39.0 - 1.0).abs() < 1e-10, "{shape:?} {element:?}: {with}");
        let along = FibreDirection::Uniform(Vector::new(-2.0, 0.0, 0.7));
        let stiffer = pull(membrane(Some(800.0), Some(along)));
        assert!((stiffer / 129.0 - 1.0).abs() < 1e-10, "{shape:?} {element:?}: {stiffer}");
    }
}

#[test]
fn lines_follow_an_array_of_nodes_whatever_its_signs() {
    let (mut case, plan) = bar(CellShape::Hex8);
    let mut mesh = (*case.volume).clone();
    let flip = |node: usize| if node.is_multiple_of(2) { 3.0 } else { -0.1 };
    let lines = (0..mesh.nodes.len()).map(|node| Vector::new(1.0, 0.0, 0.3) * flip(node));
    mesh.node_vectors.insert("langer".to_owned(), lines.collect());
    case.volume = mesh.into();
    let scene = |lines: FibreDirection| {
        let settings = Settings { membrane: membrane(Some(800.0), Some(lines)), ..exact() };
        Scene::new(&case, &plan, &settings)
    };
    let by_array = scene(FibreDirection::Array("langer".to_owned())).unwrap().membrane.unwrap();
    assert!(by_array.lines.iter().all(|line| (line.x.abs() - 1.0).abs() < 1e-15));
    let refused = |lines| {
        let error = scene(lines).err().unwrap().0.remove(0);
        (error.code.name(), error.pointer)
    };
    let across = refused(FibreDirection::Uniform(Vector::z()));
    assert_eq!(across, ("fibre-direction-zero", "/spec/membrane/fibre/direction".to_owned()));
    let unknown = refused(FibreDirection::Array("lines".to_owned()));
    assert_eq!(unknown, ("unknown-array", "/spec/membrane/fibre/array".to_owned()));
}

#[test]
fn a_response_of_tissue_with_fibres_and_membrane_is_the_direct_solution() {
    use mechanics::material::{Fibre, FibreLaw};
    let law = Fibre { young_modulus: 110.0, shear_modulus: None, law: FibreLaw::Engineering };
    for element in [ElementChoice::Auto, ElementChoice::Plain, ElementChoice::Quadratic] {
        let mesh = block(Vector::new(30.0, 20.0, 8.0), [6, 4, 2], CellShape::Tet4);
        let mut case = case_of(mesh, material(15.0, 0.46).with_fibre(&law).unwrap());
        case.fibres.insert("*".to_owned(), FibreDirection::Uniform(Vector::new(1.0, 1.0, 0.0)));
        case.skin = Some(set("z_max"));
        case.fixed = vec![set("x_max")];
        case.segments = vec![CaseSegment { name: "z_min".to_owned(), nodes: set("x_min") }];
        let lines = FibreDirection::Uniform(Vector::y());
        let settings = Settings {
            element,
            membrane: membrane(Some(800.0), Some(lines)),
            relative_residual: 1e-12,
            ..Settings::default()
        };
        let angles = Vector::new(7.0, -5.0, 11.0).map(f64::to_radians);
        let shift = Vector::new(1.5, -0.7, 5.0);
        let movement = RigidMovement::about_pivot(angles, Vector::new(3.0, 0.0, -9.0), shift);
        let planned = PlannedSegment { name: "z_min".to_owned(), movement };
        let plan = Plan { segments: vec![planned], ..Plan::default() };
        let direct = solve(&case, &plan, &settings);
        assert!(direct.elements.last().unwrap().ends_with("membrane"));
        let rest = Scene::new(&case, &Plan::default(), &settings).unwrap();
        let columns = build(&rest, &[], &Unobserved).unwrap();
        for (&node, found) in columns.nodes.iter().zip(columns.apply(&[movement])) {
            let difference = (found - direct.displacement[node as usize]).norm();
            // Thirteen solutions to 1e-12 of some 8 mm, of columns of up to 10 mm.
            assert!(difference < 1e-8, "{element:?}: {difference:e}");
        }
        // Both count: without either of them the skin lies elsewhere.
        let bare = solve(&case, &plan, &Settings { membrane: None, ..settings.clone() });
        let mut isotropic = case.clone();
        isotropic.materials.insert("*".to_owned(), material(15.0, 0.46));
        let isotropic = solve(&isotropic, &plan, &settings);
        for other in [bare, isotropic] {
            let pairs = other.displacement.iter().zip(&direct.displacement);
            assert!(pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) > 0.01, "{element:?}");
        }
    }
}

#[test]
fn a_taut_sheet_pulls_by_its_slope_and_dents_as_a_stretched_skin_does() {
    // Tilted by a slope of .03 along the strip: the ends pull with s t times the slope and the width, 20 * 1.5 * .03 * 10 mN.
    let turn = Rotation3::from_euler_angles(0.4, 1.0, -2.0);
    let (mesh, mut membrane) = strip(&SKIN, Vector::x(), turn);
    membrane.sheet = membrane.sheet.with_tension(20.0).unwrap();
    let (normal, along) = (turn * Vector::z(), turn * Vector::x());
    let tilted: Vec<Vector> = mesh.nodes.iter().map(|x| normal * (0.03 * along.dot(x))).collect();
    let forces = membrane.internal_forces(&mesh, &tilted);
    let at_end = |x: &Vector| along.dot(x) > 39.9;
    let ends = mesh.nodes.iter().zip(&forces).filter(|(x, _)| at_end(x));
    let end: Vector = ends.map(|(_, force)| force).sum();
    assert!((end - normal * 9.0).norm() < 1e-10, "{end}");
    assert!(forces.iter().sum::<Vector>().norm() < 1e-10);
    assert!(matches!(membrane.sheet.with_tension(-1.0), Err(SheetError::Tension(_))));

    // Held at both ends and pressed by p: w = p x (L - x) / (2 s t), and nothing of the tissue below, which is too soft.
    let sheet = PlaneStress::new(&Sheet { young_modulus: 1e-6, ..SKIN }).unwrap();
    let (tension, pressure, length) = (20.0, 0.1, 40.0);
    for (shape, element) in [
        (CellShape::Hex8, ElementChoice::Auto),
        (CellShape::Tet4, ElementChoice::Plain),
        (CellShape::Wedge6, ElementChoice::Auto),
    ] {
        let mesh = block(Vector::new(length, 10.0, 4.0), [8, 2, 1], shape);
        let case = Case { skin: Some(set("z_max")), ..case_of(mesh, material(1e-6, 0.3)) };
        let zero = Some(0.0);
        let plan = Plan {
            prescribed: vec![
                constraint("x_min", [zero; 3]),
                constraint("x_max", [zero; 3]),
                constraint("z_min", [zero; 3]),
            ],
            loads: vec![Load::Pressure { faces: set("z_max"), pressure }],
            ..Plan::default()
        };
        let sheet = sheet.with_tension(tension).unwrap();
        let membrane = Some(SkinMembrane { sheet, lines: None });
        let settings = Settings { membrane, element, estimate: false, ..exact() };
        let found = solve(&case, &plan, &settings);
        for &node in &case.volume.node_sets["z_max"] {
            let x = case.volume.nodes[node as usize].x;
            let known = -pressure * x * (length - x) / (2.0 * tension * 1.5);
            let moved = found.displacement[node as usize].z;
            assert!((moved - known).abs() < 1e-5, "{shape:?} at {x}: {moved} {known}");
        }
    }
}
